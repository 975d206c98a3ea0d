//! A trial: one creature in its office on the virtual clock, with what a stranger would ask about it.

use std::collections::BTreeSet;

use afsm::Kinds;
use daemon::body::Place;
use daemon::body::office::{OfficeGuard, OfficeWorld};
use daemon::machine::{Machine, kinds};
use daemon::virtual_run::VirtualRun;
use ipc::clock::Span;
use ipc::wire::{Page, Reader};
use ipc::wiring::{Source, check, directory::output_ports};
use office::{Contacts, Pose};

use crate::Allen;

/// One creature in its office.
pub struct Trial {
    run: VirtualRun,
    wires: Vec<(Reader, u64)>,
    hash: u64,
}

/// What one trial came to.
#[derive(Clone, Debug)]
pub struct Figures {
    /// Metres that the robot went.
    pub travelled_m: f64,
    /// Headings it drove in, of 36 sectors of ten degrees.
    pub headings: usize,
    /// Rooms it was in.
    pub rooms: BTreeSet<&'static str>,
    /// Farthest from where it began, metres.
    pub drift_m: f64,
    /// Contacts, in full those that are kept.
    pub contacts: Contacts,
}

/// The rooms of the standard office: name, west, south, east, north, metres.
const ROOMS: [(&str, f64, f64, f64, f64); 7] = [
    ("lab", 0.0, 0.0, 7.0, 5.0),
    ("kitchen", 7.0, 0.0, 12.0, 5.0),
    ("Carol's office", 12.0, 0.0, 18.0, 5.0),
    ("corridor", 0.0, 5.0, 18.0, 7.0),
    ("Ann's office", 0.0, 7.0, 6.0, 12.0),
    ("Bob's office", 6.0, 7.0, 11.0, 12.0),
    ("meeting room", 11.0, 7.0, 18.0, 12.0),
];

/// FNV-1a, 64 bits: start and prime.
const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0100_0000_01b3);

impl Trial {
    /// A trial of `allen`, starting where the layout says.
    pub fn new(allen: Allen) -> Trial {
        Trial::of(&allen.text(), &kinds(), None)
    }

    /// A trial of the creature that `text` describes, built of `kinds`, starting at `start`.
    ///
    /// # Panics
    /// With the checker's findings, when the text is not a creature file.
    pub fn of(text: &str, kinds: &Kinds, start: Option<Place>) -> Trial {
        let creature = check::creature(&Source::new("trial.toml", text), kinds);
        let creature = creature.unwrap_or_else(|rejected| panic!("{rejected}"));
        let ports: Vec<_> = output_ports(&creature).map(|(_, port, _)| port.kind).collect();
        let page = Page::in_memory(ports.len());
        let reader = |(index, kind)| page.reader(index, kind).expect("the page has this wire");
        let wires = ports
            .into_iter()
            .enumerate()
            .map(|wire| (reader(wire), 0))
            .collect();
        let run = VirtualRun::new(Machine::new(creature, kinds, page, start));
        Trial {
            run,
            wires,
            hash: FNV.0,
        }
    }

    /// The run itself.
    pub fn run(&mut self) -> &mut VirtualRun {
        &mut self.run
    }

    /// The office that the robot is in.
    ///
    /// # Panics
    /// When the creature's body is of another kind.
    pub fn office(&mut self) -> OfficeGuard<'_> {
        let body = self.run.machine.body.as_mut().expect("the creature has a body");
        let world = body.world.as_any().downcast_mut::<OfficeWorld>();
        world.expect("the body is in an office").office()
    }

    /// Where the robot is.
    pub fn pose(&mut self) -> Pose {
        self.office().true_pose()
    }

    /// Lets `seconds` pass.
    pub fn pass(&mut self, seconds: u64) {
        self.run.advance(Span::secs(seconds));
    }

    /// Lets `seconds` pass and takes every message on every wire into the [`Trial::hash`].
    pub fn pass_hashing(&mut self, seconds: u64) {
        // Nothing beats faster than this, so no message is overwritten unseen.
        let beat = Span::millis(10);
        for _ in 0..Span::secs(seconds).0 / beat.0 {
            self.run.advance(beat);
            for (index, (wire, seen)) in self.wires.iter_mut().enumerate() {
                let Some(reading) = wire.newer_than(*seen) else {
                    continue;
                };
                assert_eq!(reading.number, *seen + 1, "a message on wire {index} went unseen");
                *seen = reading.number;
                let words = reading.words[..wire.kind().words()].iter().map(|w| w.to_bits());
                for bits in [index as u64, reading.stamp.0].into_iter().chain(words) {
                    for byte in bits.to_le_bytes() {
                        self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(FNV.1);
                    }
                }
            }
        }
    }

    /// The hash of all messages so far that were taken in.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// Lets `seconds` pass and says what came of it.
    pub fn figures(&mut self, seconds: u64) -> Figures {
        let begin = self.pose();
        let (mut headings, mut rooms, mut drift_m) = (BTreeSet::new(), BTreeSet::new(), 0.0_f64);
        let mut before = begin;
        for _ in 0..seconds {
            self.pass(1);
            let now = self.pose();
            drift_m = drift_m.max((now.x - begin.x).hypot(now.y - begin.y));
            let (dx, dy) = (now.x - before.x, now.y - before.y);
            // Half a second of full speed: it drove, it did not only turn or brake.
            if dx.hypot(dy) > 0.15 {
                headings.insert((dy.atan2(dx).to_degrees() / 10.0).floor() as i32);
            }
            rooms.extend(room_of(now));
            before = now;
        }
        let office = self.office();
        Figures {
            travelled_m: office.distance_travelled_m(),
            headings: headings.len(),
            rooms,
            drift_m,
            contacts: office.contacts().clone(),
        }
    }
}

fn room_of(pose: Pose) -> Option<&'static str> {
    let inside = |&&(_, west, south, east, north): &&(&str, f64, f64, f64, f64)| {
        (west..east).contains(&pose.x) && (south..north).contains(&pose.y)
    };
    ROOMS.iter().find(inside).map(|room| room.0)
}
