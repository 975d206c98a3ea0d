//! A crowd: a creature of many plain modules in many layers, all in one group, as a daemon runs it.
//!
//! ```text
//!   level 0, l0:  sensor.now ──► m0 ──► m1 ──► m2 …    every module hears the two before it
//!   level 1, l1:                  … ──► m10 ──► m11 …  lower layers never hear higher ones
//! ```
//! They are the rig's modules without its suppressors.
//!
//! Must never leave out what a daemon does besides beating: traces, samples, the watcher, the recorder.

use std::fmt::Write;

use daemon::running::Running;
use ipc::wiring::creature::Creature;
use ipc::wiring::{Source, check};

use crate::{creature, modules, rig};

/// The creature file of `layers` layers of `each` modules at 1 kHz on processor `cpu`.
fn file(cpu: usize, layers: usize, each: usize) -> String {
    let mut text = String::from("creature = \"crowd\"\n");
    let source = |module: usize, back: usize| match module.checked_sub(back) {
        Some(other) => format!("m{other}.out"),
        None => "sensor.now".into(),
    };
    for layer in 0..layers {
        let modules = layer * each..(layer + 1) * each;
        let wires: String = modules
            .clone()
            .map(|m| {
                format!(
                    "  \"{} -> m{m}.a\", \"{} -> m{m}.b\",\n",
                    source(m, 1),
                    source(m, 2)
                )
            })
            .collect();
        let _ = write!(
            text,
            "\n[[layer]]\nname = \"l{layer}\"\nlevel = {layer}\nperiod = \"1ms\"\ncpu = {cpu}\ngroup = \"all\"\n\
             wires = [\n{wires}]\n\n[layer.modules]\n"
        );
        if layer == 0 {
            text.push_str("sensor = { kind = \"lab.sense\" }\n");
        }
        for module in modules {
            let _ = writeln!(text, "m{module} = {{ kind = \"lab.mix\" }}");
        }
    }
    text
}

/// The kinds that a crowd is built with.
fn kinds() -> afsm::Kinds {
    modules::kinds().with([&rig::MIX])
}

/// The creature of `layers` layers, 256 at most, of `each` modules at 1 kHz on processor `cpu`, as checked.
///
/// # Panics
/// When there are more layers than levels.
fn checked(cpu: usize, layers: usize, each: usize) -> Creature {
    let text = file(cpu, layers, each);
    check::creature(&Source::new("crowd (built in)", &text), &kinds()).expect("a crowd is sound")
}

/// Starts a crowd, as a daemon would but for the control socket.
///
/// # Errors
/// When the host refuses shared memory or a thread.
pub fn start(cpu: usize, layers: usize, each: usize) -> Result<Running, String> {
    let mut creature = checked(cpu, layers, each);
    creature.name = format!("crowd{}", std::process::id());
    creature::start(creature, &kinds())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crowd_of_a_hundred_layers_has_a_thousand_modules_and_two_thousand_wires() {
        let crowd = checked(0, 100, 10);
        assert_eq!(crowd.layers.len(), 100);
        let modules: usize = crowd.layers.iter().map(|l| l.modules.len()).sum();
        let wires: usize = crowd.layers.iter().map(|l| l.wires.len()).sum();
        assert_eq!((modules, wires), (1_001, 2_000), "and the sensor");
        assert!(crowd.layers.iter().all(|l| l.group.as_deref() == Some("all")));
    }
}
