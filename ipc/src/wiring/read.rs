//! From the document to the parts of a creature, each with its place; names are not resolved yet.
//!
//! Must never compare two parts with each other: that is the checker's work.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::creature::{How, Overrun, PortName};
use super::diagnostic::Findings;
use super::document::{self as doc, Keys, Placed};
use crate::clock::Span;

/// The parts of a file.
#[derive(Default)]
pub(super) struct Parts<'t, 's> {
    pub(super) name: Option<Placed<String>>,
    pub(super) seed: u64,
    pub(super) body: Option<RawBody<'t, 's>>,
    pub(super) layers: Vec<RawLayer<'t, 's>>,
    pub(super) reflexes: Vec<Placed<PortName>>,
    pub(super) hold: Option<Span>,
    pub(super) stale: Option<Span>,
    pub(super) watchdog_device: Option<Placed<String>>,
    pub(super) open_taps: Vec<Placed<PortName>>,
    pub(super) layers_max: Option<u64>,
    pub(super) level_max: Option<u64>,
    pub(super) time_constant_max: Option<Span>,
}

pub(super) struct RawBody<'t, 's> {
    pub(super) kind: Placed<String>,
    pub(super) period: Span,
    pub(super) settings: Keys<'t, 's>,
}

pub(super) struct RawLayer<'t, 's> {
    pub(super) name: Placed<String>,
    pub(super) level: u8,
    pub(super) period: Span,
    pub(super) phase: Placed<Span>,
    pub(super) priority: Option<u8>,
    pub(super) cpu: Option<usize>,
    pub(super) overrun: Overrun,
    pub(super) vital: bool,
    pub(super) modules: Vec<RawModule<'t, 's>>,
    pub(super) wires: Vec<(Placed<PortName>, Placed<PortName>)>,
    pub(super) taps: Vec<RawTap>,
}

pub(super) struct RawModule<'t, 's> {
    pub(super) name: Placed<String>,
    pub(super) kind: Placed<String>,
    pub(super) settings: Keys<'t, 's>,
}

pub(super) struct RawTap {
    pub(super) how: How,
    pub(super) from: Placed<PortName>,
    pub(super) to: Placed<PortName>,
    pub(super) time_constant: Span,
}

pub(super) fn read<'t, 's>(root: &'t Spanned<DeTable<'s>>, findings: &mut Findings) -> Parts<'t, 's> {
    let mut parts = Parts::default();
    let mut keys = Keys::new(root.get_ref(), 0..0, "the creature file");
    parts.name = keys
        .take("creature")
        .and_then(|v| name(v, "a name for the creature", findings));
    if let Some(seed) = keys.take("seed") {
        parts.seed = doc::whole(seed, 0, i64::MAX as u64, findings).unwrap_or(0);
    }
    parts.body = keys.take("body").and_then(|v| body(v, findings));
    if let Some(layers) = keys.take("layer") {
        for value in doc::array(layers, "layers, each as a [[layer]] table", findings) {
            parts.layers.extend(layer(value, findings));
        }
    }
    if let Some(halt) = keys.take("halt").and_then(|v| doc::table(v, "[halt]", findings)) {
        read_halt(halt, &mut parts, findings);
    }
    if let Some(outside) = keys
        .take("outsiders")
        .and_then(|v| doc::table(v, "[outsiders]", findings))
    {
        read_outsiders(outside, &mut parts, findings);
    }
    keys.finish(findings);
    parts
}

fn read_halt(mut keys: Keys<'_, '_>, parts: &mut Parts<'_, '_>, findings: &mut Findings) {
    if let Some(list) = keys.take("reflex") {
        parts.reflexes = ports(list, findings);
    }
    parts.hold = keys.take("hold").and_then(|v| doc::span(v, true, findings));
    parts.stale = keys.take("stale").and_then(|v| doc::span(v, true, findings));
    parts.watchdog_device = keys
        .take("watchdog_device")
        .and_then(|v| doc::text(v, "the path of a watchdog device such as \"/dev/watchdog\"", findings));
    keys.finish(findings);
}

