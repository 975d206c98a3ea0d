//! The series: which message a register lets in while suppressors stand before it.
//!
//! Must never let a message through that a window holds off; what a window is, [`crate::tap`] says.

use super::joined::{TapEnd, sweep};
use super::register::{Looked, Register};
use crate::clock::Time;
use crate::tap;

/// A message that may be let in: the existing wire's, or that of the k-th tap.
#[derive(Clone, Copy)]
enum From {
    Wire,
    Tap(usize),
}

impl Register {
    /// Whether no suppressor has anything to say, is about to go, or holds off the existing wire's message, if one
    /// came, by its `stamp`.
    #[inline(always)]
    pub(super) fn quiet(&mut self, stamp: Option<Time>) -> bool {
        let mut quiet = true;
        for tap in &mut self.taps {
            let holds = || stamp.is_some_and(|u| tap.window().is_some_and(|w| w.holds(u)));
            quiet &= !tap.leaving && !holds();
            quiet &= !tap.has_news();
        }
        quiet
    }

    /// Looks at the suppressors, and lets in what they leave of the existing wire's message, if one came, or what
    /// they say themselves.
    #[inline(never)]
    pub(super) fn look_at_taps<const N: usize>(
        &mut self,
        original: Option<(Time, [f64; N])>,
        now: Time,
        gone: impl FnMut(TapEnd),
    ) {
        let limits = self.limits();
        let (mut fresh, mut leaving) = (false, false);
        for tap in &mut self.taps {
            if tap.has_news() {
                tap.take_in::<N>(now, Some(&limits));
                fresh |= tap.fresh;
            }
            leaving |= tap.leaving;
        }
        if fresh {
            self.let_in_newest(original);
        } else if let Some((stamp, words)) = original {
            // No tap spoke: what it decides hangs on the windows alone.
            if self.passes_all(stamp) {
                self.deliver(stamp, &words);
            }
        }
        if leaving {
            sweep(&mut self.taps, now, gone);
            self.tapped = !self.taps.is_empty();
        }
    }

    /// Lets in the newest message of the series, in a beat in which at least one tap spoke.
    #[inline(never)]
    fn let_in_newest<const N: usize>(&mut self, original: Option<(Time, [f64; N])>) {
        let in_hindsight = self.rejected_in_hindsight();
        if in_hindsight {
            self.forget();
        }
        let original = original.filter(|(stamp, _)| self.passes_all(*stamp));
        let mut newest = original.map(|(stamp, _)| (stamp, From::Wire));
        for k in 0..self.taps.len() {
            let (fresh, Some(window)) = (self.taps[k].fresh, self.taps[k].window()) else {
                continue;
            };
            let passes = if fresh {
                self.passes_from(k + 1, window.stamp)
            } else {
                // Looked at before, and counted then.
                let above = &self.taps[k + 1..];
                in_hindsight && tap::passes(window.stamp, above.iter().filter_map(|t| t.window()))
            };
            if passes {
                if fresh {
                    self.taps[k].take_effect();
                }
                if newest.is_none_or(|(stamp, _)| window.stamp >= stamp) {
                    newest = Some((window.stamp, From::Tap(k)));
                }
            }
        }
        let Some((stamp, from)) = newest else { return };
        let mut words = original.map_or([0.0; N], |(_, words)| words);
        if let From::Tap(k) = from {
            let own = self.taps[k].words();
            let length = own.len().min(N);
            words[..length].copy_from_slice(&own[..length]);
        }
        self.deliver(stamp, &words);
    }

    /// Whether a tap's message that came in just now was written before the message held, and its window
    /// rejects that: another process may stamp a message and be held up before it writes it. The register
    /// must not keep a message that its suppressor overrules for as long as the window is open; what it
    /// holds instead is the newest message of the taps.
    fn rejected_in_hindsight(&self) -> bool {
        let Some(held) = self.stamp() else {
            return false;
        };
        // A message of a tap that stands further along is not the lower tap's to reject.
        let from = self
            .taps
            .iter()
            .rposition(|t| t.window().is_some_and(|w| w.stamp == held) && !t.fresh)
            .map_or(0, |k| k + 1);
        let above = &self.taps[from..];
        above
            .iter()
            .any(|t| t.fresh && t.window().is_some_and(|w| w.holds(held)))
    }

    /// Whether the existing wire's message, stamped `u`, gets through all suppressors; counts it if not.
    #[inline]
    fn passes_all(&mut self, u: Time) -> bool {
        let passes = self.passes_from(0, u);
        if !passes {
            self.rejected += 1;
            self.looked = Looked::Rejected;
        }
        passes
    }

    /// Whether a message stamped `u` gets through the suppressors from the `first` on; counts it with the
    /// one that rejects it.
    #[inline]
    fn passes_from(&mut self, first: usize, u: Time) -> bool {
        let above = &self.taps[first..];
        if tap::passes(u, above.iter().filter_map(|t| t.window())) {
            return true;
        }
        if let Some(tap) = above.iter().rfind(|t| t.window().is_some_and(|w| w.holds(u))) {
            tap.reject();
        }
        false
    }
}
