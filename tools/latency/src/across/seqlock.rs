//! A bare sequence lock in memory that two processes share: the least that such a message can cost.
//!
//! Must never be used for anything but to compare with: it knows one reader, one writer and no errors.
#![allow(unsafe_code)] // maps memory that another process maps as well

use std::fs::File;
use std::io;
use std::os::fd::{AsRawFd, OwnedFd};
use std::ptr::NonNull;
use std::sync::atomic::{AtomicU64, Ordering, fence};

use rustix::fs::{MemfdFlags, ftruncate, memfd_create};
use rustix::mm::{MapFlags, ProtFlags, mmap, munmap};

const BYTES: usize = 4096;

#[repr(C)]
struct Lock {
    sequence: AtomicU64,
    words: [AtomicU64; 2],
}

struct Mapped(NonNull<Lock>);

// SAFETY: what it points to is atomics, and stays mapped until it is dropped.
unsafe impl Send for Mapped {}

impl Mapped {
    fn of(file: &impl std::os::fd::AsFd, rights: ProtFlags) -> io::Result<Mapped> {
        // SAFETY: a fresh mapping of a file of this size, at a place of the kernel's choice; zeros are a `Lock`.
        let place = unsafe { mmap(std::ptr::null_mut(), BYTES, rights, MapFlags::SHARED, file, 0)? };
        NonNull::new(place.cast())
            .map(Mapped)
            .ok_or_else(|| io::Error::other("mapped at 0"))
    }

    fn lock(&self) -> &Lock {
        // SAFETY: mapped for as long as this lives, aligned to a page.
        unsafe { self.0.as_ref() }
    }
}

impl Drop for Mapped {
    fn drop(&mut self) {
        // SAFETY: mapped by `of` with this size; nothing of it is borrowed any more.
        let _ = unsafe { munmap(self.0.as_ptr().cast(), BYTES) };
    }
}

/// The writing end.
pub(super) struct SeqlockWriter {
    mapped: Mapped,
    _file: OwnedFd,
}

impl SeqlockWriter {
    /// A new one, and the path at which another process of this user finds it.
    pub(super) fn create() -> io::Result<(SeqlockWriter, String)> {
        let file = memfd_create("subsumed-lab", MemfdFlags::CLOEXEC)?;
        ftruncate(&file, BYTES as u64)?;
        let path = format!("/proc/{}/fd/{}", std::process::id(), file.as_raw_fd());
        let mapped = Mapped::of(&file, ProtFlags::READ | ProtFlags::WRITE)?;
        Ok((SeqlockWriter { mapped, _file: file }, path))
    }

    /// Writes both words.
    pub(super) fn write(&mut self, words: [u64; 2]) {
        let lock = self.mapped.lock();
        let sequence = lock.sequence.load(Ordering::Relaxed);
        lock.sequence.store(sequence + 1, Ordering::Relaxed);
        // Whoever sees a new word sees the odd sequence as well.
        fence(Ordering::Release);
        lock.words[0].store(words[0], Ordering::Relaxed);
        lock.words[1].store(words[1], Ordering::Relaxed);
        lock.sequence.store(sequence + 2, Ordering::Release);
    }
}

/// The reading end.
pub(super) struct SeqlockReader {
    mapped: Mapped,
    known: std::cell::Cell<u64>,
}

impl SeqlockReader {
    /// That of the writer which created `path`.
    pub(super) fn open(path: &str) -> io::Result<SeqlockReader> {
        let mapped = Mapped::of(&File::open(path)?, ProtFlags::READ)?;
        Ok(SeqlockReader {
            mapped,
            known: std::cell::Cell::new(0),
        })
    }

    /// Whether something was or is being written since the last whole read.
    pub(super) fn changed(&self) -> bool {
        self.mapped.lock().sequence.load(Ordering::Relaxed) != self.known.get()
    }

    /// Both words, if they could be read whole.
    pub(super) fn read(&self) -> Option<[u64; 2]> {
        let lock = self.mapped.lock();
        let before = lock.sequence.load(Ordering::Acquire);
        let words = [0, 1].map(|k: usize| lock.words[k].load(Ordering::Relaxed));
        fence(Ordering::Acquire);
        let whole = before & 1 == 0 && lock.sequence.load(Ordering::Relaxed) == before;
        if whole {
            self.known.set(before);
        }
        whole.then_some(words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_through_the_other_mapping() {
        let (mut writer, path) = SeqlockWriter::create().unwrap();
        let reader = SeqlockReader::open(&path).unwrap();
        assert_eq!(reader.read(), Some([0, 0]));
        assert!(!reader.changed());
        writer.write([7, 9]);
        assert!(reader.changed());
        assert_eq!(reader.read(), Some([7, 9]));
        assert!(!reader.changed());
    }
}
