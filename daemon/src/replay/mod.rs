//! Replay: a recording's sensors through the layers again, and where the outputs differ.
//!
//! Must never guess when a beat was or what it saw where the recording says so: each beat is handed the two times
//! that it was handed then, and each register finds the message that it found then. So the same build gives the
//! same outputs to the bit, though the creature ran on real threads that raced each other.
//!
//! ```text
//!   recorded sensors and attached layers ─┐
//!                                         ├─► private cell of each register ─► step, commit ─► compare
//!   replayed wires of the layers ─────────┘            (the recording says up to which beat it had seen)
//! ```
//! What layers write to each other is taken from the replay, not from the recording: a difference spreads as it
//! would have in the creature. A layer that the recording does not know beats at its own times and sees what had
//! been written by then.

mod build;
mod player;

use std::collections::BTreeMap;

use afsm::Kinds;
use ipc::clock::Time;
use ipc::message::Words;
use ipc::wiring::creature::Creature;
use recording::Recording;
use recording::reader::Message;
use serde::Serialize;

use player::{Origin, Player};

/// What came of a replay.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Outcome {
    /// Beats that were run.
    pub beats: u64,
    /// Seconds of the creature's life that were run.
    pub seconds: f64,
    /// What was compared, by wire (or input of the body).
    pub outputs: BTreeMap<String, Compared>,
    /// What stands in the way of an exact replay.
    pub doubts: Vec<String>,
}

/// What was compared of one output.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Compared {
    /// Messages in the recording.
    pub recorded: u64,
    /// Messages in the replay.
    pub replayed: u64,
    /// Beats in which the two differ.
    pub differing: u64,
    /// The first of them.
    pub first: Option<Difference>,
    /// When they differed last, in seconds since the daemon began.
    pub last_s: Option<f64>,
}

/// Where recording and replay differ.
#[derive(Clone, Debug, Serialize)]
pub struct Difference {
    /// The beat of the layer.
    pub beat: u64,
    /// Seconds since the daemon began.
    pub time_s: f64,
    /// What was recorded, if anything.
    pub recorded: Option<Vec<f64>>,
    /// What the replay gave, if anything.
    pub replayed: Option<Vec<f64>>,
}

impl Outcome {
    /// In how many beats outputs differ.
    pub fn differing(&self) -> u64 {
        self.outputs.values().map(|o| o.differing).sum()
    }
}

/// A message of the replay: the beat that wrote it, its stamp, its words.
type Played = (u64, Time, Words);

/// A replay under way.
struct Play<'r> {
    recording: &'r Recording,
    players: Vec<Player>,
    /// By player and output, what was written so far.
    played: Vec<Vec<Vec<Played>>>,
    beats: u64,
}

/// Runs `recording` through the layers of `creature`, built of `kinds`.
pub fn replay(recording: &Recording, creature: &Creature, kinds: &Kinds) -> Outcome {
    let players = build::players(recording, creature, kinds);
    let played = players
        .iter()
        .map(|p| vec![Vec::new(); p.outputs.len()])
        .collect();
    let mut play = Play {
        recording,
        players,
        played,
        beats: 0,
    };
    while let Some(next) = play.next() {
        play.beat(next);
    }
    let mut outcome = Outcome {
        beats: play.beats,
        seconds: recording.span().seconds(),
        doubts: doubts(recording, creature),
        ..Outcome::default()
    };
    for (player, played) in play.players.iter().zip(&play.played) {
        compare(recording, player, played, &mut outcome.outputs);
    }
    outcome
}

fn doubts(recording: &Recording, creature: &Creature) -> Vec<String> {
    let mut doubts = Vec::new();
    if !recording.from_the_beginning() {
        let begin = recording
            .stretch()
            .map_or(0.0, |(first, _)| recording.manifest.seconds(first));
        doubts.push(format!(
            "the recording begins {begin:.1} s after the creature: its modules start from their initial states here, \
             and may differ until those no longer matter (`subsumed --record FILE` records from the first beat)"
        ));
    }
    if !recording.whole {
        doubts.push("the recording was cut off; what is there was replayed".into());
    }
    let missing = recording.beats_missing();
    if missing > 0 {
        doubts.push(format!("{missing} beats are missing from the recording"));
    }
    for source in &recording.manifest.sources {
        let layer = creature.layers.iter().any(|l| l.name == source.name);
        if source.level.is_some() && !layer {
            doubts.push(format!(
                "the creature has no layer {:?}, the recording has",
                source.name
            ));
        }
    }
    for layer in &creature.layers {
        if recording.manifest.source(&layer.name).is_none() {
            doubts.push(format!(
                "the recording has no layer {:?}: nothing to compare it with",
                layer.name
            ));
        }
    }
    doubts
}

