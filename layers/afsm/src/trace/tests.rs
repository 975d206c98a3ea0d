//! Tests of traces: what goes in comes out, whatever was lost between.
//!
//! Must never look at how a beat is told on the way.

use ipc::clock::{Span, Time};
use ipc::message::{KINDS, Kind, WORDS_MAX, Words};
use ipc::wire::{Fate, TapLook};
use ipc::wiring::creature::How;

use super::{Entry, NUMBER_MAX, TracedBeat, Tracer, decode, trace};
use crate::random::Random;

#[test]
fn a_beat_goes_round() {
    let (mut tracer, mut trace) = trace(Span::millis(10), 3, 2);
    let words = [1.5, -0.0, f64::NAN];
    let look = TapLook {
        tap: 7,
        number: 9,
        stamp: Time(5),
        words: &words[..2],
        fate: Fate::Rejected,
    };
    for beat in 0..3 {
        tracer.begin(Time(10 + beat));
        tracer.saw(2, 77, Fate::Fault);
        tracer.tap(&look);
        tracer.joined(1, 7, How::Inhibit, 200, 3, Span::secs(2));
        tracer.released(3);
        tracer.wrote(1, NUMBER_MAX, &words[..1]);
        tracer.dropped(0);
        tracer.causes(65);
        tracer.passed(2, &words[1..2]);
        tracer.end(Time(20 + beat));
    }
    for number in 0..3 {
        let beat = decode(&trace.next_beat().expect("three beats were traced"));
        assert_eq!(
            (beat.number, beat.step, beat.commit),
            (number, Time(10 + number), Time(20 + number))
        );
        assert_eq!(beat.entries.len(), 8);
        let first = Entry::Saw {
            slot: 2,
            number: 77,
            fate: Fate::Fault,
        };
        assert_eq!(beat.entries[0], first);
        let Entry::Tap { tap: 7, words, .. } = &beat.entries[1] else {
            panic!("{:?}", beat.entries[1])
        };
        assert_eq!(words, &[1.5, -0.0]);
        let joined = Entry::Joined {
            slot: 1,
            tap: 7,
            how: How::Inhibit,
            level: 200,
            plug: 3,
            time_constant: Span::secs(2),
        };
        assert_eq!(beat.entries[2], joined);
        let wrote = Entry::Wrote {
            slot: 1,
            number: NUMBER_MAX,
            words: vec![1.5],
        };
        assert_eq!(beat.entries[4], wrote);
        assert_eq!(beat.entries[6], Entry::Causes(65));
    }
    assert!(trace.next_beat().is_none());
    assert_eq!(trace.lost(), 0);
}

#[test]
fn beats_that_nobody_fetches_and_beats_too_long_are_counted() {
    let (mut tracer, mut trace) = trace(Span::secs(1), 0, 0);
    let mut ended = 0;
    while trace.lost() == 0 {
        tracer.begin(Time(ended));
        tracer.end(Time(ended));
        ended += 1;
    }
    let fetched = std::iter::from_fn(|| trace.next_beat()).count() as u64;
    assert_eq!(fetched + trace.lost(), ended);
    tracer.begin(Time(0));
    (0..100_000).for_each(|_| tracer.dropped(0));
    tracer.end(Time(0));
    assert_eq!(trace.lost(), 2);
    assert!(trace.next_beat().is_none());
}

/// How many registers and outlets the model has: more than a word has bits.
const PORTS: (usize, usize) = (150, 70);

/// A layer in name only: throws dice, tells a tracer what they say, and knows what it told.
struct Model {
    dice: Random,
    /// The last number of each register.
    saw: Vec<u64>,
    /// The last number of each outlet, and its kind.
    wrote: Vec<(u64, Kind)>,
}

impl Model {
    fn new(seed: u64) -> Model {
        let mut dice = Random::new(seed);
        // Far in, so that numbers come round.
        let number = |dice: &mut Random| NUMBER_MAX - dice.between(0.0, 30.0) as u64;
        let saw = (0..PORTS.0).map(|_| number(&mut dice)).collect();
        let wrote = (0..PORTS.1).map(|slot| (number(&mut dice), KINDS[slot % KINDS.len()]));
        let wrote = wrote.collect();
        Model { dice, saw, wrote }
    }

    fn below(&mut self, end: usize) -> usize {
        self.dice.between(0.0, end as f64) as usize
    }

    fn words(&mut self) -> Words {
        std::array::from_fn(|_| self.dice.between(-1.0, 1.0))
    }

    /// What happens in one beat: told to `tracer`, and given as entries.
    fn beat(&mut self, tracer: &mut Tracer) -> Vec<Entry> {
        let mut told = Vec::new();
        if self.below(20) == 0 {
            told.push(Entry::Released { plug: 3 });
            tracer.released(3);
        }
        // Module by module, in whatever order.
        let mut modules: Vec<usize> = (0..PORTS.0 / 3).collect();
        if self.below(3) == 0 {
            modules.rotate_left(7);
        }
        for module in modules {
            for slot in 3 * module..3 * (module + 1) {
                self.register(tracer, slot, &mut told);
            }
        }
        if self.below(10) == 0 {
            told.push(Entry::Causes(5));
            tracer.causes(5);
        }
        for slot in 0..PORTS.1 {
            self.outlet(tracer, slot, &mut told);
        }
        if tracer.begins_anew() {
            tracer.tell_numbers(self.saw.iter().copied(), self.wrote.iter().copied());
        }
        told
    }

