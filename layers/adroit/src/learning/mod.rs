//! Learning: a cue that meant nothing comes together with one that excites an RM, and in time releases it.
//!
//! Must never: apply a command in an evaluation, or consider an RM that was not listening.
//!
//! A *trial* is the onset of an unused cue while an RM listens. It is a *hit* when a known exciting cue of
//! that RM sets in within [`WINDOW_S`] before or after. Each trial is weighed by how much more likely it is
//! if the two belong together than if they meet by chance, chance being how often the known cue sets in
//! anyway (a sequential likelihood ratio). The command is *proposed* at [`PROPOSED`] and, once further
//! experience confirms it, *applied* at [`APPLIED`].
//!
//! ```text
//!  onset of unused cue ──► open trial ──known cue within the window──► hit  ──► evidence up   ──► propose ──► apply
//!                                     └─window over────────────────► miss ──► evidence down
//! ```
//!
//! Source: *An application to learning*.

mod pair;

use crate::hierarchy::{Goal, LevelIndex, MechanismIndex, Senses, StimulusId};
use crate::language::{Problems, Running};
use pair::Pair;

/// Two cues belong to one experience when they set in within this time, seconds.
pub const WINDOW_S: f64 = 1.0;
/// How likely a hit is if the cues belong together.
const TOGETHER: f64 = 0.95;
/// A hit is never taken to be rarer by chance than this.
const CHANCE_LEAST: f64 = 0.05;
/// Nor to be more frequent: above it nothing can be learned from hits.
const CHANCE_MOST: f64 = 0.8;
/// Evidence never falls below this, so that a cue can gain meaning later.
const EVIDENCE_LEAST: f64 = -3.0;
/// Evidence at which a command is proposed: a thousand to one.
pub const PROPOSED: f64 = 6.9;
/// Evidence at which it is applied: a hundred million to one, for every pair gets many chances.
pub const APPLIED: f64 = 18.4;
/// Most pairs of an unused cue and an RM under observation.
const PAIRS_MAX: usize = 4096;
/// An RM must have listened this long before its known cue's rate is trusted, seconds.
const LISTENED_LEAST_S: f64 = 5.0;

/// What the learner found out about a cue and an RM.
#[derive(Clone, Debug, PartialEq)]
pub struct Association {
    /// The cue that meant nothing.
    pub cue: String,
    /// The RM it is to excite.
    pub rm: String,
    /// The known cue it came together with.
    pub known: String,
    /// Magnitude of the known cue, and of the new input.
    pub magnitude: f64,
    /// Trials so far.
    pub experiences: u32,
    /// Those in which the cues came together.
    pub hits: u32,
    /// Natural logarithm of the odds that the cues belong together.
    pub evidence: f64,
    /// Whether the command was proposed.
    pub proposed: bool,
    /// Whether it was applied.
    pub applied: bool,
}

impl Association {
    /// The assembly command.
    #[must_use]
    pub fn command(&self) -> String {
        format!(
            "add stimulus {} to rm {} with magnitude {}.",
            self.cue, self.rm, self.magnitude
        )
    }
}

/// Watches a running hierarchy and its senses from outside.
#[derive(Clone, Debug, Default)]
pub struct Learner {
    /// For each stimulus, whether it was present before.
    present: Vec<bool>,
    /// For each stimulus, its latest onset, seconds.
    onset_s: Vec<f64>,
    pairs: Vec<Pair>,
    candidates: Vec<Candidate>,
    /// The revision of the program that the candidates were taken from.
    revision: Option<u64>,
    before_s: f64,
}

/// An RM with one of its exciting inputs.
#[derive(Clone, Debug)]
struct Candidate {
    /// Its place, in the revision that the learner knows.
    rm: MechanismIndex,
    name: String,
    known: StimulusId,
    magnitude: f64,
    listened_s: f64,
    covered_s: f64,
}

impl Learner {
    /// A learner that has experienced nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// One moment of experience, to be called after evaluations or in every beat. Applies what was confirmed,
    /// and returns it.
    ///
    /// # Errors
    /// The problems of a confirmed command that the program does not take.
    pub fn observe<S: Senses>(
        &mut self,
        now_s: f64,
        senses: &S,
        running: &mut Running,
    ) -> Result<Option<Association>, Problems> {
        self.refresh(running);
        let passed_s = (now_s - self.before_s).max(0.0);
        self.before_s = now_s;
        let onsets = self.onsets(now_s, senses);
        self.count_chance(now_s, passed_s, running);
        for &cue in &onsets {
            self.open_trials(now_s, cue, running);
        }
        self.close_trials(now_s);
        self.apply_confirmed(running)
    }

    /// What was observed, strongest evidence first.
    #[must_use]
    pub fn associations(&self, running: &Running) -> Vec<Association> {
        let mut all: Vec<_> = self
            .pairs
            .iter()
            .map(|pair| self.described(pair, running))
            .collect();
        all.sort_by(|one, other| other.evidence.total_cmp(&one.evidence));
        all
    }

    /// Takes an applied association back, on request: the input is removed by a command of its own, and the
    /// experience with it.
    ///
    /// # Errors
    /// If the cue is no input of the RM, or the program would not be right without it.
    pub fn forget(&mut self, cue: &str, rm: &str, running: &mut Running) -> Result<(), Problems> {
        running.apply(&format!("remove stimulus {cue} from rm {rm}."))?;
        let vocabulary = running.vocabulary();
        let candidates = &self.candidates;
        self.pairs.retain(|pair| {
            vocabulary.stimulus_name(pair.cue) != cue || candidates[pair.candidate].name != rm
        });
        Ok(())
    }

