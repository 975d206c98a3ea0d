//! `why` and `holders`: the chain behind a message, and who holds what, live or from a recording.
//!
//! Must never work anything out by itself: `recording::why` does, from one record for both.

use std::path::PathBuf;

use ipc::clock::{Span, Time};
use ipc::wiring::creature::How;
use recording::Recording;
use recording::why::{self, Holder, Input, Link, TapSeen};
use serde_json::json;

use crate::record;

/// Where to look, and when.
pub(crate) struct When {
    pub(crate) from: Option<PathBuf>,
    pub(crate) at: Option<f64>,
}

impl When {
    fn recording(&self, creature: &str) -> Result<(Recording, Time), String> {
        let recording = match &self.from {
            Some(path) => recording::read(path)?,
            None => record::past(creature)?,
        };
        let Some((first, last)) = stretch(&recording) else {
            return Err("nothing was recorded yet".into());
        };
        let began = Time(recording.manifest.began_ns);
        let at = match self.at {
            None => last,
            Some(s) if s < 0.0 => last - Span::from_seconds(-s).unwrap_or(Span::ZERO),
            Some(s) => began + Span::from_seconds(s).unwrap_or(Span::ZERO),
        };
        if at < first || at > last {
            let seconds = |t| recording.manifest.seconds(t);
            return Err(format!(
                "--at {:.3}: the recording goes from {:.3} to {:.3} s after the creature began \
                 (a negative number counts from its end)",
                seconds(at),
                seconds(first),
                seconds(last)
            ));
        }
        Ok((recording, at))
    }
}

/// The moments between which something is known; where only what is held is known, one moment.
fn stretch(recording: &Recording) -> Option<(Time, Time)> {
    let held = recording.beats.iter().flatten().map(|b| Time(b.commit_ns)).max();
    recording.stretch().or(held.map(|t| (t, t)))
}

pub(crate) fn why(creature: &str, wire: &str, when: &When, as_json: bool) -> Result<(), String> {
    let (recording, at) = when.recording(creature)?;
    let link = why::why(&recording, wire, at)?;
    if as_json {
        println!(
            "{}",
            json!({"at_s": recording.manifest.seconds(at), "chain": link})
        );
    } else {
        println!("at {:.3} s", recording.manifest.seconds(at));
        print!("{}", chain_text(&link));
    }
    Ok(())
}

/// The chain as a tree of lines.
pub(crate) fn chain_text(link: &Link) -> String {
    let mut text = String::new();
    link_text(link, "", "", &mut text);
    text
}

fn link_text(link: &Link, first: &str, rest: &str, text: &mut String) {
    let value = value_text(&link.value);
    let unit = if link.unit.is_empty() {
        String::new()
    } else {
        format!(" {}", link.unit)
    };
    *text += &format!("{first}{} = {value}{unit}  ({})\n", link.wire, age(link.age_ms));
    let input = matches!(link.inputs.as_slice(), [one] if one.port == link.wire);
    let by = match (&link.module, link.level) {
        (Some(_), Some(level)) if input => format!("an input of layer {} (level {level})", link.layer),
        (Some(module), Some(level)) => format!("by {module}, layer {} (level {level})", link.layer),
        _ if link.layer == recording::manifest::MOTOR && link.module.is_none() && !link.inputs.is_empty() => {
            "told to the body by the motor unit".into()
        }
        _ => "a sensor of the body".into(),
    };
    let process = link.pid.map_or(String::new(), |pid| format!(", process {pid}"));
    let above = if link.above { "; explained above" } else { "" };
    *text += &format!("{rest}    {by}{process}, message {}{above}\n", link.number);
    if !link.halted.is_empty() {
        *text += &format!("{rest}    the halt gate was closed: {}\n", link.halted.join(", "));
    }
    if link.inhibited > 0 {
        *text += &format!("{rest}    {} messages inhibited since\n", link.inhibited);
    }
    if !link.traced && !link.inputs.is_empty() {
        *text += &format!("{rest}    (what it looked at is told from stamps)\n");
    }
    for (k, input) in link.inputs.iter().enumerate() {
        input_text(input, rest, k + 1 == link.inputs.len(), text);
    }
}