    fn register(&mut self, tracer: &mut Tracer, slot: usize, told: &mut Vec<Entry>) {
        let (steps, fate) = match self.below(20) {
            0..4 => return,
            4 => (5, Fate::Delivered),
            5 => (1, Fate::Rejected),
            6 => (2, Fate::Fault),
            7 => return self.tap(tracer, told),
            _ => (1, Fate::Delivered),
        };
        let number = (self.saw[slot] + steps) & NUMBER_MAX;
        self.saw[slot] = number;
        told.push(Entry::Saw { slot, number, fate });
        match (steps, fate) {
            (1, Fate::Delivered) => tracer.saw_next(slot),
            _ => tracer.saw(slot, number, fate),
        }
    }

    fn tap(&mut self, tracer: &mut Tracer, told: &mut Vec<Entry>) {
        let (words, number) = (self.words(), self.below(1000) as u64);
        let (tap, stamp, fate) = (7, Time(number), Fate::Delivered);
        tracer.tap(&TapLook {
            tap,
            number,
            stamp,
            words: &words[..2],
            fate,
        });
        let words = words[..2].to_vec();
        told.push(Entry::Tap {
            tap,
            number,
            stamp,
            words,
            fate,
        });
    }

    fn outlet(&mut self, tracer: &mut Tracer, slot: usize, told: &mut Vec<Entry>) {
        let words = self.words();
        let (last, kind) = &mut self.wrote[slot];
        let spoken = words[..kind.words()].to_vec();
        let number = (*last + 1) & NUMBER_MAX;
        match self.dice.between(0.0, 10.0) as u64 {
            0 => return,
            1 => {
                tracer.dropped(slot);
                told.push(Entry::Dropped { slot });
                return;
            }
            2 => tracer.wrote(slot, number, &spoken),
            _ => tracer.wrote_next(slot, *kind, &words),
        }
        *last = number;
        told.push(Entry::Wrote {
            slot,
            number,
            words: spoken,
        });
    }
}

/// The entries as those who record rest on them: each sort in its own order, messages by their slots.
fn sorted(mut entries: Vec<Entry>) -> Vec<Entry> {
    entries.sort_by_key(|entry| match entry {
        Entry::Joined { .. } | Entry::Released { .. } => (0, 0),
        Entry::Saw { slot, .. } => (1, *slot),
        Entry::Tap { .. } => (2, 0),
        Entry::Causes(_) => (3, 0),
        Entry::Passed { .. } => (4, 0),
        Entry::Dropped { .. } => (5, 0),
        Entry::Wrote { slot, .. } => (6, *slot),
    });
    entries
}

#[test]
fn random_beats_come_out_as_they_went_in_whatever_was_lost_between() {
    // An interpreter takes a minute for what takes us a millisecond.
    let (seeds, least) = if cfg!(miri) {
        (1, (0, 0))
    } else {
        (40, (500, 2000))
    };
    let (mut lost, mut came) = (0, 0);
    for seed in 0..seeds {
        let mut model = Model::new(seed);
        let (mut tracer, mut out) = trace(Span::secs(1), PORTS.0, PORTS.1);
        let mut told = Vec::new();
        let mut fetched: Vec<TracedBeat> = Vec::new();
        for beat in 0..200 {
            tracer.begin(Time(beat));
            told.push(sorted(model.beat(&mut tracer)));
            tracer.end(Time(1000 + beat));
            if model.below(30) == 0 {
                tracer.forget();
            }
            // Now and then the other side is behind.
            if model.below(15) == 0 {
                fetched.extend(std::iter::from_fn(|| out.next_beat()).map(|words| decode(&words)));
            }
        }
        fetched.extend(std::iter::from_fn(|| out.next_beat()).map(|words| decode(&words)));
        assert_eq!(fetched.len() as u64 + out.lost(), 200);
        (lost, came) = (lost + out.lost(), came + fetched.len());
        for beat in fetched {
            assert_eq!((beat.step.0, beat.commit.0), (beat.number, 1000 + beat.number));
            assert_eq!(
                sorted(beat.entries),
                told[beat.number as usize],
                "seed {seed}, beat {}",
                beat.number
            );
        }
    }
    assert!(lost > least.0 && came > least.1, "{lost} lost, {came} came");
}

#[test]
fn a_beat_of_the_next_messages_is_short() {
    let (mut tracer, out) = trace(Span::millis(1), 150, 100);
    let words: Words = [0.5; WORDS_MAX];
    for beat in 0..2 {
        tracer.begin(Time(beat));
        (0..150).for_each(|slot| tracer.saw_next(slot));
        (0..100).for_each(|slot| tracer.wrote_next(slot, Kind::Number, &words));
        if tracer.begins_anew() {
            tracer.tell_numbers((0..150).map(|_| 1), (0..100).map(|_| (1, Kind::Number)));
        }
        tracer.end(Time(beat));
    }
    // Header, three words and two of bits, a word for each message; the numbers once.
    assert_eq!(out.waiting(), 2 * (4 + 3 + 2 + 100) + 250);
}
