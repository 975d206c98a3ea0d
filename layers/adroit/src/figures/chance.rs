//! What learning makes of chance, and how many experiences it needs when the cues do belong together.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;

use crate::hierarchy::{CriterionId, Goal, Senses, StateId, StimulusId};
use crate::language::{Running, Vocabulary};
use crate::learning::{Learner, WINDOW_S};

/// A moment of experience, seconds.
const MOMENT_S: f64 = 0.1;
/// Mean time between two onsets of a random cue, seconds: rare enough to end, frequent enough to coincide.
const APART_S: f64 = 4.0;

/// What learning made of cues that have nothing to do with each other, and of two that have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Chance {
    /// Times that an unused cue and a known one came together by chance.
    pub co_occurrences: u32,
    /// Trials in which that could have happened.
    pub trials: u32,
    /// Commands proposed on the way; a proposal that is not confirmed is dropped.
    pub proposed: u32,
    /// Commands applied.
    pub applied: u32,
    /// Experiences until the command was proposed, with cues that belong together.
    pub experiences_to_propose: u32,
    /// Experiences until it was applied.
    pub experiences_to_apply: u32,
}

const PROGRAM: &str = "rm rest reports to top. add stimulus always to rm rest with magnitude 0.1.
    mcu m reports to rm rest.
    rm act reports to top. add stimulus known to rm act with magnitude 1. mcu n reports to rm act.";

#[derive(Default)]
struct Cues {
    /// `known`, `new`: until when each is present, seconds.
    until_s: [f64; 2],
    now_s: f64,
}

impl Senses for Cues {
    fn stimulus(&self, stimulus: StimulusId, _: &Goal) -> f64 {
        f64::from(u8::from(self.now_s < self.until_s[usize::from(stimulus.0) - 1]))
    }

    fn select(&self, _: CriterionId, _: &Goal) -> Option<Goal> {
        None
    }

    fn holds(&self, _: StateId, _: &Goal) -> bool {
        false
    }
}

struct School {
    cues: Cues,
    learner: Learner,
    running: Running,
    moments: u32,
}

impl School {
    fn new() -> Self {
        let vocabulary = Vocabulary::new(&["known", "new"], &[], &[], &["m", "n"]);
        let running = Running::load(PROGRAM, vocabulary).expect("the program is right");
        Self {
            cues: Cues::default(),
            learner: Learner::new(),
            running,
            moments: 0,
        }
    }

    fn moment(&mut self) -> bool {
        self.moments += 1;
        self.cues.now_s = f64::from(self.moments) * MOMENT_S;
        self.running.hierarchy_mut().evaluate(&self.cues);
        let learned = self
            .learner
            .observe(self.cues.now_s, &self.cues, &mut self.running);
        learned.expect("commands are right").is_some()
    }

    fn show(&mut self, cue: usize) {
        self.cues.until_s[cue] = self.cues.now_s + 0.5;
    }
}

/// Lets two unrelated cues meet so many times, then two that belong together as often as it takes.
#[must_use]
pub fn chance(co_occurrences: u32, seed: u64) -> Chance {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut school = School::new();
    let (mut proposed, mut applied, mut was_proposed) = (0, 0, false);
    let (mut hits, mut trials) = (0, 0);
    while hits < co_occurrences && applied == 0 {
        for cue in 0..2 {
            if random.random::<f64>() < MOMENT_S / APART_S {
                school.show(cue);
            }
        }
        applied += u32::from(school.moment());
        if let Some(pair) = school.learner.associations(&school.running).first() {
            (hits, trials) = (pair.hits, pair.experiences);
            proposed += u32::from(pair.proposed && !was_proposed);
            was_proposed = pair.proposed;
        }
    }
    let (experiences_to_propose, experiences_to_apply) = lessons();
    Chance {
        co_occurrences: hits,
        trials,
        proposed,
        applied,
        experiences_to_propose,
        experiences_to_apply,
    }
}

/// The new cue leads the known one by half a window, twice a minute.
fn lessons() -> (u32, u32) {
    let mut school = School::new();
    let moments = |seconds: f64| (seconds / MOMENT_S) as u32;
    let mut proposed = 0;
    for lesson in 1..1000 {
        let mut learned = false;
        for moment in 0..moments(30.0) {
            match moment {
                0 => school.show(1),
                lead if lead == moments(WINDOW_S / 2.0) => school.show(0),
                _ => {}
            }
            learned |= school.moment();
        }
        let pair = school.learner.associations(&school.running).into_iter().next();
        if proposed == 0 && pair.is_none_or(|pair| pair.proposed) {
            proposed = lesson;
        }
        if learned {
            return (proposed, lesson);
        }
    }
    (proposed, 0)
}
