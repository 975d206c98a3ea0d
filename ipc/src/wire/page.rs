//! A page: the cells of all wires that one process writes, in plain or shared memory.
//!
//! Must never move or unmap a cell while a [`Writer`] or [`Reader`] of it lives. A writer is handed out
//! once for each cell: a wire has one writer.
#![allow(unsafe_code)] // the one place where a cell is reached through a pointer

use std::any::Any;
use std::fmt;
use std::ptr::NonNull;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use super::cell::{Cell, Reading};
use crate::clock::Time;
use crate::message::{Kind, Words};

/// Most wires that one process may write. A page is one shared-memory segment of 128 bytes a wire; the
/// bound keeps a segment at 2 MiB, the default limit of locked memory in containers being 8 MiB.
pub const WIRES_MAX: usize = 16_384;

/// The cells of all wires that one process writes.
pub struct Page {
    cells: NonNull<[Cell]>,
    /// Which cells have given away their writer. Empty on pages of other processes: nobody writes there.
    written: Box<[AtomicBool]>,
    /// What keeps the memory mapped.
    _keep: Box<dyn Any + Send>,
}

// SAFETY: a page is a slice of cells, which are atomics throughout and may be shared between threads;
// what keeps it mapped is `Send`, never looked at, and only dropped.
unsafe impl Send for Page {}
// SAFETY: as above.
unsafe impl Sync for Page {}

impl fmt::Debug for Page {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Page({} wires)", self.len())
    }
}

impl Page {
    /// A page in plain memory: for wires within one process and for the virtual clock.
    pub fn in_memory(wires: usize) -> Arc<Page> {
        let cells: Arc<[Cell]> = (0..wires).map(|_| Cell::new()).collect();
        let pointer = NonNull::from(&*cells);
        Arc::new(Page {
            cells: pointer,
            written: flags(wires),
            _keep: Box::new(cells),
        })
    }

    /// A page over foreign memory.
    ///
    /// # Safety
    /// `cells` must stay mapped, at that address and initialised, for as long as `keep` lives, and must
    /// only be written through atomics. With `writable` it must be mapped for writing.
    pub(crate) unsafe fn over(
        cells: NonNull<[Cell]>,
        keep: Box<dyn Any + Send>,
        writable: bool,
    ) -> Arc<Page> {
        let written = if writable {
            flags(cells.len())
        } else {
            Box::default()
        };
        Arc::new(Page {
            cells,
            written,
            _keep: keep,
        })
    }

    /// How many wires the page carries.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Whether the page carries no wire.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The writing end of wire `index`; `None` if there is no such wire, if its writer was handed out
    /// before, or if the page belongs to another process.
    pub fn writer(self: &Arc<Page>, index: usize, kind: Kind) -> Option<Writer> {
        let flag = self.written.get(index)?;
        // AcqRel is not needed: the flag guards nothing but itself.
        if flag.swap(true, Ordering::Relaxed) {
            return None;
        }
        Some(Writer {
            cell: self.cell(index)?,
            kind,
            _page: self.clone(),
        })
    }

    /// A reading end of wire `index`; `None` if there is no such wire.
    pub fn reader(self: &Arc<Page>, index: usize, kind: Kind) -> Option<Reader> {
        Some(Reader {
            cell: self.cell(index)?,
            kind,
            _page: self.clone(),
        })
    }

    fn cell(&self, index: usize) -> Option<NonNull<Cell>> {
        // SAFETY: the slice is mapped and initialised while `self` lives (contract of `over`, or the
        // `Arc<[Cell]>` kept by `in_memory`).
        let cells = unsafe { self.cells.as_ref() };
        cells.get(index).map(NonNull::from)
    }
}

fn flags(n: usize) -> Box<[AtomicBool]> {
    (0..n).map(|_| AtomicBool::new(false)).collect()
}

/// The writing end of a wire; there is one.
#[derive(Debug)]
pub struct Writer {
    cell: NonNull<Cell>,
    kind: Kind,
    _page: Arc<Page>,
}

