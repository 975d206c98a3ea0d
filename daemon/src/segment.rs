//! Segments cut short: a process of the same user truncated a shared-memory file that is mapped here.
//!
//! The kernel then answers the next access with SIGBUS, and the process would be gone on the spot: safe only
//! where a body's own gate is in another process. Instead an empty page is put in the place of the lost one.
//! Its cells read as never written, so commands and sensors go stale and the gates close by the ordinary way;
//! the gate latches *shared memory cut*, and the process leaves in good order, with a failure, to be
//! started again.
//!
//! Must never hide a bug: only a missing page of a mapped file (`BUS_ADRERR`) is answered so, and only
//! [`CUTS_MAX`] of them; everything else ends the process as if this were not here.
#![allow(unsafe_code)] // a signal handler, and the page it maps

use std::sync::atomic::{AtomicU64, Ordering};

/// Most pages that are replaced: those of every page of wires there may be, and some of iceoryx2's own.
pub const CUTS_MAX: u64 = 4096;

/// Pages replaced so far.
static CUTS: AtomicU64 = AtomicU64::new(0);

/// How many pages of shared memory were lost under this process.
pub fn cut() -> u64 {
    // Relaxed: a number to look at.
    CUTS.load(Ordering::Relaxed)
}

/// From now on a lost page is replaced instead of ending the process.
///
/// # Errors
/// When the host refuses the handler.
pub fn guard() -> std::io::Result<()> {
    // SAFETY: the structure is plain data for which zero is valid; its handler has the signature that
    // SA_SIGINFO asks for and calls nothing but `mmap` and `signal`, both raw system calls in effect.
    let refused = unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        action.sa_sigaction = replace as *const () as usize;
        action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
        libc::sigemptyset(&mut action.sa_mask);
        libc::sigaction(libc::SIGBUS, &action, std::ptr::null_mut())
    };
    if refused == 0 {
        Ok(())
    } else {
        Err(std::io::Error::last_os_error())
    }
}

/// Size of a page of memory; on hosts with larger ones `mmap` refuses, and the process ends.
const PAGE: usize = 4096;

extern "C" fn replace(_signal: libc::c_int, info: *mut libc::siginfo_t, _context: *mut libc::c_void) {
    // SAFETY: the kernel hands a valid structure to a handler under SA_SIGINFO; for SIGBUS it holds an address.
    let (code, address) = unsafe { ((*info).si_code, (*info).si_addr() as usize) };
    let nth = CUTS.fetch_add(1, Ordering::Relaxed);
    if code == libc::BUS_ADRERR && nth < CUTS_MAX {
        // SAFETY: the page at this address belongs to a mapping of a file that has lost it, or the access
        // would not have ended here; nothing else can lie there. What the mapping's users expect of it are
        // atomics (our own cells) or whatever iceoryx2 keeps, and the process is about to leave.
        let mapped = unsafe {
            libc::mmap(
                (address & !(PAGE - 1)) as *mut libc::c_void,
                PAGE,
                libc::PROT_READ | libc::PROT_WRITE,
                libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_FIXED,
                -1,
                0,
            )
        };
        if mapped != libc::MAP_FAILED {
            return;
        }
    }
    // SAFETY: async-signal-safe; the access is tried again and ends the process.
    unsafe { libc::signal(libc::SIGBUS, libc::SIG_DFL) };
}
