//! The same content as Graphviz text, for those who lay out with `dot`.
//!
//! Must never leave out what the SVG shows: layers, ports, taps with their time constants, faults.

use std::fmt::Write as _;

use ipc::wiring::creature::How;

use crate::compact::constant;
use crate::model::{Model, Port, Role};

/// Writes a model as a Graphviz digraph.
pub fn dot(model: &Model) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "digraph {} {{", quote(&model.name));
    out.push_str(
        "  rankdir=LR;\n  node [fontname=\"sans-serif\" shape=box];\n  edge [fontname=\"sans-serif\"];\n",
    );
    for (k, band) in model.bands.iter().enumerate().rev() {
        let process = band.process.iter().map(|p| format!(" ({p})"));
        let label = format!(
            "level {} {}{}",
            band.level,
            band.name,
            process.collect::<String>()
        );
        let _ = writeln!(out, "  subgraph cluster_{k} {{\n    label={};", quote(&label));
        for (node, n) in model.nodes.iter().enumerate() {
            if n.role == Role::Module(k) {
                let _ = writeln!(
                    out,
                    "    n{node} [label={} tooltip={}{}];",
                    quote(&n.name),
                    quote(n.fault.as_ref().unwrap_or(&n.kind)),
                    red(n.fault.is_some())
                );
            }
        }
        out.push_str("  }\n");
    }
    for (node, n) in model.nodes.iter().enumerate() {
        if n.band().is_none() {
            let _ = writeln!(out, "  n{node} [label={} shape=oval];", quote(&n.name));
        }
        for (port, p) in n.inputs.iter().enumerate() {
            chain(&mut out, model, p, &format!("s{node}_{port}_"), None);
            if !p.taps.is_empty() {
                let last = p.taps.len() - 1;
                let to = quote(&p.name);
                let _ = writeln!(out, "  s{node}_{port}_{last} -> n{node} [headlabel={to}];");
            }
        }
        for (port, p) in n.outputs.iter().enumerate() {
            chain(&mut out, model, p, &format!("i{node}_{port}_"), Some(node));
        }
    }
    for net in &model.nets {
        let (node, port) = net.from;
        let output = &model.nodes[node].outputs[port];
        let from = match output.taps.len() {
            0 => format!("n{node}"),
            taps => format!("i{node}_{port}_{}", taps - 1),
        };
        for (k, end) in net.ends.iter().enumerate() {
            let ports = match end.tap.map(|t| t.how) {
                Some(How::Inhibit) => &model.nodes[end.node].outputs,
                _ => &model.nodes[end.node].inputs,
            };
            let p = &ports[end.port];
            let me = model.nets.iter().position(|n| std::ptr::eq(n, net)).unwrap_or(0);
            let place = p.taps.iter().position(|t| *t == (me, k));
            let to = match (end.tap.map(|t| t.how), place) {
                (Some(How::Inhibit), Some(i)) => format!("i{}_{}_{i}", end.node, end.port),
                (Some(How::Suppress), Some(i)) => format!("s{}_{}_{i}", end.node, end.port),
                _ if !p.taps.is_empty() => format!("s{}_{}_0", end.node, end.port),
                _ => format!("n{}", end.node),
            };
            let into = if end.tap.is_none() && p.taps.is_empty() {
                format!(" headlabel={}", quote(&p.name))
            } else {
                String::new()
            };
            let tip = end.fault.clone().unwrap_or(format!("{} to {}", net.name, end.to));
            let _ = writeln!(
                out,
                "  {from} -> {to} [taillabel={}{into} tooltip={}{}];",
                quote(&output.name),
                quote(&tip),
                red(end.fault.is_some())
            );
        }
    }
    for fault in &model.faults {
        let _ = writeln!(out, "  // {}", fault.replace('\n', "; "));
    }
    out.push_str("}\n");
    out
}

/// The circles of a port's taps, in series; those of an output begin at its module.
fn chain(out: &mut String, model: &Model, port: &Port, prefix: &str, from: Option<usize>) {
    for (k, &(net, end)) in port.taps.iter().enumerate() {
        let e = &model.nets[net].ends[end];
        let letter = if from.is_some() { "I" } else { "S" };
        let label = format!("{letter}\\n{}", constant(model, (net, end)));
        let _ = writeln!(
            out,
            "  {prefix}{k} [shape=circle label=\"{label}\"{}];",
            red(e.fault.is_some())
        );
        match (k, from) {
            (0, Some(node)) => {
                let _ = writeln!(out, "  n{node} -> {prefix}0;");
            }
            (0, None) => {}
            _ => {
                let _ = writeln!(out, "  {prefix}{} -> {prefix}{k};", k - 1);
            }
        }
    }
}

fn red(fault: bool) -> &'static str {
    if fault { " color=red fontcolor=red" } else { "" }
}

fn quote(text: &str) -> String {
    let sound: String = text
        .chars()
        .map(|c| if c.is_control() && c != '\n' { ' ' } else { c })
        .collect();
    format!(
        "\"{}\"",
        sound
            .replace('\\', "\\\\")
            .replace('"', "\\\"")
            .replace('\n', "\\n")
    )
}
