//! From a scenario file to a scenario that is known to be sound.
//!
//! Must never run anything, nor stop at the first error: all that is wrong with the file and with the files
//! it names is shown at once.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use afsm::Kinds;
use daemon::virtual_run::Manifest;
use ipc::clock::Span;
use ipc::wiring::creature::Creature;
use ipc::wiring::diagnostic::{Diagnostic, Findings, Rejected, Source};
use ipc::wiring::document::{self as doc, DeValue, Keys, Placed, Spanned};
use ipc::wiring::{Directory, check};

use crate::expectations;
use crate::names::Names;
use crate::plan::{Scenario, What};
use crate::stimuli::{self, Stimuli};

/// How long a scenario goes on after the last time that its file names.
const AFTERWARDS: Span = Span::secs(1);

/// Longest run: a day among people takes a minute, and whatever is longer was hardly meant.
const DURATION_MAX: Span = Span::secs(86_400);

/// Whether the text is meant as a scenario: it has a line that sets `scenario`. Folders hold other files too.
pub fn is_scenario(text: &str) -> bool {
    text.lines().any(|line| {
        let rest = line.trim_start().strip_prefix("scenario");
        rest.is_some_and(|r| r.trim_start().starts_with('='))
    })
}

/// Reads the scenario file at `path`; modules are of `kinds`.
///
/// # Errors
/// Every error of the file, and of the creature file and manifests that it names.
pub fn file(path: &Path, kinds: &Kinds) -> Result<Scenario, Vec<Rejected>> {
    let source = load(path).map_err(|rejected| vec![rejected])?;
    scenario(path, source, kinds)
}

fn load(path: &Path) -> Result<Source, Rejected> {
    let name = path.display().to_string();
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(Source::of_file(path, text)),
        Err(e) => {
            let diagnostic = Diagnostic {
                rule: None,
                at: 0..0,
                message: format!("the file cannot be read: {e}"),
                help: "expected the path of a TOML file".into(),
                also: None,
                within: None,
            };
            Err(Rejected {
                source: Source::new(name, ""),
                diagnostics: vec![diagnostic],
                more: 0,
            })
        }
    }
}

/// Reads a scenario from `source`, which stands (or could stand) at `path`: other files are found from there.
///
/// # Errors
/// Every error of the text, and of the files that it names.
pub fn scenario(path: &Path, source: Source, kinds: &Kinds) -> Result<Scenario, Vec<Rejected>> {
    let mut reading = Reading {
        path,
        source: &source,
        kinds,
        findings: Findings::default(),
        others: Vec::new(),
        names: Names {
            whole: true,
            ..Names::default()
        },
    };
    let scenario = reading.scenario();
    let Reading { findings, others, .. } = reading;
    let mut rejected = others;
    // A scenario that names a bad file has no error of its own, but it is no scenario.
    let scenario = match (scenario, findings.is_clean()) {
        (None, true) => None,
        (scenario, _) => match findings.into_result(&source, scenario) {
            Ok(scenario) => Some(scenario),
            Err(own) => {
                rejected.insert(0, own);
                None
            }
        },
    };
    match scenario {
        Some(scenario) if rejected.is_empty() => Ok(scenario),
        _ => {
            assert!(!rejected.is_empty(), "what is no scenario has an error to show");
            Err(rejected)
        }
    }
}

struct Reading<'r> {
    path: &'r Path,
    source: &'r Source,
    kinds: &'r Kinds,
    findings: Findings,
    /// Errors of other files.
    others: Vec<Rejected>,
    names: Names,
}

type Manifests = BTreeMap<String, Arc<Manifest>>;