fn value_text(value: &[f64]) -> String {
    match value {
        [] => "(pulse)".to_string(),
        [one] => format!("{one:.3}"),
        many => {
            let words: Vec<String> = many.iter().map(|v| format!("{v:.2}")).collect();
            format!("[{}]", words.join(" "))
        }
    }
}

fn input_text(input: &Input, rest: &str, last: bool, text: &mut String) {
    let (branch, below) = if last {
        ("└─ ", "   ")
    } else {
        ("├─ ", "│  ")
    };
    let arrived = if input.arrived { "just arrived" } else { "held" };
    let by = match (&input.held, &input.tap) {
        (None, _) => "had nothing".to_string(),
        (Some(_), Some(layer)) => format!("{arrived}, brought by the tap of {layer}"),
        (Some(_), None) => arrived.into(),
    };
    *text += &format!("{rest}{branch}{}: {by}\n", input.port);
    let inner = format!("{rest}{below}");
    for tap in &input.taps {
        *text += &format!("{inner}{}\n", tap_text(tap));
    }
    if let Some(newest) = &input.newest_rejected {
        let (n, s) = (input.rejected, if input.rejected == 1 { "" } else { "s" });
        let ago = newest.age_ms.map_or(String::new(), |ms| format!(", {}", age(ms)));
        let said = value_text(&newest.value);
        *text += &format!(
            "{inner}{n} message{s} of {} rejected since, the newest {said}{ago}\n",
            newest.wire
        );
    }
    if let Some(held) = &input.held {
        link_text(held, &inner, &inner, text);
    }
}

fn tap_text(tap: &TapSeen) -> String {
    let mark = if tap.kind == How::Suppress { "(S)" } else { "(I)" };
    let state = match (tap.holds, tap.age_ms) {
        (true, _) => format!("holds, {} left", span(tap.left_ms)),
        (false, Some(ms)) => format!("does not hold, spoke {} ago", span(ms)),
        (false, None) => "never spoke".into(),
    };
    format!(
        "{mark} {} of {} (level {}): {state}",
        tap.from, tap.layer, tap.level
    )
}

fn age(ms: f64) -> String {
    format!("{} old", span(ms))
}

/// Milliseconds as a person reads them.
fn span(ms: f64) -> String {
    match ms {
        _ if ms < 1.0 => format!("{:.0} us", ms * 1e3),
        _ if ms < 1000.0 => format!("{ms:.1} ms"),
        _ => format!("{:.1} s", ms / 1e3),
    }
}

pub(crate) fn holders(creature: &str, when: &When, as_json: bool) -> Result<(), String> {
    let (recording, at) = when.recording(creature)?;
    let holders = why::holders(&recording, at);
    if as_json {
        println!(
            "{}",
            json!({"at_s": recording.manifest.seconds(at), "holders": holders})
        );
        return Ok(());
    }
    println!("at {:.3} s", recording.manifest.seconds(at));
    if holders.is_empty() {
        println!("nothing is tapped");
    }
    holders.iter().for_each(|h| print!("{}", holder_text(h)));
    Ok(())
}

pub(crate) fn holder_text(h: &Holder) -> String {
    let holder = h.holder.as_deref().unwrap_or("nobody");
    let state = match (&h.layer, &h.next, h.kind) {
        (Some(layer), Some(next), How::Suppress) => {
            format!("held by {holder} of {layer} for {}; then {next}", span(h.left_ms))
        }
        (Some(layer), _, How::Inhibit) => {
            format!(
                "silenced by {holder} of {layer} for {}; then it speaks again",
                span(h.left_ms)
            )
        }
        (None, _, How::Inhibit) => "speaks".into(),
        _ => format!("held by {holder}, its own wire"),
    };
    let mut text = format!("{}: {state}\n", h.port);
    h.taps
        .iter()
        .for_each(|tap| text += &format!("  {}\n", tap_text(tap)));
    text
}
