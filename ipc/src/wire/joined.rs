//! Taps as they are joined to a port, before a register or on an outlet: what was last seen of each, and in
//! which series they stand.
//!
//! Must never decide what becomes of a message of the wire: that is for [`crate::tap`] to say.

use std::mem::offset_of;
use std::sync::Arc;

use super::gauge::{TapCounts, TapGauge, count};
use super::limits::Limits;
use super::page::Reader;
use crate::clock::{Span, Time};
use crate::message::{Kind, Words};
use crate::tap::Window;

/// Most suppressors on one input, and inhibitors on one output: one for each level above it and then
/// some; the source's largest stack has fourteen layers (Brooks 1991 §8.2).
pub const TAPS_MAX: usize = 16;

/// How far ahead of the beat a stamp may lie: all clocks are one clock, so only the time the beat itself
/// has been running counts, and a beat that ran longer than this was an overrun of any sensible period.
pub const AHEAD_MAX: Span = Span::millis(100);

/// Who a tap belongs to: 0 for the creature file itself, else the number of the plugged layer.
pub type Plug = u32;

/// A tap as it is joined to a port.
#[derive(Debug)]
#[repr(C)]
pub struct TapEnd {
    /// Where its messages come from.
    pub reader: Reader,
    /// Its time constant τ.
    pub time_constant: Span,
    /// Level of the layer it comes from.
    pub level: u8,
    /// Whose it is.
    pub plug: Plug,
    /// Where what happens at it is counted, for those who watch.
    pub gauge: Arc<TapGauge>,
    /// Room at its port for it and those before it. A tap that is joined while its layer beats brings it along;
    /// one that is joined when the layer is built needs none.
    pub room: Room,
}

/// Memory for the taps of one port, made by whoever may allocate and given back with the tap that brought it.
/// Most ports are never tapped, so they have none of their own.
#[derive(Debug, Default)]
pub struct Room {
    taps: Vec<Joined>,
    pub(super) inhibitors: Option<Box<Inhibitors>>,
    /// For the tap's own messages, if they are of several words.
    words: Option<Box<Words>>,
}

impl Room {
    /// No room: for ports of a layer that does not beat yet.
    pub fn none() -> Room {
        Room::default()
    }

    /// Room for a tap whose messages are of `kind`, and for as many as a port may have.
    pub fn full(kind: Kind) -> Room {
        Room {
            taps: Vec::with_capacity(TAPS_MAX),
            inhibitors: Some(Box::default()),
            words: (!kind.single()).then(Box::default),
        }
    }
}

/// The inhibitors on one output, and how many messages they dropped.
#[derive(Debug, Default)]
pub(super) struct Inhibitors {
    pub(super) taps: Vec<Joined>,
    pub(super) inhibited: u64,
}

/// What became of a message that a port looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// It took effect.
    Delivered,
    /// A tap's window kept it out.
    Rejected,
    /// It was no message: not a number, out of range, or stamped in the future.
    Fault,
}

/// A message of a tap that a port took in at its last look.
#[derive(Clone, Copy, Debug)]
pub struct TapLook<'t> {
    /// The tap, by the number of its gauge.
    pub tap: u16,
    /// The message's number on its wire.
    pub number: u64,
    /// When it was written, as the tap's window has it; of a faulty message that of the one before.
    pub stamp: Time,
    /// Its words; of a faulty message those of the one before.
    pub words: &'t [f64],
    /// What became of it.
    pub fate: Fate,
}

/// A tap with what was last seen of it. What a beat touches of a silent one is one line of the processor's cache.
#[derive(Debug)]
#[repr(C, align(64))]
pub(super) struct Joined {
    pub(super) seen: u64,
    /// The stamp of its newest message, if it `said` one.
    stamp: Time,
    said: bool,
    /// Whether its newest message came in at the last look.
    pub(super) fresh: bool,
    /// What became of the message that the last look took in, if it took one in.
    pub(super) fate: Option<Fate>,
    /// Told to go; stays until its window has run out, so that nothing rejected comes back to life.
    pub(super) leaving: bool,
    pub(super) end: TapEnd,
    /// Its newest message, if that is of one word; else it lies in the room that the tap brought.
    word: f64,
}