fn read_outsiders(mut keys: Keys<'_, '_>, parts: &mut Parts<'_, '_>, findings: &mut Findings) {
    if let Some(list) = keys.take("tap") {
        parts.open_taps = ports(list, findings);
    }
    parts.layers_max = keys
        .take("layers_max")
        .and_then(|v| doc::whole(v, 0, 32, findings));
    parts.level_max = keys
        .take("level_max")
        .and_then(|v| doc::whole(v, 0, 255, findings));
    parts.time_constant_max = keys
        .take("time_constant_max")
        .and_then(|v| doc::span(v, true, findings));
    keys.finish(findings);
}

fn body<'t, 's>(value: &'t Spanned<DeValue<'s>>, findings: &mut Findings) -> Option<RawBody<'t, 's>> {
    let mut keys = doc::table(value, "[body]", findings)?;
    let kind = keys
        .need("kind", findings)
        .and_then(|v| doc::text(v, "the name of a kind of body", findings));
    let period = keys
        .take("period")
        .and_then(|v| doc::span(v, true, findings))
        .unwrap_or(Span::millis(20));
    Some(RawBody {
        kind: kind?,
        period,
        settings: keys,
    })
}

fn layer<'t, 's>(value: &'t Spanned<DeValue<'s>>, findings: &mut Findings) -> Option<RawLayer<'t, 's>> {
    let mut keys = doc::table(value, "this [[layer]]", findings)?;
    let name = keys
        .need("name", findings)
        .and_then(|v| name(v, "a name for the layer", findings));
    let level = keys
        .need("level", findings)
        .and_then(|v| doc::whole(v, 0, 255, findings))
        .unwrap_or(0) as u8;
    let period = keys
        .need("period", findings)
        .and_then(|v| doc::span(v, true, findings));
    let phase = keys.take("phase").and_then(|v| {
        Some(Placed {
            value: doc::span(v, false, findings)?,
            at: v.span(),
        })
    });
    let priority = keys
        .take("priority")
        .and_then(|v| doc::whole(v, 1, PRIORITY_MAX, findings))
        .map(|p| p as u8);
    let cpu = keys
        .take("cpu")
        .and_then(|v| doc::whole(v, 0, 1023, findings))
        .map(|c| c as usize);
    let policies = [Overrun::Skip, Overrun::CatchUp, Overrun::Halt];
    let overrun = keys
        .take("overrun")
        .and_then(|v| doc::word(v, "overrun policy", &["skip", "catch-up", "halt"], findings))
        .map_or(Overrun::Skip, |i| policies[i]);
    let vital = keys
        .take("vital")
        .and_then(|v| doc::bit(v, findings))
        .unwrap_or(false);
    let mut modules = Vec::new();
    if let Some(table) = keys.take("modules") {
        modules = read_modules(table, findings);
    }
    let mut wires = Vec::new();
    if let Some(list) = keys.take("wires") {
        for item in doc::array(list, "wires such as \"sonar.map -> collide.map\"", findings) {
            wires.extend(wire(item, findings));
        }
    }
    let mut taps = Vec::new();
    for (key, how, port) in [
        ("suppress", How::Suppress, "input"),
        ("inhibit", How::Inhibit, "output"),
    ] {
        let Some(list) = keys.take(key) else { continue };
        for item in doc::array(
            list,
            "taps such as { from = \"...\", input = \"...\", time_constant = \"1s\" }",
            findings,
        ) {
            taps.extend(tap(item, how, port, findings));
        }
    }
    let phase = phase.unwrap_or(Placed {
        value: Span::ZERO,
        at: keys.at(),
    });
    keys.finish(findings);
    Some(RawLayer {
        name: name?,
        level,
        period: period?,
        phase,
        priority,
        cpu,
        overrun,
        vital,
        modules,
        wires,
        taps,
    })
}

fn read_modules<'t, 's>(value: &'t Spanned<DeValue<'s>>, findings: &mut Findings) -> Vec<RawModule<'t, 's>> {
    let DeValue::Table(table) = value.get_ref() else {
        let _ = doc::table(value, "the layer's modules", findings);
        return Vec::new();
    };
    let mut modules = Vec::new();
    for (key, value) in table {
        let name = Placed {
            value: key.get_ref().to_string(),
            at: key.span(),
        };
        check_name(&name, findings);
        let Some(mut keys) = doc::table(value, format!("module {:?}", name.value), findings) else {
            continue;
        };
        let kind = keys.need("kind", findings);
        let Some(kind) = kind.and_then(|v| doc::text(v, "the name of a kind of module", findings)) else {
            continue;
        };
        modules.push(RawModule {
            name,
            kind,
            settings: keys,
        });
    }
    modules
}