/// A reading end of a wire; there may be any number. The cell comes first: what a beat asks for of an end.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Reader {
    cell: NonNull<Cell>,
    kind: Kind,
    _page: Arc<Page>,
}

// SAFETY: cells are atomics; the page that owns the memory is held by the end itself.
unsafe impl Send for Writer {}
// SAFETY: as above. Exclusive writing is kept by `write` taking `&mut self`.
unsafe impl Sync for Writer {}
// SAFETY: cells are atomics; the page that owns the memory is held by the end itself.
unsafe impl Send for Reader {}
// SAFETY: as above.
unsafe impl Sync for Reader {}

impl Writer {
    /// Writes a message. Wait-free: about as many stores as the message has words.
    #[inline]
    pub fn write(&mut self, stamp: Time, words: &Words) {
        // SAFETY: `_page` keeps the cell mapped.
        unsafe { self.cell.as_ref() }.write(stamp, words, self.kind);
    }

    /// Writes a message of one word, on a wire of such a [kind](Kind::single).
    #[inline]
    pub(super) fn write_word(&mut self, stamp: Time, word: f64) {
        // SAFETY: `_page` keeps the cell mapped.
        unsafe { self.cell.as_ref() }.put(stamp, &[word]);
    }

    /// The kind of message on this wire.
    #[inline]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// A reading end of the same wire.
    pub fn reader(&self) -> Reader {
        Reader {
            cell: self.cell,
            kind: self.kind,
            _page: self._page.clone(),
        }
    }
}

/// The page of the wire that nobody ever writes.
static SILENT: LazyLock<Arc<Page>> = LazyLock::new(|| Page::in_memory(1));

impl Reader {
    /// The reading end of a wire that nobody ever writes, for a port that is not connected.
    pub(super) fn silent(kind: Kind) -> Reader {
        SILENT.reader(0, kind).expect("the page has one wire")
    }

    /// The newest message, if there ever was one and it could be read whole within the bounded tries.
    pub fn read(&self) -> Option<Reading> {
        // SAFETY: `_page` keeps the cell mapped.
        unsafe { self.cell.as_ref() }.read(self.kind)
    }

    /// How many messages were written so far; `None` while one is being written.
    #[inline]
    pub fn number(&self) -> Option<u64> {
        // SAFETY: `_page` keeps the cell mapped.
        unsafe { self.cell.as_ref() }.number()
    }

    /// Whether the newest message may be another than number `seen`.
    #[inline]
    pub(super) fn changed(&self, seen: u64) -> bool {
        // SAFETY: `_page` keeps the cell mapped.
        unsafe { self.cell.as_ref() }.changed(seen)
    }

    /// The newest message, on a wire of a [kind of one word](Kind::single), if it is not number `seen`; `None` also
    /// where none could be read whole. The common answer, none, costs one load.
    #[inline(always)]
    pub(super) fn take_word_newer(&self, seen: u64) -> Option<(u64, Time, f64)> {
        // SAFETY: `_page` keeps the cell mapped.
        let taken = unsafe { self.cell.as_ref() }.take_newer::<1>(seen)?;
        Some((taken.number, taken.stamp, taken.words[0]))
    }

    /// Takes the newest message's words into `words` if it is not number `seen`; else, and where none could be
    /// read whole, they stay as they were. Its number and stamp.
    #[inline]
    pub(super) fn take_newer(&self, seen: u64, words: &mut [f64]) -> Option<(u64, Time)> {
        if !self.changed(seen) {
            return None;
        }
        // SAFETY: `_page` keeps the cell mapped.
        let taken = unsafe { self.cell.as_ref() }.take_words(self.kind, words);
        taken.filter(|(number, _)| *number != seen)
    }

    /// The newest message if it is not number `seen`. The common answer, none, costs one load.
    pub fn newer_than(&self, seen: u64) -> Option<Reading> {
        if self.number() == Some(seen) {
            return None;
        }
        self.read().filter(|reading| reading.number != seen)
    }

    /// The kind of message on this wire.
    pub fn kind(&self) -> Kind {
        self.kind
    }
}
