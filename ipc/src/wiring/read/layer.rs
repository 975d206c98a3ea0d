//! A layer as it is written: its schedule, its modules, its wires and taps.
//!
//! Must never drop a part for an error in it that leaves its name readable: others refer to that name.

use toml::Spanned;
use toml::de::DeValue;

use super::taking::Taking;
use super::{RawLayer, RawModule, RawTap, port};
use crate::wiring::creature::{How, Overrun};
use crate::wiring::diagnostic::Findings;
use crate::wiring::document::{self as doc, Placed};
use crate::wiring::grammar::{self, Grammar};

const OVERRUNS: [Overrun; 3] = [Overrun::Skip, Overrun::CatchUp, Overrun::Halt];

pub(super) fn layer<'t, 's>(
    value: &'t Spanned<DeValue<'s>>,
    findings: &mut Findings,
) -> Option<RawLayer<'t, 's>> {
    let Some(mut table) = Taking::table(value, &grammar::LAYER, findings) else {
        findings.lose_lines();
        return None;
    };
    let mut layer = RawLayer {
        at: value.span(),
        name: table.name("name"),
        level: table.whole("level").map(|l| l.value as u8),
        period: table.time("period").map(|p| p.value),
        phase: table.time("phase"),
        priority: table.whole("priority").map(|p| Placed {
            value: p.value as u8,
            at: p.at,
        }),
        cpu: table.whole("cpu").map(|c| Placed {
            value: c.value as usize,
            at: c.at,
        }),
        overrun: table.word("overrun").map_or(Overrun::Skip, |w| OVERRUNS[w.value]),
        vital: table.bit("vital"),
        group: table.name("group"),
        spins: table.word("wake").is_some_and(|w| w.value == 1),
        spin: table.time("spin"),
        modules: Vec::new(),
        wires: Vec::new(),
        taps: Vec::new(),
    };
    if let Some(named) = table.raw("modules") {
        layer.modules = modules(named, table.findings);
    }
    if let Some(list) = table.raw("wires") {
        let form = "a list of wires such as [\"sonar.map -> collide.map\"]";
        for item in doc::array(list, form, table.findings) {
            layer.wires.extend(port::wire(item, table.findings));
        }
    }
    let suppressors = table.raw("suppress");
    taps(suppressors, How::Suppress, &mut layer.taps, table.findings);
    let inhibitors = table.raw("inhibit");
    taps(inhibitors, How::Inhibit, &mut layer.taps, table.findings);
    table.finish();
    Some(layer)
}

fn modules<'t, 's>(value: &'t Spanned<DeValue<'s>>, findings: &mut Findings) -> Vec<RawModule<'t, 's>> {
    let DeValue::Table(table) = value.get_ref() else {
        let _ = doc::table(
            value,
            "the layer's modules by name, such as sonar = { kind = \"...\" }",
            findings,
        );
        findings.lose_lines();
        return Vec::new();
    };
    let mut modules = Vec::new();
    for (key, value) in table {
        let name = Placed {
            value: key.get_ref().to_string(),
            at: key.span(),
        };
        port::check_name(&name, findings);
        let kind = doc::table(value, format!("module {:?}", name.value), findings).and_then(|keys| {
            let mut module = Taking::new(keys, &grammar::MODULE, findings);
            let kind = module.text("kind", "the name of a kind of module");
            let rest = module.rest();
            kind.map(|kind| (kind, rest))
        });
        modules.push(RawModule { name, kind });
    }
    modules
}

fn taps(list: Option<&Spanned<DeValue<'_>>>, how: How, into: &mut Vec<RawTap>, findings: &mut Findings) {
    let Some(list) = list else { return };
    let (grammar, port): (&'static Grammar, &str) = match how {
        How::Suppress => (&grammar::SUPPRESS, "input"),
        How::Inhibit => (&grammar::INHIBIT, "output"),
    };
    let form =
        format!("a list of taps such as [{{ from = \"...\", {port} = \"...\", time_constant = \"1s\" }}]");
    for item in doc::array(list, &form, findings) {
        let Some(mut table) = Taking::table(item, grammar, findings) else {
            findings.lose_wire();
            continue;
        };
        into.push(RawTap {
            how,
            from: table.port("from"),
            to: table.port(port),
            time_constant: table.time("time_constant"),
        });
        table.finish();
    }
}
