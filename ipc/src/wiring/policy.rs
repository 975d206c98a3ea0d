//! The policy: what a creature lets layers from outside do.
//!
//! Asked twice: by the checker of manifests, which knows the places in the file, and by the daemon when the layer
//! comes, which trusts nobody's checker.
//!
//! Must never ask the operating system: users and groups are the daemon's own matter.

use super::creature::How;
use super::diagnostic::one_of;
use super::directory::Directory;
use super::rule::Rule;
use crate::clock::Span;

/// What a layer from outside wants.
#[derive(Clone, Debug)]
pub struct Claim<'c> {
    /// Its name.
    pub layer: &'c str,
    /// Its level.
    pub level: u8,
    /// The outputs of others that it reads.
    pub reads: Vec<&'c str>,
    /// Its taps.
    pub taps: Vec<ClaimedTap>,
}

/// A tap that a layer from outside wants.
#[derive(Clone, Debug)]
pub struct ClaimedTap {
    /// Which way it acts.
    pub how: How,
    /// The port it acts on.
    pub to: String,
    /// Its time constant.
    pub time_constant: Span,
}

/// Which part of a claim is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The layer itself.
    Layer,
    /// Its level.
    Level,
    /// What it reads, by index.
    Read(usize),
    /// Where it taps, by index.
    Tap(usize),
    /// The time constant of a tap, by index.
    TimeConstant(usize),
}

/// A part of a claim that the policy does not allow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Breach {
    /// The rule that is broken.
    pub rule: Rule,
    /// By which part.
    pub part: Part,
    /// What is wrong.
    pub message: String,
    /// What would be allowed.
    pub help: String,
}

impl std::fmt::Display for Breach {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}; {}", self.message, self.help)
    }
}

/// Everything in `claim` that the creature of `host` does not allow.
pub fn breaches(host: &Directory, claim: &Claim<'_>) -> Vec<Breach> {
    let mut breaches = Vec::new();
    let mut against = |rule, part, message: String, help: String| {
        breaches.push(Breach {
            rule,
            part,
            message,
            help,
        });
    };
    if host.layers.iter().any(|l| l == claim.layer) {
        let message = format!(
            "the creature {:?} has a layer {:?} already",
            host.creature, claim.layer
        );
        let help = "expected a name of its own for each layer".into();
        against(Rule::DuplicateLayer, Part::Layer, message, help);
    }
    if claim.level > host.level_max {
        let message = format!("level {} is too high", claim.level);
        let help = format!(
            "{:?} lets layers from outside claim levels up to {}",
            host.creature, host.level_max
        );
        against(Rule::LevelTooHigh, Part::Level, message, help);
    }
    for (i, read) in claim.reads.iter().enumerate() {
        if !readable(host, read) {
            let message = format!("{:?} does not let outsiders read {read}", host.creature);
            let open = host.open_reads.iter().flatten().map(String::as_str);
            let help = one_of("open wire", read, open);
            against(Rule::NotReadable, Part::Read(i), message, help);
        }
    }
    for (i, tap) in claim.taps.iter().enumerate() {
        tap_breaches(host, i, tap, &mut against);
    }
    breaches
}

/// Whether outsiders may read the wire of an output. What is not there at all is another fault.
fn readable(host: &Directory, read: &str) -> bool {
    let Some(open) = &host.open_reads else {
        return true;
    };
    open.iter().any(|o| o == read) || !host.outputs.iter().any(|l| l.name == read)
}

fn tap_breaches(
    host: &Directory,
    i: usize,
    tap: &ClaimedTap,
    against: &mut impl FnMut(Rule, Part, String, String),
) {
    let to = &tap.to;
    if tap.how == How::Inhibit && host.reflexes.contains(to) {
        let message = format!("{to} is part of the halt channel");
        let help = "nothing taps the halt channel: remove this tap".into();
        against(Rule::HaltChannel, Part::Tap(i), message, help);
    } else if !host.open_taps.contains(to) {
        let message = format!("{:?} does not open {to} to taps from outside", host.creature);
        let mut help = one_of("open port", to, host.open_taps.iter().map(String::as_str));
        if host.open_taps.is_empty() {
            help = "its [outsiders] table opens no port to taps".into();
        }
        against(Rule::NotOpen, Part::Tap(i), message, help);
    }
    let (low, high) = (host.time_constant_min, host.time_constant_max);
    if !(low..=high).contains(&tap.time_constant) {
        let what = if tap.time_constant > high { "long" } else { "short" };
        let message = format!("the time constant {} is too {what}", tap.time_constant);
        let help = match low {
            Span::ZERO => format!("{:?} allows outsiders at most {high}", host.creature),
            _ => format!("{:?} allows outsiders {low} to {high}", host.creature),
        };
        against(Rule::TimeConstantLimits, Part::TimeConstant(i), message, help);
    }
}
