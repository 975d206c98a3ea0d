//! The checker: a file is checked whole before anything of it runs.
//!
//! ```text
//!  names ──► wires ──► taps ──► halt, outsiders ──► schedule ──► reach
//!    (each notes every error it finds; only a file without any becomes a creature)
//! ```
//! Which circles are allowed: wires between modules may form loops, also of a module with itself, since every
//! wire delays its message by a beat at least. Not allowed are loops that nothing can ever enter
//! ([`Rule::DeadLoop`]), layers that read from each other ([`Rule::LayerCycle`] within one level,
//! [`Rule::HigherSource`] between levels: neither could be debugged before the other), and circles of taps:
//! as taps point to a strictly lower level ([`Rule::TapUpward`]) there are none.
//!
//! Must never let a creature through in which a name does not resolve, a type does not match, an input has
//! two writers without a tap, or a lower level could come to depend on a higher one.

mod attached;
mod halt;
mod names;
mod outside;
mod ports;
mod reach;
mod schedule;
mod taps;
mod wires;

use std::collections::HashMap;
use std::ops::Range;

use super::catalog::{Catalog, Declaration};
use super::creature::{Creature, Halt, Layer, PortName};
use super::diagnostic::{Files, Findings, Rejected, Source};
use super::directory::Directory;
use super::document::{self as doc, Keys, Placed};
use super::grammar;
use super::read::{self, Parts, RawLayer};
use super::rule::Rule;
use super::syntax;
use crate::clock::Span;

/// Most layers of a file: each is a thread, and a host with a thousand real-time threads is a mistake.
pub const FILE_LAYERS_MAX: usize = 1_024;

/// Checks a creature file.
///
/// # Errors
/// Every error of the file, each with line, column and what was expected.
pub fn creature(source: &Source, catalog: &dyn Catalog) -> Result<Creature, Rejected> {
    check(source, catalog, None)
}

/// Checks the manifest of a layer that wants to join the creature of `host`.
///
/// # Errors
/// Every error of the file, each with line, column and what was expected.
pub fn manifest(source: &Source, catalog: &dyn Catalog, host: &Directory) -> Result<Creature, Rejected> {
    check(source, catalog, Some(host))
}

fn check(source: &Source, catalog: &dyn Catalog, host: Option<&Directory>) -> Result<Creature, Rejected> {
    let mut findings = Findings::default();
    let Some(root) = doc::parse(source, &mut findings) else {
        return findings.into_result(source, None);
    };
    let keys = Keys::new(root.get_ref(), 0..0, grammar::FILE.what);
    check_part(keys, None, findings, source, catalog, host)
}

/// Checks a creature (or, with a `host`, a layer's manifest) that stands in a table of another document: the
/// one that `path` leads to. It need not say its name; then it is `name`.
///
/// # Errors
/// Every error of that table, each with its line and column in the document. Of errors outside the table only
/// those of syntax are shown.
pub fn inline(
    source: &Source,
    path: &[&str],
    name: &str,
    catalog: &dyn Catalog,
    host: Option<&Directory>,
) -> Result<Creature, Rejected> {
    let mut findings = Findings::default();
    let Some(root) = doc::parse(source, &mut findings) else {
        return findings.into_result(source, None);
    };
    let what = format!("[{}]", path.join("."));
    let mut keys = Keys::new(root.get_ref(), 0..0, what.clone());
    for step in path {
        let Some(value) = keys.get(step) else {
            let message = format!("there is no table {what}");
            findings.refuse(Rule::MissingKey, keys.at(), message, "add it");
            return findings.into_result(source, None);
        };
        let Some(table) = doc::table(value, what.clone(), &mut findings) else {
            return findings.into_result(source, None);
        };
        keys = table;
    }
    check_part(keys, Some(name), findings, source, catalog, host)
}

fn check_part(
    keys: Keys<'_, '_>,
    name: Option<&str>,
    mut findings: Findings,
    source: &Source,
    catalog: &dyn Catalog,
    host: Option<&Directory>,
) -> Result<Creature, Rejected> {
    let at = keys.at();
    let mut parts = read::read(keys, name.is_some(), &mut findings);
    if let (None, Some(name)) = (&parts.name, name) {
        parts.name = Some(Placed {
            value: name.into(),
            at: at.clone(),
        });
    }
    let kinds = |known: Vec<&'static Declaration>| known.into_iter().map(|d| (d.name, d)).collect();
    let mut checker = Checker {
        module_kinds: kinds(catalog.modules()),
        body_kinds: kinds(catalog.bodies()),
        findings,
        files: &source.files,
        host,
        at,
        modules: HashMap::new(),
        outputs: 0,
        writers: HashMap::new(),
        tapped: HashMap::new(),
    };
    let creature = checker.creature(parts);
    syntax::drop_echoes(source, &mut checker.findings);
    checker.findings.into_result(source, creature)
}

