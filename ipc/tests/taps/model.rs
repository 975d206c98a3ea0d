//! What the rules of Brooks 1991 §6.2 say, asked of every message in turn.
//!
//! Must never forget a message or merge two windows: it keeps all there ever was, and is as slow as that.

/// A message: in which tick, by which source.
pub(crate) type Message = (u64, usize);

/// A suppressor as it is declared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Suppressor {
    pub(crate) level: u8,
    pub(crate) tau: u64,
}

/// Whether any of the messages at `ticks` rejects one at `u`: t ≤ u < t+τ.
pub(crate) fn rejects(ticks: &[u64], tau: u64, u: u64) -> bool {
    ticks.iter().any(|&t| t <= u && u < t + tau)
}

/// An input with its suppressors, which are told of messages tick by tick.
#[derive(Clone, Debug, Default)]
pub(crate) struct Input {
    suppressors: Vec<Suppressor>,
    /// Every message that ever came, by source.
    came: Vec<Vec<u64>>,
    pub(crate) delivered: Vec<Message>,
    pub(crate) rejected: Vec<Message>,
}

impl Input {
    pub(crate) fn new(suppressors: &[Suppressor]) -> Input {
        Input {
            suppressors: suppressors.to_vec(),
            came: vec![Vec::new(); suppressors.len() + 1],
            ..Input::default()
        }
    }

    /// Whether tap `a` stands further along the wire than `source`: everything stands further along
    /// than the existing wire, and then level decides, and declaration within a level.
    fn further_along(&self, a: usize, source: usize) -> bool {
        if source == 0 {
            return true;
        }
        let (x, y) = (self.suppressors[a - 1].level, self.suppressors[source - 1].level);
        x > y || (x == y && a > source)
    }

    /// All messages of one tick.
    pub(crate) fn tick(&mut self, now: u64, wrote: impl Fn(usize) -> bool) {
        let sources = (0..self.came.len()).filter(|&s| wrote(s)).collect::<Vec<_>>();
        for &source in &sources {
            self.came[source].push(now);
        }
        for source in sources {
            let stopped = (1..self.came.len()).any(|tap| {
                self.further_along(tap, source)
                    && rejects(&self.came[tap], self.suppressors[tap - 1].tau, now)
            });
            if stopped {
                self.rejected.push((now, source));
            } else {
                self.delivered.push((now, source));
            }
        }
    }

    /// The message in the register: the last that was delivered.
    pub(crate) fn held(&self) -> Option<Message> {
        self.delivered.last().copied()
    }
}
