//! An outlet: the writing end behind an output port, with the inhibitors that stand on it.
//!
//! Must never keep a message back for later: what an inhibitor drops is gone (Brooks 1991 §6.2).
//!
//! ```text
//!   module ──► staged in the step ──► (I any holds?) ──► wire ──► every reader
//!                                          └─► dropped, counted
//! ```

use std::sync::Arc;

use super::gauge::TapGauge;
use super::joined::{Inhibitors, Joined, Plug, TapEnd, TapLook, TapState, join, release, sweep, window_of};
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

/// The writing end behind one output port.
///
/// With a thousand modules a beat waits for memory: so all that a message of one word needs of its outlet is one line of
/// the processor's cache. Messages of several words and inhibitors, which are rare, lie elsewhere.
#[derive(Debug)]
#[repr(C, align(64))]
pub struct Outlet {
    writer: Writer,
    /// Messages written to the wire.
    emitted: u64,
    /// The message staged, or the last one, if it is of a kind of one word.
    word: f64,
    /// The message staged, or the last one, if it is of another kind.
    words: Option<Box<Words>>,
    /// `None` until the first joins.
    inhibitors: Option<Box<Inhibitors>>,
    /// Whether there is a message for the end of the beat.
    staged: bool,
    /// Whether an inhibitor stands on it.
    tapped: bool,
}

const _: () = assert!(size_of::<Outlet>() == 64);

impl Outlet {
    /// An outlet to the wire of `writer`.
    pub fn new(writer: Writer) -> Outlet {
        Outlet {
            words: (!writer.kind().single()).then(|| Box::new([0.0; WORDS_MAX])),
            writer,
            emitted: 0,
            word: 0.0,
            inhibitors: None,
            staged: false,
            tapped: false,
        }
    }

    /// Joins an inhibitor. Does not allocate if it brings [`Room::full`](super::Room::full). `Err` gives it back
    /// when [`TAPS_MAX`](super::TAPS_MAX) stand there already.
    pub fn inhibit(&mut self, mut end: TapEnd) -> Result<(), TapEnd> {
        if self.inhibitors.is_none() {
            self.inhibitors = end.room.inhibitors.take();
        }
        join(&mut self.inhibitors.get_or_insert_default().taps, end)?;
        self.tapped = true;
        Ok(())
    }

    /// Tells the inhibitors of `plug` to go. Their windows still run out as they would have.
    pub fn release(&mut self, plug: Plug) {
        if let Some(inhibitors) = &mut self.inhibitors {
            release(&mut inhibitors.taps, plug);
        }
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
        if self.tapped && !self.admits(u, staged, gone) || !staged {
            return false;
        }
        match &self.words {
            None => self.writer.write_word(u, self.word),
            Some(words) => self.writer.write(u, words),
        }
        self.emitted += 1;
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
        self.emitted += 1;
        true
    }

    /// Takes in what the inhibitors say.
    pub fn look(&mut self, now: Time, gone: impl FnMut(TapEnd)) {
        let Some(Inhibitors { taps, .. }) = self.inhibitors.as_deref_mut() else {
            return;
        };
        for tap in taps.iter_mut() {
            if tap.has_news() {
                tap.take_in::<WORDS_MAX>(now, None);
            }
            if tap.fresh {
                tap.take_effect();
            }
        }
        sweep(taps, now, gone);
        self.tapped = !taps.is_empty();
    }

    /// Whether a message may be written at `u`; counts the one that may not.
    fn open(&mut self, u: Time) -> bool {
        let Some(Inhibitors { taps, inhibited }) = self.inhibitors.as_deref_mut() else {
            return true;
        };
        if tap::emits(u, taps.iter().filter_map(|t| t.window())) {
            return true;
        }
        *inhibited += 1;
        if let Some(tap) = taps.iter().rfind(|t| t.window().is_some_and(|w| w.holds(u))) {
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
        self.joined().iter().filter_map(Joined::look_taken)
    }

    /// Whether an inhibitor stands on it.
    #[inline]
    pub fn tapped(&self) -> bool {
        self.tapped
    }

    /// What was counted so far.
    pub fn counts(&self) -> OutputCounts {
        OutputCounts {
            emitted: self.emitted,
            inhibited: self.inhibitors.as_ref().map_or(0, |i| i.inhibited),
        }
    }

    /// The window of the inhibitor that is counted at `gauge`; `None` if it is not joined here or said nothing
    /// yet.
    pub fn window_of(&self, gauge: &Arc<TapGauge>) -> Option<Window> {
        window_of(self.joined(), gauge)
    }

    fn joined(&self) -> &[Joined] {
        self.inhibitors.as_ref().map_or(&[], |i| &i.taps)
    }

    /// The inhibitors on this output, for those who watch.
    pub fn taps(&self) -> impl Iterator<Item = TapState> {
        self.joined().iter().map(Joined::state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Span;
    use crate::wire::{Page, Room};

    #[test]
    fn the_first_inhibitor_with_room_brings_the_place_it_stands_in() {
        let page = Page::in_memory(2);
        let mut outlet = Outlet::new(page.writer(0, Kind::Number).expect("free"));
        let end = TapEnd {
            reader: page.reader(1, Kind::Vector).expect("there"),
            time_constant: Span::millis(1),
            level: 1,
            plug: 1,
            gauge: Arc::default(),
            room: Room::full(Kind::Vector),
        };
        let brought: *const Inhibitors = end.room.inhibitors.as_deref().expect("room");
        outlet.inhibit(end).expect("there is room");
        let stands: *const Inhibitors = outlet.inhibitors.as_deref().expect("joined");
        assert!(std::ptr::eq(brought, stands));
        assert!(outlet.tapped());
        outlet.release(1);
        let mut gone = 0;
        outlet.look(Time(1), |_| gone += 1);
        assert_eq!(
            (gone, outlet.tapped()),
            (1, false),
            "left at once: it said nothing"
        );
    }
}
