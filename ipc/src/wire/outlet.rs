//! An outlet: the writing end behind an output port, with the inhibitors that stand on it.
//!
//! Must never keep a message back for later: what an inhibitor drops is gone (Brooks 1991 §6.2).
//!
//! ```text
//!   module ──► staged in the step ──► (I any holds?) ──► wire ──► every reader
//!                                          └─► dropped, counted
//! ```

use super::page::Writer;
use super::side_tap::{Joined, Plug, TAPS_MAX, TapEnd, TapLook, TapState, join, release, sweep};
use crate::clock::Time;
use crate::message::{Kind, Words};
use crate::tap;

/// What was counted at one output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputCounts {
    /// Messages written to the wire.
    pub emitted: u64,
    /// Messages dropped by an inhibitor.
    pub inhibited: u64,
}

/// The writing end behind one output port.
#[derive(Debug)]
pub struct Outlet {
    writer: Writer,
    staged: Option<Words>,
    taps: Vec<Joined>,
    counts: OutputCounts,
}

impl Outlet {
    /// An outlet to the wire of `writer`.
    pub fn new(writer: Writer) -> Outlet {
        Outlet {
            writer,
            staged: None,
            taps: Vec::with_capacity(TAPS_MAX),
            counts: OutputCounts::default(),
        }
    }

    /// Joins an inhibitor. Does not allocate. `Err` gives it back when [`TAPS_MAX`] stand there already.
    pub fn inhibit(&mut self, end: TapEnd) -> Result<(), TapEnd> {
        join(&mut self.taps, end)
    }

    /// Tells the inhibitors of `plug` to go. Their windows still run out as they would have.
    pub fn release(&mut self, plug: Plug) {
        release(&mut self.taps, plug);
    }

    /// Keeps the message for the end of the beat.
    ///
    /// # Panics
    /// When the module emits twice on one port in one step.
    pub fn stage(&mut self, words: Words) {
        assert!(
            self.staged.is_none(),
            "a module emits at most one message per output port per step"
        );
        self.staged = Some(words);
    }

    /// Writes the staged message, stamped `u`, unless an inhibitor's window holds. Says whether it wrote.
    pub fn commit(&mut self, u: Time, gone: impl FnMut(TapEnd)) -> bool {
        let mut open = true;
        if !self.taps.is_empty() {
            for tap in &mut self.taps {
                tap.look(u, None);
                if tap.fresh {
                    tap.take_effect();
                }
            }
            open = tap::emits(u, self.taps.iter().filter_map(|t| t.window));
            if !open && self.staged.is_some() {
                self.counts.inhibited += 1;
                if let Some(tap) = self
                    .taps
                    .iter_mut()
                    .rfind(|t| t.window.is_some_and(|w| w.holds(u)))
                {
                    tap.reject();
                }
            }
            sweep(&mut self.taps, u, gone);
        }
        let Some(words) = self.staged.take() else {
            return false;
        };
        if open {
            self.writer.write(u, &words);
            self.counts.emitted += 1;
        }
        open
    }

    /// The message waiting for the end of the beat.
    pub fn staged(&self) -> Option<&Words> {
        self.staged.as_ref()
    }

    /// The kind of message on the wire.
    pub fn kind(&self) -> Kind {
        self.writer.kind()
    }

    /// The messages of inhibitors that the last [`Outlet::commit`] took in, for those who trace.
    pub fn tap_looks(&self) -> impl Iterator<Item = TapLook<'_>> {
        self.taps.iter().filter_map(Joined::look_taken)
    }

    /// What was counted so far.
    pub fn counts(&self) -> OutputCounts {
        self.counts
    }

    /// The inhibitors on this output, for those who watch.
    pub fn taps(&self) -> impl Iterator<Item = TapState> {
        self.taps.iter().map(Joined::state)
    }
}
