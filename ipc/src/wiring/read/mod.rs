//! From the document to the parts of a creature, each with its place; names are not resolved yet.
//!
//! Must never compare two parts with each other: that is the checker's work.

mod layer;
pub(crate) mod port;
mod taking;

use std::ops::Range;

use toml::Spanned;
use toml::de::DeValue;

use super::creature::{Account, How, Overrun, PortName};
use super::diagnostic::Findings;
use super::document::{self as doc, Keys, Placed};
use super::grammar;
use super::rule::Rule;
use crate::clock::Span;
use taking::Taking;

/// The parts of a file. What is `None` was not given, or could not be read and was complained of.
#[derive(Default)]
pub(super) struct Parts<'t, 's> {
    pub(super) name: Option<Placed<String>>,
    pub(super) seed: Option<Placed<u64>>,
    pub(super) body: Option<RawBody<'t, 's>>,
    pub(super) layers: Vec<RawLayer<'t, 's>>,
    pub(super) halt: Option<RawHalt>,
    pub(super) outsiders: Option<RawOutsiders>,
    pub(super) executor: Option<RawExecutor>,
}

pub(super) struct RawBody<'t, 's> {
    pub(super) at: Range<usize>,
    pub(super) kind: Option<Placed<String>>,
    pub(super) period: Option<Placed<Span>>,
    pub(super) settings: Keys<'t, 's>,
}

#[derive(Default)]
pub(super) struct RawHalt {
    pub(super) at: Range<usize>,
    pub(super) reflexes: Vec<Placed<PortName>>,
    pub(super) hold: Option<Placed<Span>>,
    pub(super) stale: Option<Placed<Span>>,
    pub(super) watchdog_device: Option<Placed<String>>,
}