/// `"a.b -> c.d, e.f"` as one pair for each reader.
fn wire(value: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Vec<(Placed<PortName>, Placed<PortName>)> {
    const FORM: &str = "expected \"module.output -> module.input\", with commas between several inputs";
    let Some(given) = doc::text(value, "a wire such as \"sonar.map -> collide.map\"", findings) else {
        return Vec::new();
    };
    let Some((from, to)) = given.value.split_once("->") else {
        findings.error(given.at, "a wire without an arrow", FORM);
        return Vec::new();
    };
    let Some(from) = port_in(from, &given, FORM, findings) else {
        return Vec::new();
    };
    to.split(',')
        .filter_map(|to| Some((from.clone(), port_in(to, &given, FORM, findings)?)))
        .collect()
}

fn tap(
    value: &Spanned<DeValue<'_>>,
    how: How,
    port: &'static str,
    findings: &mut Findings,
) -> Option<RawTap> {
    let mut keys = doc::table(value, "this tap", findings)?;
    let from = keys.need("from", findings).and_then(|v| port_value(v, findings));
    let to = keys.need(port, findings).and_then(|v| port_value(v, findings));
    let time_constant = keys
        .need("time_constant", findings)
        .and_then(|v| doc::span(v, true, findings));
    keys.finish(findings);
    Some(RawTap {
        how,
        from: from?,
        to: to?,
        time_constant: time_constant?,
    })
}

fn ports(list: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Vec<Placed<PortName>> {
    let items = doc::array(list, "ports such as [\"turn.heading\"]", findings);
    items
        .into_iter()
        .filter_map(|v| port_value(v, findings))
        .collect()
}

fn port_value(value: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Option<Placed<PortName>> {
    let given = doc::text(value, "a port such as \"turn.heading\"", findings)?;
    port_in(&given.value, &given, "expected \"module.port\"", findings)
}

/// The port named by `part` of the text `whole`, at the part's own place if the text stands literally there.
fn port_in(
    part: &str,
    whole: &Placed<String>,
    form: &str,
    findings: &mut Findings,
) -> Option<Placed<PortName>> {
    let start = part.as_ptr() as usize - whole.value.as_ptr() as usize;
    let lead = part.len() - part.trim_start().len();
    let part = part.trim();
    // One byte for the opening quote; with escapes in the text the place of the whole has to do.
    let literal = whole.at.len() == whole.value.len() + 2;
    let from = whole.at.start + 1 + start + lead;
    let at = if literal && !part.is_empty() {
        from..from + part.len()
    } else {
        whole.at.clone()
    };
    let sound = |s: &str| !s.is_empty() && s.chars().all(is_name_char);
    match part.split_once('.') {
        Some((module, port)) if sound(module) && sound(port) => Some(Placed {
            value: PortName {
                module: module.into(),
                port: port.into(),
            },
            at,
        }),
        _ => {
            findings.error(at, format!("{part:?} is not a port"), form);
            None
        }
    }
}

fn is_name_char(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_' || c == '-'
}

fn name(value: &Spanned<DeValue<'_>>, expected: &str, findings: &mut Findings) -> Option<Placed<String>> {
    let given = doc::text(value, expected, findings)?;
    check_name(&given, findings);
    Some(given)
}

/// Highest priority of a layer: above it come the daemon's watchdog at 98, and the kernel's own threads at 99.
const PRIORITY_MAX: u64 = 97;

/// Longest name: it becomes part of a shared-memory service name, which has 255 characters.
pub(super) const NAME_MAX: usize = 48;

fn check_name(name: &Placed<String>, findings: &mut Findings) {
    let sound =
        !name.value.is_empty() && name.value.len() <= NAME_MAX && name.value.chars().all(is_name_char);
    if !sound {
        let help = format!("expected 1 to {NAME_MAX} letters, digits, '-' or '_'");
        findings.error(name.at.clone(), format!("{:?} is not a name", name.value), help);
    }
}
