//! An outlet: the writing end behind an output port, with the inhibitors that stand on it.
//!
//! Must never keep a message back for later: what an inhibitor drops is gone (Brooks 1991 §6.2).
//!
//! ```text
//!   module ──► staged in the step ──► (I any holds?) ──► wire ──► every reader
//!                                          └─► dropped, counted
//! ```

use std::sync::Arc;

use super::joined::{Joined, Plug, TapEnd, TapGauge, TapLook, TapState, join, release, sweep, window_of};
use super::page::Writer;
use crate::clock::Time;
use crate::message::{Kind, Payload, WORDS_MAX, Words};
use crate::tap::{self, Window};

/// What was counted at one output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputCounts {
    /// Messages written to the wire.
    pub emitted: u64,
    /// Messages dropped by an inhibitor.
    pub inhibited: u64,
}

/// The writing end behind one output port. Only messages of several words, which are rare, lie elsewhere.
#[derive(Debug)]
#[repr(C)]
pub struct Outlet {
    writer: Writer,
    /// Whether there is a message for the end of the beat.
    staged: bool,
    taps: Vec<Joined>,
    counts: OutputCounts,
    /// The message staged, or the last one, if it is of a kind of one word.
    word: f64,
    /// The message staged, or the last one, if it is of another kind.
    words: Option<Box<Words>>,
}

impl Outlet {
    /// An outlet to the wire of `writer`.
    pub fn new(writer: Writer) -> Outlet {
        Outlet {
            staged: false,
            word: 0.0,
            words: (!writer.kind().single()).then(|| Box::new([0.0; WORDS_MAX])),
            writer,
            taps: Vec::new(),
            counts: OutputCounts::default(),
        }
    }

    /// Joins an inhibitor. Does not allocate if it brings [`Room::full`](super::Room::full). `Err` gives it back
    /// when [`TAPS_MAX`](super::TAPS_MAX) stand there already.
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
        self.mark();
        match &mut self.words {
            None => self.word = words[0],
            Some(all) => **all = words,
        }
    }

    /// Keeps the message for the end of the beat, as [`Outlet::stage`] does.
    ///
    /// # Panics
    /// When the module emits twice on one port in one step.
    #[inline]
    pub fn emit<T: Payload>(&mut self, message: T) {
        self.mark();
        match &mut self.words {
            None => self.word = message.word(),
            Some(all) => message.put(all),
        }
    }

    #[inline]
    fn mark(&mut self) {
        assert!(
            !self.staged,
            "a module emits at most one message per output port per step"
        );
        self.staged = true;
    }

    /// Whether a message waits for the end of the beat.
    #[inline]
    pub fn is_staged(&self) -> bool {
        self.staged
    }

    /// Writes the staged message, stamped `u`, unless an inhibitor's window holds. Says whether it wrote.
    #[inline]
    pub fn commit(&mut self, u: Time, gone: impl FnMut(TapEnd)) -> bool {
        let staged = std::mem::take(&mut self.staged);
        if !self.taps.is_empty() && !self.admits(u, staged, gone) || !staged {
            return false;
        }
        match &self.words {
            None => self.writer.write_word(u, self.word),
            Some(words) => self.writer.write(u, words),
        }
        self.counts.emitted += 1;
        true
    }

    /// Takes in what the inhibitors say, and whether they let a message pass at `u`; counts the one, if it is
    /// `staged`, that they don't. Most outlets have none, so it is kept out of the way.
    #[inline(never)]
    fn admits(&mut self, u: Time, staged: bool, gone: impl FnMut(TapEnd)) -> bool {
        self.look(u, gone);
        staged && self.open(u)
    }

    /// Writes a message at once, stamped `u`, as though the module had emitted it then, unless an inhibitor's
    /// window holds. Says whether it wrote. What is staged stays so.
    pub fn put(&mut self, u: Time, words: &Words, gone: impl FnMut(TapEnd)) -> bool {
        self.look(u, gone);
        if !self.open(u) {
            return false;
        }
        self.writer.write(u, words);
        self.counts.emitted += 1;
        true
    }

    /// Takes in what the inhibitors say.
    pub fn look(&mut self, now: Time, gone: impl FnMut(TapEnd)) {
        for tap in &mut self.taps {
            if tap.has_news() {
                tap.take_in::<WORDS_MAX>(now, None);
            }
            if tap.fresh {
                tap.take_effect();
            }
        }
        sweep(&mut self.taps, now, gone);
    }

    /// Whether a message may be written at `u`; counts the one that may not.
    fn open(&mut self, u: Time) -> bool {
        if self.taps.is_empty() || tap::emits(u, self.taps.iter().filter_map(|t| t.window)) {
            return true;
        }
        self.counts.inhibited += 1;
        if let Some(tap) = self
            .taps
            .iter_mut()
            .rfind(|t| t.window.is_some_and(|w| w.holds(u)))
        {
            tap.reject();
        }
        false
    }

    /// The words of the message that waits for the end of the beat, or of the last one that did.
    #[inline]
    pub fn words(&self) -> &[f64] {
        match &self.words {
            None => std::slice::from_ref(&self.word),
            Some(words) => &words[..],
        }
    }

    /// The kind of message on the wire.
    #[inline]
    pub fn kind(&self) -> Kind {
        self.writer.kind()
    }

    /// The messages of inhibitors that the last [`Outlet::commit`] took in, for those who trace.
    pub fn tap_looks(&self) -> impl Iterator<Item = TapLook<'_>> {
        self.taps.iter().filter_map(Joined::look_taken)
    }

    /// Whether an inhibitor stands on it.
    #[inline]
    pub fn tapped(&self) -> bool {
        !self.taps.is_empty()
    }

    /// What was counted so far.
    pub fn counts(&self) -> OutputCounts {
        self.counts
    }

    /// The window of the inhibitor that is counted at `gauge`; `None` if it is not joined here or said nothing
    /// yet.
    pub fn window_of(&self, gauge: &Arc<TapGauge>) -> Option<Window> {
        window_of(&self.taps, gauge)
    }

    /// The inhibitors on this output, for those who watch.
    pub fn taps(&self) -> impl Iterator<Item = TapState> {
        self.taps.iter().map(Joined::state)
    }
}