/// A module (or the body) by name.
struct Known {
    /// `None` if its kind is unknown, which was complained of.
    declaration: Option<&'static Declaration>,
    level: u8,
    /// Index of its layer in the file.
    layer: usize,
    /// Where its name stands.
    at: Range<usize>,
}

struct Checker<'c> {
    findings: Findings,
    files: &'c Files,
    module_kinds: HashMap<&'static str, &'static Declaration>,
    body_kinds: HashMap<&'static str, &'static Declaration>,
    host: Option<&'c Directory>,
    /// Where the table that is checked begins.
    at: Range<usize>,
    modules: HashMap<String, Known>,
    /// How many outputs there are so far.
    outputs: usize,
    /// Which output feeds each input, and where both stand.
    writers: HashMap<PortName, (Placed<PortName>, Range<usize>)>,
    /// How many taps stand on each port (true for inputs).
    tapped: HashMap<(bool, PortName), usize>,
}

/// A layer that is being checked: what will be of it, and what of it still stands as written.
struct Draft<'t, 's> {
    /// Index in the file.
    index: usize,
    raw: RawLayer<'t, 's>,
    layer: Layer,
}

impl<'c> Checker<'c> {
    fn creature(&mut self, mut parts: Parts<'_, '_>) -> Option<Creature> {
        self.shape(&parts);
        let body = self.take_body(parts.body.take());
        self.layer_names(&parts.layers);
        let layers = std::mem::take(&mut parts.layers);
        let mut drafts: Vec<Draft<'_, '_>> = Vec::new();
        for (index, raw) in layers.into_iter().enumerate() {
            drafts.push(self.draft(index, raw));
        }
        let raw_halt = parts.halt.take().unwrap_or_default();
        let raw_outsiders = parts.outsiders.take().unwrap_or_default();
        let raw_executor = parts.executor.take().unwrap_or_default();
        for draft in &mut drafts {
            self.wires(draft);
        }
        for draft in &mut drafts {
            self.taps(draft, &raw_halt.reflexes);
        }
        let reflexes = self.reflexes(&raw_halt.reflexes);
        let watchdog_device = self.watchdog_device(raw_halt.watchdog_device.as_ref());
        let outsiders = self.outsiders(&raw_outsiders, &raw_halt.reflexes);
        let executor = self.executor(&raw_executor, &drafts);
        self.schedule(&drafts);
        self.layer_cycles(&drafts);
        self.reached(&drafts, &outsiders.tap);
        if let Some(host) = self.host {
            self.policy(&drafts, host);
        }
        let mut layers: Vec<Layer> = drafts.into_iter().map(|d| d.layer).collect();
        layers.sort_by_key(|l| l.level);
        Some(Creature {
            name: parts.name?.value,
            seed: parts.seed.map_or(0, |s| s.value),
            body,
            layers,
            halt: Halt {
                reflexes,
                hold: raw_halt.hold.map_or(Span::millis(500), |h| h.value),
                stale: raw_halt.stale.map_or(Span::millis(200), |s| s.value),
                watchdog_device,
            },
            outsiders,
            executor,
        })
    }

    /// What the file as a whole must have and must not have.
    fn shape(&mut self, parts: &Parts<'_, '_>) {
        if parts.layers.is_empty() && !self.findings.has_lost_lines() {
            let help = "add a [[layer]] with name, level and period";
            self.findings
                .refuse(Rule::NoLayer, self.at.clone(), "there is no layer", help);
        }
        if let Some(first_too_many) = parts.layers.get(FILE_LAYERS_MAX) {
            let message = format!("there are {} layers", parts.layers.len());
            let help = format!("expected at most {FILE_LAYERS_MAX}: each is a thread");
            self.findings
                .refuse(Rule::TooManyLayers, first_too_many.at.clone(), message, help);
        }
        if self.host.is_some() {
            self.manifest_shape(parts);
        }
    }
}
