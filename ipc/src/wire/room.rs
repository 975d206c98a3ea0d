//! Room: how much shared memory is left.
//!
//! A file in shared memory can be made as long as one likes; that there is no memory behind it shows at the first
//! touch, as SIGBUS, in whichever process touches it. So whoever is about to make one looks first: a newcomer is
//! refused, and those who live put off what makes files.
//!
//! Must never be relied on alone: another process may take what is left in the meantime.

/// Where shared memory lies.
pub(super) const SHARED_MEMORY: &str = "/dev/shm";

/// Least room for a newcomer besides its wires, in bytes: node, service and connections took 20 KiB when measured.
const NEWCOMER_MIN: u64 = 256 << 10;

/// Room for one wire: iceoryx2 keeps a page for each of 64 readers and some more, 71 when measured (Allen's daemon
/// took 440 KiB, its body 170).
const WIRE_BYTES: u64 = 80 * 128;

/// Least room for those who live to hand out pages and to clean up after the dead: one connection, one lock.
const UPKEEP_MIN: u64 = 256 << 10;

/// Whether there is room for a newcomer with so many wires.
///
/// # Errors
/// How many bytes there are, and how many it takes.
pub(super) fn for_newcomer(wires: usize) -> Result<(), (u64, u64)> {
    let needed = NEWCOMER_MIN + WIRE_BYTES * wires as u64;
    match left() {
        Some(free) if free < needed => Err((free, needed)),
        _ => Ok(()),
    }
}

/// Whether there is room for those who live to do their chores.
pub(super) fn for_upkeep() -> bool {
    left().is_none_or(|free| free >= UPKEEP_MIN)
}

/// Bytes left; `None` where there is no limit, or nobody says.
fn left() -> Option<u64> {
    let told = rustix::fs::statvfs(SHARED_MEMORY).ok()?;
    bytes(told.f_blocks, told.f_bavail, told.f_frsize)
}

/// Bytes left of `blocks` blocks of `size` bytes, of which `free` are; a file system without a limit has none.
fn bytes(blocks: u64, free: u64, size: u64) -> Option<u64> {
    (blocks > 0).then(|| free.saturating_mul(size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_system_without_a_limit_is_never_full() {
        assert_eq!(bytes(0, 0, 4096), None);
        assert_eq!(bytes(10, 0, 4096), Some(0));
        assert_eq!(bytes(10, 3, 4096), Some(12_288));
    }
}