#[derive(Default)]
pub(super) struct RawOutsiders {
    /// `None` for all.
    pub(super) reads: Option<Vec<Placed<PortName>>>,
    pub(super) taps: Vec<Placed<PortName>>,
    pub(super) users: Vec<Placed<Account>>,
    pub(super) groups: Vec<Placed<Account>>,
    pub(super) layers_max: Option<Placed<u64>>,
    pub(super) level_max: Option<Placed<u64>>,
    pub(super) time_constant_min: Option<Placed<Span>>,
    pub(super) time_constant_max: Option<Placed<Span>>,
    pub(super) messages_max: Option<Placed<u64>>,
    /// The keys given that say who and how much, not what is open: a manifest has none of them.
    pub(super) limits: Vec<(&'static str, Range<usize>)>,
}

#[derive(Default)]
pub(super) struct RawExecutor {
    pub(super) at: Range<usize>,
    pub(super) policy: Option<Placed<usize>>,
    pub(super) best_effort: Option<Placed<usize>>,
    pub(super) spin_share_max: Option<Placed<f64>>,
}

pub(super) struct RawLayer<'t, 's> {
    pub(super) at: Range<usize>,
    pub(super) name: Option<Placed<String>>,
    pub(super) level: Option<u8>,
    pub(super) period: Option<Span>,
    pub(super) phase: Option<Placed<Span>>,
    pub(super) priority: Option<Placed<u8>>,
    pub(super) cpu: Option<Placed<usize>>,
    pub(super) overrun: Overrun,
    pub(super) vital: Option<Placed<bool>>,
    pub(super) group: Option<Placed<String>>,
    pub(super) spins: bool,
    pub(super) spin: Option<Placed<Span>>,
    pub(super) modules: Vec<RawModule<'t, 's>>,
    pub(super) wires: Vec<(Placed<PortName>, Placed<PortName>)>,
    pub(super) taps: Vec<RawTap>,
}

pub(super) struct RawModule<'t, 's> {
    pub(super) name: Placed<String>,
    /// Its kind and the keys that the kind takes.
    pub(super) kind: Option<(Placed<String>, Keys<'t, 's>)>,
}

pub(super) struct RawTap {
    pub(super) how: How,
    pub(super) from: Option<Placed<PortName>>,
    pub(super) to: Option<Placed<PortName>>,
    pub(super) time_constant: Option<Placed<Span>>,
}

/// The parts of the file or, if it is `inline`, of a table within another file, which may go without a name.
pub(super) fn read<'t, 's>(keys: Keys<'t, 's>, inline: bool, findings: &mut Findings) -> Parts<'t, 's> {
    let nameless = inline && !keys.has("creature");
    let mut file = Taking::new(keys, &grammar::FILE, findings);
    let mut parts = Parts {
        name: if nameless {
            file.unneeded("creature")
        } else {
            file.name("creature")
        },
        seed: file.whole("seed"),
        ..Parts::default()
    };
    parts.body = file.raw("body").and_then(|v| body(v, file.findings));
    if let Some(layers) = file.raw("layer") {
        if layers.get_ref().is_table() {
            file.findings.lose_lines();
            let help = "expected a list of layers: write [[layer]], with two brackets";
            file.findings
                .refuse(Rule::WrongType, layers.span(), "[layer] is a single table", help);
        } else if !layers.get_ref().is_array() {
            file.findings.lose_lines();
        }
        let items = match layers.get_ref().is_table() {
            true => Vec::new(),
            false => doc::array(layers, "layers, each as a [[layer]] table", file.findings),
        };
        for value in items {
            parts.layers.extend(layer::layer(value, file.findings));
        }
    }
    parts.halt = file.raw("halt").and_then(|v| halt(v, file.findings));
    parts.outsiders = file.raw("outsiders").and_then(|v| outsiders(v, file.findings));
    parts.executor = file.raw("executor").and_then(|v| executor(v, file.findings));
    file.finish();
    parts
}

fn body<'t, 's>(value: &'t Spanned<DeValue<'s>>, findings: &mut Findings) -> Option<RawBody<'t, 's>> {
    let mut table = Taking::table(value, &grammar::BODY, findings)?;
    let kind = table.text("kind", "the name of a kind of body");
    let period = table.time("period");
    Some(RawBody {
        at: value.span(),
        kind,
        period,
        settings: table.rest(),
    })
}

fn halt(value: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Option<RawHalt> {
    let mut table = Taking::table(value, &grammar::HALT, findings)?;
    let halt = RawHalt {
        at: value.span(),
        reflexes: table.ports("reflex"),
        hold: table.time("hold"),
        stale: table.time("stale"),
        watchdog_device: table.text(
            "watchdog_device",
            "the path of a watchdog device such as \"/dev/watchdog\"",
        ),
    };
    table.finish();
    Some(halt)
}

fn outsiders(value: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Option<RawOutsiders> {
    let mut table = Taking::table(value, &grammar::OUTSIDERS, findings)?;
    let reads = table.raw("read").and_then(|v| reads(v, table.findings));
    let limits = grammar::OUTSIDERS.keys.iter().map(|key| key.name);
    let limits = limits.filter(|key| !["read", "tap"].contains(key));
    let limits = limits
        .filter_map(|key| Some((key, table.keys.get(key)?.span())))
        .collect();
    let outsiders = RawOutsiders {
        reads,
        taps: table.ports("tap"),
        users: accounts(table.raw("users"), "user", table.findings),
        groups: accounts(table.raw("groups"), "group", table.findings),
        layers_max: table.whole("layers_max"),
        level_max: table.whole("level_max"),
        time_constant_min: table.time("time_constant_min"),
        time_constant_max: table.time("time_constant_max"),
        messages_max: table.whole("messages_max"),
        limits,
    };
    table.finish();
    Some(outsiders)
}

fn executor(value: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Option<RawExecutor> {
    let mut table = Taking::table(value, &grammar::EXECUTOR, findings)?;
    let executor = RawExecutor {
        at: value.span(),
        policy: table.word("policy"),
        best_effort: table.word("best_effort"),
        spin_share_max: table.number("spin_share_max"),
    };
    table.finish();
    Some(executor)
}

/// A list of ports, or `"*"`.
fn reads(value: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Option<Vec<Placed<PortName>>> {
    if let DeValue::String(text) = value.get_ref() {
        if text != "*" {
            let message = format!("{text:?} is not a list of ports");
            let help = format!("expected \"*\" for all wires, or a list of outputs: [{text:?}]");
            findings.refuse(Rule::WrongType, value.span(), message, help);
        }
        return None;
    }
    if !value.get_ref().is_array() {
        let message = format!("a value of type {} found", value.get_ref().type_str());
        let help = "expected \"*\" for all wires, or a list of outputs such as [\"sonar.map\"]";
        findings.refuse(Rule::WrongType, value.span(), message, help);
        return None;
    }
    Some(port::list(value, findings))
}

/// Longest name of a user or group: that of Linux's own tools.
const ACCOUNT_MAX: usize = 32;

fn accounts(
    value: Option<&Spanned<DeValue<'_>>>,
    what: &str,
    findings: &mut Findings,
) -> Vec<Placed<Account>> {
    let Some(value) = value else {
        return Vec::new();
    };
    let form = format!("a list of {what}s, by name or by number");
    let items = doc::array(value, &form, findings);
    let account = |item: &&Spanned<DeValue<'_>>| {
        let value = match item.get_ref() {
            DeValue::Integer(_) => {
                let id = doc::whole(item, 0, u64::from(u32::MAX - 1), findings)?;
                Account::Id(id as u32)
            }
            DeValue::String(text) => {
                let first = |c: char| c.is_alphabetic() || c == '_';
                let rest = |c: char| c.is_alphanumeric() || "._-@$".contains(c);
                if text.len() > ACCOUNT_MAX || !text.starts_with(first) || !text.chars().all(rest) {
                    let message = format!("{text:?} is not the name of a {what}");
                    let help =
                        format!("expected a {what}'s name such as \"robot\", or a number such as 1000");
                    findings.refuse(Rule::BadAccount, item.span(), message, help);
                    return None;
                }
                Account::Name(text.to_string())
            }
            other => {
                let message = format!("a value of type {} found", other.type_str());
                let help = format!("expected a {what}'s name such as \"robot\", or a number such as 1000");
                findings.refuse(Rule::BadAccount, item.span(), message, help);
                return None;
            }
        };
        let at = item.span();
        Some(Placed { value, at })
    };
    items.iter().filter_map(account).collect()
}
