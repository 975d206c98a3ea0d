//! Every stock module at once, fed with the worst numbers there are: nothing but messages comes out, and no beat
//! allocates.

use std::fmt::Write as _;

use afsm::assemble::assemble;
use daemon::alloc;
use daemon::machine::Net;
use ipc::clock::{Span, Time};
use ipc::message::{KINDS, Kind};
use ipc::wire::{Page, Reader};
use ipc::wiring::catalog::{Declaration, Takes};
use ipc::wiring::directory::output_ports;
use ipc::wiring::{Source, check};

#[global_allocator]
static ALLOCATOR: alloc::Counting = alloc::Counting;

/// Numbers at the ends of what a wire may carry, and ordinary ones between them.
const WORST: &str =
    "[0.0, 1.0, 1.7e308, -1.7e308, -0.0, 5e-324, 1.7e308, 1.7e308, -2.5, 1e300, 3.0, -1.7e308, 0.0]";

/// Inputs of one kind on one module: each has a source with a period of its own.
const INPUTS_MAX: usize = 3;

fn source(kind: Kind, index: usize) -> String {
    format!("from-{kind}-{index}")
}

/// A creature with every stock kind, each input on a source, each reset line on one that seldom rings.
fn everything() -> String {
    let mut wires = String::new();
    let mut modules = String::from("bell = { kind = \"source.pulse\", every = \"97ms\" }\n");
    for kind in KINDS {
        for index in 0..INPUTS_MAX {
            let name = source(kind, index);
            let plain = if kind == Kind::Number {
                String::new()
            } else {
                format!(".{kind}")
            };
            let values = match kind {
                Kind::Pulse => String::new(),
                Kind::Bit => ", values = [1, 0, 0, 1, 1]".into(),
                _ => format!(", values = {WORST}"),
            };
            let every = [1, 2, 5][index];
            let _ = writeln!(
                modules,
                "{name} = {{ kind = \"source{plain}\", every = \"{every}ms\"{values} }}"
            );
        }
    }
    for kind in stock::modules() {
        let d = kind.declaration;
        let name = format!("the-{}", d.name.replace('.', "-"));
        let _ = write!(modules, "{name} = {{ kind = \"{}\"", d.name);
        for parameter in d.parameters {
            if let Some(value) = given(d, parameter.name, &parameter.takes) {
                let _ = write!(modules, ", {} = {value}", parameter.name);
            }
        }
        modules.push_str(" }\n");
        for (index, port) in d.inputs.iter().enumerate() {
            let _ = writeln!(
                wires,
                "  \"{}.out -> {name}.{}\",",
                source(port.kind, index),
                port.name
            );
        }
        let _ = writeln!(wires, "  \"bell.out -> {name}.reset\",");
    }
    format!(
        "creature = \"everything\"\n[[layer]]\nname = \"all\"\nlevel = 0\nperiod = \"1ms\"\n\
         wires = [\n{wires}]\n[layer.modules]\n{modules}"
    )
}

/// What to give for a parameter: what must be given, and what makes every output speak.
fn given(d: &Declaration, name: &str, takes: &Takes) -> Option<String> {
    match (d.name, name) {
        ("counter", "high") => return Some("3".into()),
        ("timer" | "monoflop", "length") => return Some("\"1ms\"".into()),
        (_, "every") => return Some("\"7ms\"".into()),
        _ => {}
    }
    match takes {
        Takes::Number {
            default: None,
            low,
            high,
        } => Some(format!("{:?}", 1.0_f64.clamp(*low, *high))),
        Takes::Span { default: None } => Some("\"3ms\"".into()),
        Takes::Bit { default: None } => Some("true".into()),
        Takes::Word { default: None, words } => Some(format!("{:?}", words[0])),
        Takes::Numbers { default: None, .. } => Some("[1.7e308, -1.7e308]".into()),
        _ => None,
    }
}

#[test]
fn whatever_comes_in_only_messages_come_out_and_no_beat_allocates() {
    let text = everything();
    let kinds = stock::kinds();
    let creature = check::creature(&Source::new("everything.toml", text), &kinds);
    let creature = creature.unwrap_or_else(|rejected| panic!("{rejected}"));
    let outputs: Vec<(String, Kind)> = output_ports(&creature)
        .map(|(name, port, _)| (name.to_string(), port.kind))
        .collect();
    let page = Page::in_memory(outputs.len());
    let net = Net::new(&creature, &page);
    let layer = &creature.layers[0];
    let (mut running, _hand) = assemble(layer, &kinds, &page, 0, &net, &[], creature.seed);
    let readers: Vec<Reader> = (0..outputs.len())
        .map(|i| page.reader(i, outputs[i].1).expect("a wire"))
        .collect();
    let mut unsound = Vec::with_capacity(outputs.len());
    alloc::seal();
    for beat in 0..5_000 {
        let now = Time(1_000_000_000) + Span::millis(beat);
        running.step(now);
        running.commit(now);
        for (index, reader) in readers.iter().enumerate() {
            let sound = reader
                .read()
                .is_none_or(|reading| reader.kind().accepts(&reading.words, f64::MIN, f64::MAX));
            if !sound && unsound.len() < unsound.capacity() {
                unsound.push(index);
            }
        }
    }
    alloc::unseal();
    let unsound: Vec<&str> = unsound.into_iter().map(|i| outputs[i].0.as_str()).collect();
    assert!(unsound.is_empty(), "no messages: {unsound:?}");
    assert_eq!(alloc::broken(), 0, "a beat allocated");
    let silent: Vec<&str> = (0..outputs.len())
        .filter(|i| readers[*i].read().is_none())
        .map(|i| outputs[i].0.as_str())
        .collect();
    assert!(silent.is_empty(), "never said anything: {silent:?}");
}