const _: () = assert!(size_of::<Joined>() == 128 && offset_of!(Joined, end.time_constant) == 48);

impl Joined {
    /// Does not allocate if the tap brings [`Room::full`].
    pub(super) fn new(mut end: TapEnd) -> Joined {
        // A message written before the tap was joined has no effect: the wire was not tapped then.
        let seen = end.reader.read().map_or(0, |r| r.number);
        if !end.reader.kind().single() {
            end.room.words.get_or_insert_default();
        }
        Joined {
            end,
            seen,
            stamp: Time::ZERO,
            said: false,
            word: 0.0,
            fresh: false,
            fate: None,
            leaving: false,
        }
    }

    /// Whether the tap may have a message that was not seen. Forgets what the look before took in.
    #[inline]
    pub(super) fn has_news(&mut self) -> bool {
        self.fresh = false;
        self.fate = None;
        !self.leaving && self.end.reader.changed(self.seen)
    }

    /// Takes in the tap's newest message, of up to `N` words, if it is one that was not seen: then it is `fresh`.
    #[inline(never)]
    pub(super) fn take_in<const N: usize>(&mut self, now: Time, limits: Option<&Limits>) {
        let reader = &self.end.reader;
        let mut words = [0.0; N];
        let taken = if N == 1 {
            reader.take_word_newer(self.seen).map(|(number, stamp, word)| {
                words[0] = word;
                (number, stamp)
            })
        } else {
            reader.take_newer(self.seen, &mut words)
        };
        let Some((number, stamp)) = taken else { return };
        self.seen = number;
        let stamp = match plausible(stamp, now) {
            Some(stamp) if stamp >= self.stamp && limits.is_none_or(|l| l.accept(&words)) => stamp,
            _ => {
                count(&self.end.gauge.faults);
                self.fate = Some(Fate::Fault);
                return;
            }
        };
        self.stamp = stamp;
        self.said = true;
        match &mut self.end.room.words {
            Some(all) => all[..N].copy_from_slice(&words),
            None => self.word = words[0],
        }
        self.fresh = true;
        self.fate = Some(Fate::Rejected);
    }

    /// Counts a message of the wire that this tap's window kept out.
    pub(super) fn reject(&self) {
        count(&self.end.gauge.rejected);
    }

    /// Counts a message of the tap that took effect.
    pub(super) fn take_effect(&mut self) {
        count(&self.end.gauge.delivered);
        self.fate = Some(Fate::Delivered);
    }

    /// What the last look took in.
    pub(super) fn look_taken(&self) -> Option<TapLook<'_>> {
        let fate = self.fate?;
        Some(TapLook {
            tap: self.end.gauge.number(),
            number: self.seen,
            stamp: self.stamp,
            words: &self.words()[..self.end.reader.kind().words()],
            fate,
        })
    }

    /// The window that its newest message holds open; `None` if it said nothing yet.
    #[inline]
    pub(super) fn window(&self) -> Option<Window> {
        let time_constant = self.end.time_constant;
        let stamp = self.stamp;
        self.said.then_some(Window { stamp, time_constant })
    }

    /// The words of its newest message.
    pub(super) fn words(&self) -> &[f64] {
        match &self.end.room.words {
            Some(words) => &words[..],
            None => std::slice::from_ref(&self.word),
        }
    }

    pub(super) fn state(&self) -> TapState {
        TapState {
            window: self.window(),
            counts: self.end.gauge.counts(),
        }
    }

    #[inline]
    pub(super) fn gone(&self, now: Time) -> bool {
        self.leaving && self.window().is_none_or(|w| now >= w.stamp + w.time_constant)
    }
}

/// A tap as it stands, for those who watch.
#[derive(Clone, Copy, Debug)]
pub struct TapState {
    /// Its newest message's window.
    pub window: Option<Window>,
    /// What was counted.
    pub counts: TapCounts,
}

