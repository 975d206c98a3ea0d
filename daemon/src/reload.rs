//! Reload: what SIGHUP asks for, and what of it a running creature can have.
//!
//! A creature's threads, wires and registers are made at start, so nothing of its file changes while it runs. The
//! file is read and checked again, and the log says what a restart would change, or why it would fail.
//!
//! Must never end the daemon, nor touch a creature that moves.

use std::collections::BTreeMap;
use std::fmt::Debug;

use ipc::wiring::creature::Creature;

/// What a file that was read again says, line by line, to the operator.
pub fn report(running: &Creature, file: Result<Creature, String>) -> Vec<String> {
    match file {
        Err(errors) => {
            let mut lines: Vec<String> = errors.lines().map(String::from).collect();
            lines.insert(
                0,
                "reload: the creature file is not sound any more; the creature runs on as it was:".into(),
            );
            lines
        }
        Ok(file) => match differences(running, &file)[..] {
            [] => vec!["reload: the creature file is sound, and says what runs".into()],
            ref parts => vec![format!(
                "reload: the creature file is sound; {} changed, which takes a restart; the creature runs on as it was",
                parts.join(", ")
            )],
        },
    }
}

/// The parts in which `file` differs from what runs, by the names of the file.
fn differences(running: &Creature, file: &Creature) -> Vec<String> {
    let (before, after) = (parts(running), parts(file));
    let names = before
        .keys()
        .chain(after.keys().filter(|name| !before.contains_key(*name)));
    let changed = names.filter(|name| before.get(*name) != after.get(*name));
    changed.cloned().collect()
}

/// Every part of a creature by its name, as text that is equal when the part is.
fn parts(creature: &Creature) -> BTreeMap<String, String> {
    fn part(name: &str, value: &dyn Debug) -> (String, String) {
        (name.into(), format!("{value:?}"))
    }
    let layers = creature.layers.iter();
    let layers = layers.map(|layer| part(&format!("layer {:?}", layer.name), layer));
    let others = [
        part("the name", &creature.name),
        part("the seed", &creature.seed),
        part("[body]", &creature.body),
        part("[halt]", &creature.halt),
        part("[outsiders]", &creature.outsiders),
        part("[executor]", &creature.executor),
    ];
    layers.chain(others).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::kinds;
    use ipc::wiring::{Source, check};

    fn creature(text: &str) -> Result<Creature, String> {
        check::creature(&Source::new("allen.toml", text), &kinds()).map_err(|e| e.to_string())
    }

    #[test]
    fn says_what_changed_and_nothing_else() {
        let running = creature(allen::CREATURE).expect("it is sound");
        let same = report(&running, creature(allen::CREATURE));
        assert_eq!(same, ["reload: the creature file is sound, and says what runs"]);
        let mut other = running.clone();
        other.seed += 1;
        other.layers[0].period.0 *= 2;
        let layer = format!("layer {:?}", running.layers[0].name);
        assert_eq!(differences(&running, &other), [layer, "the seed".into()]);
        other = running.clone();
        other.layers.clear();
        assert_eq!(differences(&running, &other).len(), running.layers.len());
    }

    #[test]
    fn a_broken_file_is_reported_with_every_error() {
        let running = creature(allen::CREATURE).expect("it is sound");
        let said = report(&running, creature("creature = \"x\"\n[[layer]]\nname = \n"));
        assert!(said[0].contains("runs on as it was"), "{said:?}");
        assert!(said.iter().any(|line| line.contains("allen.toml:3:")), "{said:?}");
    }
}