impl Reading<'_> {
    fn scenario(&mut self) -> Option<Scenario> {
        let root = doc::parse(self.source, &mut self.findings).filter(|_| self.findings.is_clean())?;
        let mut keys = Keys::new(root.get_ref(), 0..0, "the scenario file");
        let f = &mut self.findings;
        let title = keys
            .need("scenario", f)
            .and_then(|v| doc::text(v, "a sentence", f));
        let about = keys.take("about").and_then(|v| doc::text(v, "some words", f));
        let world = keys.take("world").and_then(|v| doc::bit(v, f)).unwrap_or(false);
        let competence = keys
            .take("competence")
            .and_then(|v| doc::bit(v, f))
            .unwrap_or(false);
        let seed = keys
            .take("seed")
            .and_then(|v| doc::whole(v, 0, i64::MAX as u64, f));
        let levels = keys.take("levels").and_then(|v| doc::whole(v, 0, 255, f));
        let duration = keys.take("duration").and_then(|v| doc::span(v, true, f));
        let start = self.start(&mut keys, world);
        let mut creature = self.creature(&mut keys);
        if let Some(creature) = &mut creature {
            if let Some(seed) = seed {
                creature.seed = seed;
            }
            if let Some(levels) = levels {
                creature.layers.retain(|l| u64::from(l.level) <= levels);
            }
            self.names.add(creature);
        }
        let expected = keys.take("expect");
        let refused = self.refused(expected);
        let manifests = self.manifests(&mut keys, creature.as_ref(), &refused);
        self.names.whole &= creature.is_some();
        let mut stimuli = Stimuli::default();
        stimuli::read(&mut keys, &self.names, &mut stimuli, &mut self.findings);
        keys.finish(&mut self.findings);
        let f = &mut self.findings;
        let items = expectations::read(expected, &self.names, f);
        let times = || stimuli.times.iter().chain(items.iter().flat_map(|i| &i.times));
        let latest = times().map(|(time, _)| *time).max().unwrap_or_default();
        let end = duration.unwrap_or(latest.max(stimuli.latest()) + AFTERWARDS);
        if end > DURATION_MAX {
            let help = format!("expected at most {DURATION_MAX}");
            f.error(0..0, format!("the scenario lasts {end}"), help);
        }
        for (time, at) in times().filter(|(time, _)| *time >= end) {
            let help = format!("the scenario ends at {end}: set a longer duration");
            f.error(at.clone(), format!("nothing happens at {time} any more"), help);
        }
        self.levels_allow(levels, &stimuli);
        let events = stimuli.spread(end, &mut self.findings).into_iter();
        let manifest = |name: &str| manifests.get(name).cloned();
        let events = events.filter_map(|(at, event)| Some((at, event.stimulus(manifest)?)));
        let events = events.collect();
        let needs = items.iter().map(|i| i.level).fold(stimuli.level, u8::max);
        Some(Scenario {
            path: self.path.into(),
            source: self.source.clone(),
            title: title?.value,
            about: about.map(|a| a.value),
            creature: creature?,
            world,
            start,
            duration: end,
            level: levels.map_or(needs, |l| l as u8),
            competence,
            stimuli: events,
            expectations: items.into_iter().filter_map(|i| i.finish(end)).collect(),
            manifests,
            strangers: Vec::new(),
        })
    }

    fn start(&mut self, keys: &mut Keys<'_, '_>, world: bool) -> Option<(f64, f64, f64)> {
        let given = keys.take("start")?;
        let f = &mut self.findings;
        if !world {
            f.error(
                given.span(),
                "a place to start without a world",
                "set world = true",
            );
        }
        let items = doc::array(
            given,
            "where the body starts: [x in m, y in m, heading in rad]",
            f,
        );
        let numbers: Vec<f64> = items
            .iter()
            .filter_map(|n| doc::number(n, -1e6, 1e6, f))
            .collect();
        if let [x, y, heading] = numbers[..] {
            return Some((x, y, heading));
        }
        f.error(
            given.span(),
            "not a place",
            "expected [x in m, y in m, heading in rad]",
        );
        None
    }

    fn creature(&mut self, keys: &mut Keys<'_, '_>) -> Option<Creature> {
        let (named, inline) = (keys.take("creature"), keys.take("wiring"));
        let found = match (named, inline) {
            (Some(path), None) => {
                let path = doc::text(path, "the path of a creature file", &mut self.findings)?;
                let source = self.other(&path)?;
                check::creature(&source, self.kinds)
            }
            (None, Some(_)) => check::inline(self.source, &["wiring"], "creature", self.kinds, None),
            (Some(_), Some(both)) => {
                let help = "expected either creature = \"...\" or a [wiring] of its own";
                self.findings
                    .error(both.span(), "there are a creature file and a wiring", help);
                return None;
            }
            (None, None) => {
                let help = "add creature = \"FILE\" or a table [wiring]";
                self.findings.error(0..0, "the scenario has no creature", help);
                return None;
            }
        };
        match found {
            Ok(creature) => Some(creature),
            Err(rejected) => {
                self.reject(rejected);
                None
            }
        }
    }

    /// Errors of this file join the others; those of another file are shown with it.
    fn reject(&mut self, rejected: Rejected) {
        if rejected.source.name != self.source.name {
            self.others.push(rejected);
            return;
        }
        for d in rejected.diagnostics {
            self.findings.error(d.at, d.message, d.help);
        }
    }

    /// A file named in this one.
    fn other(&mut self, path: &Placed<String>) -> Option<Source> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let path_there: PathBuf = folder.join(&path.value);
        match load(&path_there) {
            Ok(source) => Some(source),
            Err(rejected) => {
                let message = format!("{}: {}", path_there.display(), rejected.diagnostics[0].message);
                let help = "expected a path relative to this file";
                self.findings.error(path.at.clone(), message, help);
                None
            }
        }
    }

    /// The layers that are expected to be refused: their manifests may be wrong.
    fn refused(&mut self, expected: Option<&Spanned<DeValue<'_>>>) -> Vec<String> {
        let mut unheard = Findings::default();
        let items = expected.map(|e| doc::array(e, "expectations", &mut unheard));
        let refused = items.into_iter().flatten().filter_map(|item| {
            let mut keys = doc::table(item, "this", &mut unheard)?;
            let name = doc::text(keys.take("refused")?, "a name", &mut unheard)?;
            Some(name.value)
        });
        refused.collect()
    }

    /// The manifests, each checked against the creature and the manifests before it.
    fn manifests(
        &mut self,
        keys: &mut Keys<'_, '_>,
        creature: Option<&Creature>,
        refused: &[String],
    ) -> Manifests {
        let mut manifests = Manifests::new();
        let table = keys
            .take("manifests")
            .and_then(|v| doc::table(v, "[manifests]", &mut self.findings));
        let mut host = creature.map(|c| Directory::of(c, &c.name));
        for (name, value) in table.into_iter().flat_map(Keys::all) {
            let Some(manifest) = self.manifest(&name, value) else {
                self.names.whole = false;
                continue;
            };
            if let Some(host) = &mut host {
                match manifest.check(self.kinds, host) {
                    Ok(checked) => self.welcome(&name, &checked, host),
                    Err(_) if refused.contains(&name.value) => {
                        self.names
                            .manifests
                            .insert(name.value.clone(), (0, name.value.clone()));
                    }
                    Err(rejected) => {
                        self.names.whole = false;
                        self.reject(rejected);
                    }
                }
            }
            manifests.insert(name.value, Arc::new(manifest));
        }
        manifests
    }

    fn manifest(&mut self, name: &Placed<String>, value: &Spanned<DeValue<'_>>) -> Option<Manifest> {
        if matches!(value.get_ref(), DeValue::Table(_)) {
            let table = Some((vec!["manifests".into(), name.value.clone()], name.value.clone()));
            return Some(Manifest {
                source: self.source.clone(),
                table,
            });
        }
        let path = doc::text(
            value,
            "the path of a manifest, or a table with one",
            &mut self.findings,
        )?;
        Some(Manifest {
            source: self.other(&path)?,
            table: None,
        })
    }

    /// The names of a sound manifest, and what it adds for those after it.
    fn welcome(&mut self, name: &Placed<String>, checked: &Creature, host: &mut Directory) {
        let [layer] = checked.layers.as_slice() else {
            let help = "expected one [[layer]]: a layer process runs one";
            self.findings
                .error(name.at.clone(), "a manifest of more than one layer", help);
            return;
        };
        host.join_checked(checked);
        self.names.add(checked);
        self.names
            .manifests
            .insert(name.value.clone(), (layer.level, layer.name.clone()));
    }

    /// A file for some levels plugs no layer above them.
    fn levels_allow(&mut self, levels: Option<u64>, stimuli: &Stimuli) {
        let Some(levels) = levels else { return };
        for (at, level) in &stimuli.plugged {
            if u64::from(*level) > levels {
                let message = format!("a layer of level {level} joins");
                let help = format!("expected none above level {levels}, as levels = {levels} says");
                self.findings.error(at.clone(), message, help);
            }
        }
    }
}

impl Scenario {
    /// The ports that the expectations name: wires, and inputs.
    pub fn watched(&self) -> (Vec<String>, Vec<String>) {
        let (mut wires, mut inputs) = (Vec::new(), Vec::new());
        for expectation in &self.expectations {
            match &expectation.what {
                What::Messages(m) if m.input => inputs.push(m.port.clone()),
                What::Messages(m) => wires.push(m.port.clone()),
                What::Order { wires: some, .. } => wires.extend(some.iter().cloned()),
                _ => {}
            }
        }
        for names in [&mut wires, &mut inputs] {
            names.sort();
            names.dedup();
        }
        (wires, inputs)
    }
}
