//! Tables in Markdown, for a terminal and a pull request alike.

use std::fmt::Write as _;

use crate::track::{QUANTILES, Track, micros};

/// The tracks, microseconds.
pub fn of(tracks: &[Track]) -> String {
    let mut out = String::from("| of | what | samples |");
    QUANTILES.iter().for_each(|(name, _)| {
        let _ = write!(out, " {name} |");
    });
    out.push_str(" max |\n|---|---|---:|");
    out.push_str(&"---:|".repeat(QUANTILES.len() + 1));
    out.push('\n');
    for track in tracks {
        let _ = write!(out, "| {} | {} | {} |", track.of, track.metric, track.total.len());
        for (_, q) in QUANTILES {
            let _ = write!(out, " {} |", micros(track.total.value_at_quantile(q)));
        }
        let _ = writeln!(out, " {} |", micros(track.total.max()));
    }
    out
}
