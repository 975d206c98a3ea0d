//! An example of a kind's use: a whole creature file, made from its declaration.
//!
//! Must never be wrong: the tests put the example of every kind through the checker.

use std::fmt::Write as _;

use ipc::message::Kind;
use ipc::wiring::catalog::{Declaration, Takes};

/// A creature file in which a module of kind `d` hears a source on every input.
pub(crate) fn of(d: &Declaration) -> String {
    let module = d.name.replace('.', "-");
    let mut text =
        String::from("creature = \"example\"\n\n[[layer]]\nname = \"trial\"\nlevel = 0\nperiod = \"10ms\"\n");
    if !d.inputs.is_empty() {
        text.push_str("wires = [\n");
        for port in d.inputs {
            let source = source_name(port.name, &module);
            let _ = writeln!(text, "  \"{source}.out -> {module}.{}\",", port.name);
        }
        text.push_str("]\n");
    }
    let outputs: Vec<String> = d
        .outputs
        .iter()
        .map(|p| format!("{module}.{} ({})", p.name, p.kind))
        .collect();
    let _ = writeln!(text, "# further wires may begin at {}", outputs.join(", "));
    text.push_str("\n[layer.modules]\n");
    for port in d.inputs {
        let source = source_name(port.name, &module);
        let _ = writeln!(
            text,
            "{source} = {{ kind = \"{}\", every = \"1s\" }}",
            source_kind(port.kind)
        );
    }
    let _ = write!(text, "{module} = {{ kind = \"{}\"", d.name);
    for parameter in d.parameters {
        if let Some(value) = sample(&parameter.takes) {
            let _ = write!(text, ", {} = {value}", parameter.name);
        }
    }
    text.push_str(" }\n");
    text
}

/// A name for the source that feeds `port`.
fn source_name(port: &str, module: &str) -> String {
    if port == module {
        format!("a-{port}")
    } else {
        port.into()
    }
}

/// The stock source of messages of `kind`.
fn source_kind(kind: Kind) -> String {
    match kind {
        Kind::Number => "source".into(),
        other => format!("source.{other}"),
    }
}

/// A value that a parameter takes: its default, or one that shows its form; none for a file, which would have to
/// be there.
fn sample(takes: &Takes) -> Option<String> {
    let value = match takes {
        Takes::Number { low, high, default } => {
            format!("{:?}", default.unwrap_or(1.0_f64.clamp(*low, *high)))
        }
        Takes::Span { default } => match default.filter(|d| d.0 > 0) {
            Some(span) => format!("\"{span}\""),
            None => "\"1s\"".into(),
        },
        Takes::Bit { default } => default.unwrap_or(true).to_string(),
        Takes::Word { words, default } => format!("{:?}", default.unwrap_or(words[0])),
        Takes::Numbers {
            low,
            high,
            most,
            default,
        } => match default {
            Some(numbers) => format!("{numbers:?}"),
            None => format!("{:?}", vec![1.0_f64.clamp(*low, *high); *most]),
        },
        Takes::Spans { default, .. } => match default {
            Some([_, ..]) => {
                let spans = default.unwrap_or_default();
                format!("{:?}", spans.iter().map(ToString::to_string).collect::<Vec<_>>())
            }
            _ => "[\"10ms\", \"20ms\"]".into(),
        },
        Takes::File { .. } => return None,
    };
    Some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use daemon::machine::kinds;
    use ipc::wiring::{Catalog, Source, check};

    #[test]
    fn the_example_of_every_kind_is_sound() {
        for d in kinds().modules() {
            let text = of(d);
            let creature = check::creature(&Source::new(d.name, text.clone()), &kinds());
            let creature = creature.unwrap_or_else(|rejected| panic!("{rejected}\n{text}"));
            let modules = &creature.layers[0].modules;
            assert!(modules.iter().any(|m| m.declaration.name == d.name), "{text}");
            assert_eq!(creature.layers[0].wires.len(), d.inputs.len(), "{text}");
        }
    }
}