/// The stamp of a message read at `now`: never later than `now` (it was written while this beat was
/// already under way), or `None` if it lies so far ahead that its writer's clock is wrong.
#[inline]
pub(super) fn plausible(stamp: Time, now: Time) -> Option<Time> {
    (stamp <= now + AHEAD_MAX).then(|| stamp.min(now))
}

/// Joins `end` after taps of lower or equal level; gives it back when there is no room.
pub(super) fn join(taps: &mut Vec<Joined>, mut end: TapEnd) -> Result<(), TapEnd> {
    if taps.len() == TAPS_MAX {
        return Err(end);
    }
    if taps.len() == taps.capacity() && end.room.taps.capacity() > taps.len() {
        // Moves into the room that came along; the old one leaves with the tap.
        let mut room = std::mem::take(&mut end.room.taps);
        room.append(taps);
        end.room.taps = std::mem::replace(taps, room);
    }
    if taps.len() == taps.capacity() {
        // One more than there is: a vector left to itself takes room for four at once.
        taps.reserve_exact(1);
    }
    let place = taps
        .iter()
        .position(|t| t.end.level > end.level)
        .unwrap_or(taps.len());
    taps.insert(place, Joined::new(end));
    Ok(())
}

/// Tells the taps of `plug` to go.
pub(super) fn release(taps: &mut [Joined], plug: Plug) {
    for tap in taps.iter_mut().filter(|t| t.end.plug == plug) {
        tap.leaving = true;
    }
}

pub(super) fn window_of(taps: &[Joined], gauge: &Arc<TapGauge>) -> Option<Window> {
    let tap = taps.iter().find(|t| Arc::ptr_eq(&t.end.gauge, gauge))?;
    tap.window()
}

/// Hands over the taps that have left and whose windows have run out.
#[inline]
pub(super) fn sweep(taps: &mut Vec<Joined>, now: Time, mut gone: impl FnMut(TapEnd)) {
    let mut k = 0;
    while k < taps.len() {
        if taps[k].gone(now) {
            gone(taps.remove(k).end);
        } else {
            k += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Page;

    fn end(level: u8, room: Room) -> TapEnd {
        let page = Page::in_memory(1);
        TapEnd {
            reader: page.reader(0, Kind::Number).expect("there"),
            time_constant: Span::millis(1),
            level,
            plug: u32::from(level),
            gauge: Arc::default(),
            room,
        }
    }

    #[test]
    fn a_tap_with_room_is_joined_without_a_new_allocation() {
        // Full with one tap: the next needs room.
        let mut taps = Vec::with_capacity(1);
        join(&mut taps, end(3, Room::none())).expect("room for the file's own");
        let room = Room::full(Kind::Number);
        let (place, size) = (room.taps.as_ptr(), room.taps.capacity());
        join(&mut taps, end(1, room)).expect("room came along");
        assert_eq!(
            (taps.as_ptr(), taps.capacity()),
            (place, size),
            "moved into the room"
        );
        // The next ones need none of theirs, and give it back untouched.
        for level in [2, 5, 4] {
            join(&mut taps, end(level, Room::full(Kind::Number))).expect("room is there");
            assert_eq!(taps.as_ptr(), place);
        }
        let levels: Vec<u8> = taps.iter().map(|t| t.end.level).collect();
        assert_eq!(levels, [1, 2, 3, 4, 5], "in series by level");
        release(&mut taps, 1);
        let mut gone = Vec::new();
        sweep(&mut taps, Time(0), |end| gone.push(end));
        assert_eq!(
            (gone.len(), taps.len(), taps.as_ptr()),
            (1, 4, place),
            "the room stays when who brought it goes"
        );
    }

    #[test]
    fn there_is_an_end_to_taps() {
        let mut taps = Vec::new();
        for _ in 0..TAPS_MAX {
            join(&mut taps, end(1, Room::full(Kind::Number))).expect("within the bound");
        }
        assert!(join(&mut taps, end(1, Room::full(Kind::Number))).is_err());
    }
}