    /// Takes up the RMs and cues of the program when it changed.
    fn refresh(&mut self, running: &Running) {
        let vocabulary = running.vocabulary();
        let count = vocabulary.stimuli().count();
        self.present.resize(count, false);
        self.onset_s.resize(count, f64::NEG_INFINITY);
        let revision = running.revision();
        if self.revision == Some(revision) {
            return;
        }
        self.revision = Some(revision);
        let hierarchy = running.hierarchy();
        let used = |stimulus: StimulusId| {
            hierarchy.mechanisms().iter().enumerate().any(|(place, _)| {
                let rm = MechanismIndex(u16::try_from(place).expect("bounded by MECHANISMS_MAX"));
                hierarchy
                    .inputs(rm)
                    .iter()
                    .any(|input| input.stimulus == stimulus)
            })
        };
        let before: Vec<_> = self.candidates.drain(..).collect();
        let old_pairs: Vec<_> = self.pairs.drain(..).collect();
        for level in 0..hierarchy.levels().len() {
            for rm in hierarchy.members(LevelIndex(u16::try_from(level).expect("bounded"))) {
                for input in hierarchy.inputs(rm) {
                    if input.magnitude > 0.0 && input.stimulus != StimulusId::ALWAYS {
                        self.candidates.push(Candidate {
                            rm,
                            name: hierarchy.name(rm).to_owned(),
                            known: input.stimulus,
                            magnitude: input.magnitude,
                            listened_s: 0.0,
                            covered_s: 0.0,
                        });
                    }
                }
            }
        }
        let unused: Vec<_> = (1..count)
            .map(|place| StimulusId(u16::try_from(place).expect("vocabularies are small")))
            .filter(|&stimulus| !used(stimulus))
            .collect();
        // Experience with RMs that are still the same is kept; what is learned already is done with.
        for (place, candidate) in self.candidates.iter_mut().enumerate() {
            let old = before
                .iter()
                .position(|old| old.name == candidate.name && old.known == candidate.known);
            if let Some(old) = old {
                let old = &before[old];
                candidate.listened_s = old.listened_s;
                candidate.covered_s = old.covered_s;
            }
            for &cue in &unused {
                if self.pairs.len() < PAIRS_MAX {
                    let known = old_pairs
                        .iter()
                        .find(|pair| Some(pair.candidate) == old && pair.cue == cue);
                    let pair = known.map_or_else(
                        || Pair::new(cue, place),
                        |&pair| Pair {
                            candidate: place,
                            ..pair
                        },
                    );
                    self.pairs.push(pair);
                }
            }
        }
    }

    fn onsets<S: Senses>(&mut self, now_s: f64, senses: &S) -> Vec<StimulusId> {
        let mut onsets = Vec::new();
        for place in 1..self.present.len() {
            let stimulus = StimulusId(u16::try_from(place).expect("vocabularies are small"));
            let present = senses.stimulus(stimulus, &Goal::NONE) > 0.5;
            if present && !self.present[place] {
                self.onset_s[place] = now_s;
                onsets.push(stimulus);
            }
            self.present[place] = present;
        }
        onsets
    }

    /// How much of an RM's listening time lies within the window of an onset of its known cue: what a cue
    /// that has nothing to do with it would hit by chance.
    fn count_chance(&mut self, now_s: f64, passed_s: f64, running: &Running) {
        for candidate in &mut self.candidates {
            if running.hierarchy().listens(candidate.rm) {
                candidate.listened_s += passed_s;
                // The window reaches as far back as forward, and what is behind counts just as much.
                if now_s - self.onset_s[usize::from(candidate.known.0)] <= WINDOW_S {
                    candidate.covered_s += 2.0 * passed_s;
                }
            }
        }
    }

    fn open_trials(&mut self, now_s: f64, cue: StimulusId, running: &Running) {
        for pair in self.pairs.iter_mut().filter(|pair| pair.cue == cue) {
            if running.hierarchy().listens(self.candidates[pair.candidate].rm) {
                pair.open(now_s);
            }
        }
    }

    fn close_trials(&mut self, now_s: f64) {
        for pair in &mut self.pairs {
            let candidate = &self.candidates[pair.candidate];
            let known_s = self.onset_s[usize::from(candidate.known.0)];
            let chance = if candidate.listened_s < LISTENED_LEAST_S {
                CHANCE_MOST
            } else {
                candidate.covered_s / candidate.listened_s
            };
            pair.close(now_s, known_s, chance.clamp(CHANCE_LEAST, CHANCE_MOST));
        }
    }

    fn apply_confirmed(&mut self, running: &mut Running) -> Result<Option<Association>, Problems> {
        // Of several cues known to one RM, or several RMs, the strongest evidence goes first; one a moment.
        let Some(best) = self.pairs.iter().position(|pair| pair.evidence >= APPLIED) else {
            return Ok(None);
        };
        let association = Association {
            applied: true,
            ..self.described(&self.pairs[best], running)
        };
        self.pairs.remove(best);
        running.apply(&association.command())?;
        Ok(Some(association))
    }

    fn described(&self, pair: &Pair, running: &Running) -> Association {
        let candidate = &self.candidates[pair.candidate];
        let vocabulary = running.vocabulary();
        Association {
            cue: vocabulary.stimulus_name(pair.cue).to_owned(),
            rm: candidate.name.clone(),
            known: vocabulary.stimulus_name(candidate.known).to_owned(),
            magnitude: candidate.magnitude,
            experiences: pair.trials,
            hits: pair.hits,
            evidence: pair.evidence,
            proposed: pair.proposed,
            applied: false,
        }
    }
}
