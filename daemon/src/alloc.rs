//! The allocator of the daemon: the system's, with every call on a sealed real-time thread counted.
//!
//! After the start a real-time thread allocates nothing; should one do so all the same, it is counted and
//! shown in every status, rather than found by a late beat.
#![allow(unsafe_code)] // a global allocator is unsafe by its trait; everything is passed on unchanged

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

thread_local! {
    /// Whether this thread is real-time and its start is over. Needs no lazy set-up and no destructor, so
    /// that looking at it never allocates.
    static SEALED: Cell<bool> = const { Cell::new(false) };
}

/// Allocations, and releases, on sealed threads.
static BROKEN: AtomicU64 = AtomicU64::new(0);

/// From now on this thread is not expected to allocate.
pub fn seal() {
    SEALED.with(|sealed| sealed.set(true));
}

/// This thread may allocate again: its run is over.
pub fn unseal() {
    SEALED.with(|sealed| sealed.set(false));
}

/// How often sealed threads allocated or released memory.
pub fn broken() -> u64 {
    // Relaxed: a number to look at.
    BROKEN.load(Ordering::Relaxed)
}

/// From now on all threads take memory from one heap. With a heap for each of many short-lived threads, as the GNU
/// library has it, memory that one caller's thread gave back is none for the next, and a daemon that is called all day
/// grows all day. To be called before the first other thread is started.
pub fn share_one_heap() {
    #[cfg(target_env = "gnu")]
    // SAFETY: sets a number in the allocator; there is no other thread yet.
    unsafe {
        libc::mallopt(libc::M_ARENA_MAX, 1);
    }
}

/// The system's allocator, counting.
#[derive(Debug)]
pub struct Counting;

fn count() {
    if SEALED.try_with(Cell::get).unwrap_or(false) {
        BROKEN.fetch_add(1, Ordering::Relaxed);
    }
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's contract is the system's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: as above; the pointer came from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}
