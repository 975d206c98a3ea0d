//! Names, ports and wires as they are written.
//!
//! Must never ask whether what is named is there.

use toml::Spanned;
use toml::de::DeValue;

use crate::wiring::creature::PortName;
use crate::wiring::diagnostic::Findings;
use crate::wiring::document::{self as doc, Placed};
use crate::wiring::rule::Rule;

/// Longest name: it becomes part of a shared-memory service name, which has 255 characters.
pub(crate) const NAME_MAX: usize = 48;

const WIRE: &str = "expected \"module.output -> module.input\", with commas between several inputs";

fn is_name_char(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_' || c == '-'
}

/// Whether a text can be a name.
pub(crate) fn is_name(text: &str) -> bool {
    !text.is_empty() && text.len() <= NAME_MAX && text.chars().all(is_name_char)
}

/// A name.
pub(super) fn name(
    value: &Spanned<DeValue<'_>>,
    expected: &str,
    findings: &mut Findings,
) -> Option<Placed<String>> {
    let given = doc::text(value, expected, findings)?;
    check_name(&given, findings);
    Some(given)
}

pub(super) fn check_name(name: &Placed<String>, findings: &mut Findings) {
    if !is_name(&name.value) {
        let help = format!("expected 1 to {NAME_MAX} letters (a to z), digits, '-' or '_'");
        let message = format!("{:?} is not a name", name.value);
        findings.refuse(Rule::BadName, name.at.clone(), message, help);
    }
}

/// `"a.b -> c.d, e.f"` as one pair for each reader.
pub(super) fn wire(
    value: &Spanned<DeValue<'_>>,
    findings: &mut Findings,
) -> Vec<(Placed<PortName>, Placed<PortName>)> {
    let Some(given) = doc::text(value, "a wire such as \"sonar.map -> collide.map\"", findings) else {
        findings.lose_wire();
        return Vec::new();
    };
    let Some((from, to)) = given.value.split_once("->") else {
        let message = format!("{:?} has no arrow", given.value);
        findings.refuse(Rule::BadWire, given.at, message, WIRE);
        findings.lose_wire();
        return Vec::new();
    };
    if to.contains("->") {
        let message = format!("{:?} has two arrows", given.value);
        let help = "expected one arrow: write a wire of its own for each output";
        findings.refuse(Rule::BadWire, given.at, message, help);
        findings.lose_wire();
        return Vec::new();
    }
    let from = part(from, &given, WIRE, findings);
    let to: Vec<_> = to.split(',').map(|to| part(to, &given, WIRE, findings)).collect();
    let Some(from) = from else { return Vec::new() };
    to.into_iter().flatten().map(|to| (from.clone(), to)).collect()
}

/// A list of ports.
pub(super) fn list(list: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Vec<Placed<PortName>> {
    let items = doc::array(list, "ports such as [\"turn.heading\"]", findings);
    items
        .into_iter()
        .filter_map(|v| self::value(v, findings))
        .collect()
}

/// A port.
pub(super) fn value(value: &Spanned<DeValue<'_>>, findings: &mut Findings) -> Option<Placed<PortName>> {
    let given = doc::text(value, "a port such as \"turn.heading\"", findings)?;
    part(&given.value, &given, "expected \"module.port\"", findings)
}

/// The port named by `part` of the text `whole`, at the part's own place if the text stands literally there.
fn part(part: &str, whole: &Placed<String>, form: &str, findings: &mut Findings) -> Option<Placed<PortName>> {
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
    match part.split_once('.') {
        Some((module, port)) if is_name(module) && is_name(port) => Some(Placed {
            value: PortName {
                module: module.into(),
                port: port.into(),
            },
            at,
        }),
        _ => {
            let message = if part.is_empty() {
                "a port is missing".into()
            } else {
                format!("{part:?} is not a port")
            };
            findings.refuse(Rule::BadPort, at, message, form);
            findings.lose_wire();
            None
        }
    }
}
