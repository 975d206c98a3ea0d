//! Reports: the files that a run leaves, in the formats that others read.
//!
//! Must never hold what was not measured: every file is made of the same tracks.

pub mod curves;
pub mod hgrm;
pub mod log;
pub mod table;

use std::path::Path;
use std::time::SystemTime;

use serde_json::{Value, json};

use crate::track::{QUANTILES, Track};

/// Writes every file of a run into `folder`, which is made if need be: `latency.hlog`, one `.hgrm` a track,
/// `latency.svg`, `latency.json`, `latency.md`.
///
/// # Errors
/// When a file cannot be written.
pub fn write(
    folder: &Path,
    began: SystemTime,
    tracks: &[Track],
    summary: &Value,
    table: &str,
) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    log::write(&folder.join("latency.hlog"), began, tracks)?;
    for track in tracks {
        hgrm::write(&folder.join(format!("{}.hgrm", track.name())), &track.total)?;
    }
    std::fs::write(folder.join("latency.svg"), curves::draw(tracks))?;
    let mut all = summary.clone();
    all["tracks"] = tracks.iter().map(describe).collect();
    std::fs::write(folder.join("latency.json"), format!("{all:#}\n"))?;
    std::fs::write(folder.join("latency.md"), table)
}

/// A track in numbers, nanoseconds.
pub fn describe(track: &Track) -> Value {
    let mut shown = json!({
        "of": track.of, "metric": track.metric, "samples": track.total.len(),
        "max_ns": track.total.max(), "mean_ns": track.total.mean(),
    });
    for (name, q) in QUANTILES {
        shown[format!("{name}_ns")] = json!(track.total.value_at_quantile(q));
    }
    shown
}
