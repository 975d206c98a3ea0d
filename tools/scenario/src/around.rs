//! The messages around a moment, for reports of what came instead.
//!
//! Must never show more than a person reads.

use ipc::clock::Span;
use ipc::message::{Kind, Words};

use crate::plan::Window;
use crate::values::shown;

/// Most messages shown.
const SHOWN_MAX: usize = 6;

/// The few messages nearest to `window`, those in it first, in order of time.
pub(crate) fn nearest(messages: &[(Span, Words)], kind: Kind, window: Window) -> Vec<String> {
    if messages.is_empty() {
        return vec!["nothing came at all".into()];
    }
    let distance = |at: Span| {
        if window.holds(at) {
            0
        } else if at < window.from {
            window.from.0 - at.0
        } else {
            at.0 - window.to.0 + 1
        }
    };
    let mut near: Vec<&(Span, Words)> = messages.iter().collect();
    near.sort_by_key(|(at, _)| distance(*at));
    let more = near.len().saturating_sub(SHOWN_MAX);
    near.truncate(SHOWN_MAX);
    near.sort_by_key(|(at, _)| *at);
    let line = |(at, words): &&(Span, Words)| {
        let mark = if window.holds(*at) { "" } else { "  (outside)" };
        let at = at.to_string();
        format!("{at:>12}  {}{mark}", shown(words, kind))
    };
    let mut lines: Vec<String> = near.iter().map(line).collect();
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    lines
}
