//! One unused cue and one RM with a known cue: their trials and the evidence from them.

use super::{EVIDENCE_LEAST, PROPOSED, TOGETHER, WINDOW_S};
use crate::hierarchy::StimulusId;

/// A pair under observation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) cue: StimulusId,
    pub(super) candidate: usize,
    pub(super) trials: u32,
    pub(super) hits: u32,
    pub(super) evidence: f64,
    pub(super) proposed: bool,
    pub(super) opened_s: Option<f64>,
}

impl Pair {
    pub(super) fn new(cue: StimulusId, candidate: usize) -> Self {
        Self {
            cue,
            candidate,
            trials: 0,
            hits: 0,
            evidence: 0.0,
            proposed: false,
            opened_s: None,
        }
    }

    /// The cue set in. While a trial is open a further onset is the same experience.
    pub(super) fn open(&mut self, now_s: f64) {
        if self.opened_s.is_none() {
            self.opened_s = Some(now_s);
        }
    }

    /// Closes a trial when the known cue came, or when its window is over.
    pub(super) fn close(&mut self, now_s: f64, known_s: f64, chance: f64) {
        let Some(opened_s) = self.opened_s else { return };
        let hit = (known_s - opened_s).abs() <= WINDOW_S;
        if !hit && now_s - opened_s <= WINDOW_S {
            return;
        }
        self.opened_s = None;
        self.trials += 1;
        self.hits += u32::from(hit);
        let ratio = if hit {
            TOGETHER / chance
        } else {
            (1.0 - TOGETHER) / (1.0 - chance)
        };
        self.evidence = (self.evidence + libm::log(ratio)).max(EVIDENCE_LEAST);
        self.proposed |= self.evidence >= PROPOSED;
        if self.evidence < 0.0 {
            self.proposed = false;
        }
    }
}