impl Play<'_> {
    /// The player whose beat wrote first.
    fn next(&self) -> Option<usize> {
        let due = |p: &Player| p.next().map(|b| b.commit_ns);
        let players = self.players.iter().enumerate();
        players
            .filter_map(|(i, p)| Some((due(p)?, i)))
            .min()
            .map(|(_, i)| i)
    }

    /// Runs one beat of a player, after all that it depends on.
    fn beat(&mut self, index: usize) {
        let Some(beat) = self.players[index].next().cloned() else {
            return;
        };
        self.players[index].busy = true;
        self.players[index].note_joined(&beat, self.recording);
        for needed in 0..self.players[index].feeds.len() {
            let Origin::Replayed(other, _) = self.players[index].feeds[needed].origin else {
                continue;
            };
            let upto = self.players[index].horizon(needed, &beat, &self.players[other]);
            while upto.is_some_and(|upto| self.players[other].next().is_some_and(|b| b.number <= upto))
                && !self.players[other].busy
            {
                self.beat(other);
            }
        }
        let messages: Vec<_> = (0..self.players[index].feeds.len())
            .filter_map(|feed| Some((feed, self.message_for(index, feed, &beat)?)))
            .collect();
        let player = &mut self.players[index];
        for (feed, message) in messages {
            player.feeds[feed].put(&message);
        }
        let written = player.run(&beat);
        player.done += 1;
        player.busy = false;
        if !beat.base {
            self.beats += 1;
            for (output, words) in written {
                self.played[index][output].push((beat.number, Time(beat.commit_ns), words));
            }
        }
    }

    /// What the cell of a feed is to hold in this beat, if it is something new.
    fn message_for(&mut self, index: usize, feed: usize, beat: &recording::reader::Beat) -> Option<Message> {
        let looked = self.players[index].looked(feed, beat);
        match &self.players[index].feeds[feed].origin {
            Origin::Recorded(plug, wire) => {
                let (number, _) = looked?;
                self.recording.message(*plug, wire, number).copied()
            }
            &Origin::Replayed(other, output) => {
                let upto = self.players[index].horizon(feed, beat, &self.players[other]);
                if let Some((number, _)) = looked {
                    self.players[index].feeds[feed].seen = number;
                    let wire = &self.players[other].outputs[output].name;
                    if !self.players[other].knows(output, number) {
                        // Written before the recording begins.
                        return self.recording.message(0, wire, number).copied();
                    }
                }
                let played = &self.played[other][output];
                let end = played.partition_point(|(beat, ..)| upto.is_some_and(|upto| *beat <= upto));
                let feed = &mut self.players[index].feeds[feed];
                if end <= feed.fed {
                    return None;
                }
                feed.fed = end;
                let (_, stamp, words) = played[end - 1];
                Some(Message {
                    number: end as u64,
                    stamp,
                    words,
                })
            }
        }
    }
}

/// Compares what a player wrote with what was recorded of it.
fn compare(
    recording: &Recording,
    player: &Player,
    played: &[Vec<Played>],
    outputs: &mut BTreeMap<String, Compared>,
) {
    for (output, played) in player.outputs.iter().zip(played) {
        let Some(recorded) = output.recorded(recording, player) else {
            continue;
        };
        let recorded: BTreeMap<u64, Words> = recorded.collect();
        let replayed: BTreeMap<u64, Words> = played.iter().map(|(beat, _, words)| (*beat, *words)).collect();
        let compared = outputs.entry(output.name.clone()).or_default();
        compared.recorded += recorded.len() as u64;
        compared.replayed += replayed.len() as u64;
        for beat in player.beats.iter().filter(|b| !b.base) {
            let (then, now) = (recorded.get(&beat.number), replayed.get(&beat.number));
            if same(then, now) {
                continue;
            }
            let shown = |words: Option<&Words>| words.map(|w| w[..output.kind.words()].to_vec());
            let time_s = recording.manifest.seconds(Time(beat.commit_ns));
            compared.differing += 1;
            compared.last_s = Some(time_s);
            compared.first.get_or_insert(Difference {
                beat: beat.number,
                time_s,
                recorded: shown(then),
                replayed: shown(now),
            });
        }
    }
}

/// Whether two messages are the same to the bit; what is no number is recorded as just that.
fn same(then: Option<&Words>, now: Option<&Words>) -> bool {
    match (then, now) {
        (None, None) => true,
        (Some(then), Some(now)) => then
            .iter()
            .zip(now)
            .all(|(a, b)| a.to_bits() == b.to_bits() || !a.is_finite() && !b.is_finite()),
        _ => false,
    }
}
