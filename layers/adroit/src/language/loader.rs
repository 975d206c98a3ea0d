//! A checked program laid out in the flat arenas of a hierarchy.

use super::checker::{Above, members};
use super::program::{Declared, Program};
use super::vocabulary::Vocabulary;
use crate::hierarchy::{
    Conflicts, Control, Hierarchy, Input, Level, LevelIndex, Mechanism, Parts, Selection,
};

/// One level still to be laid out.
struct Pending<'a> {
    members: Vec<&'a Declared>,
    caption: String,
}

/// Lays out a program that the checker let pass, level by level from the top.
pub(crate) fn lay_out(program: &Program, vocabulary: &Vocabulary) -> Hierarchy {
    let mut pending = vec![Pending {
        members: members(program, &Above::Top).collect(),
        caption: "top".to_owned(),
    }];
    let mut parts = Parts {
        mechanisms: vec![],
        inputs: vec![],
        levels: vec![],
        names: vec![],
        captions: vec![],
    };
    let mut subroutines: Vec<(&str, LevelIndex)> = Vec::new();
    let mut done = 0;
    while done < pending.len() {
        let level = LevelIndex(narrow(done));
        let here = std::mem::take(&mut pending[done].members);
        parts.levels.push(Level {
            first: narrow(parts.mechanisms.len()),
            width: narrow(here.len()),
        });
        parts.captions.push(pending[done].caption.clone());
        for rm in &here {
            let control = if let Some(mcu) = &rm.mcu {
                Control::Mcu(vocabulary.mcu(&mcu.name).expect("checked"))
            } else if let Some(called) = &rm.subroutine {
                let known = subroutines
                    .iter()
                    .find(|(name, _)| *name == called.name)
                    .map(|known| known.1);
                Control::Subroutine(known.unwrap_or_else(|| {
                    let level = LevelIndex(narrow(pending.len()));
                    let members = members(program, &Above::Subroutine(&called.name)).collect();
                    pending.push(Pending {
                        members,
                        caption: format!("subroutine {called}"),
                    });
                    subroutines.push((&called.name, level));
                    level
                }))
            } else {
                let members = members(program, &Above::Rm(&rm.name.name)).collect();
                pending.push(Pending {
                    members,
                    caption: rm.name.name.clone(),
                });
                Control::Branch(LevelIndex(narrow(pending.len() - 1)))
            };
            let mechanism = mechanism(rm, &here, level, control, &mut parts.inputs, vocabulary);
            parts.mechanisms.push(mechanism);
            parts.names.push(rm.name.name.clone());
        }
        done += 1;
    }
    Hierarchy::from_parts(parts)
}

fn mechanism(
    rm: &Declared,
    siblings: &[&Declared],
    level: LevelIndex,
    control: Control,
    inputs: &mut Vec<Input>,
    vocabulary: &Vocabulary,
) -> Mechanism {
    let first_input = u32::try_from(inputs.len()).expect("bounded by the RMs and their inputs");
    inputs.extend(rm.inputs.iter().map(|(stimulus, magnitude)| Input {
        stimulus: vocabulary.stimulus(&stimulus.name).expect("checked"),
        magnitude: *magnitude,
    }));
    let mut conflicts = 0;
    for (place, sibling) in siblings.iter().enumerate() {
        let says =
            |one: &Declared, other: &Declared| one.conflicts.iter().any(|name| name.name == other.name.name);
        if says(rm, sibling) || says(sibling, rm) {
            conflicts |= 1 << place;
        }
    }
    Mechanism {
        first_input,
        inputs: narrow(rm.inputs.len()),
        threshold: rm.threshold,
        selection: rm.selection.as_ref().map(|(criterion, kept)| Selection {
            criterion: vocabulary.criterion(&criterion.name).expect("checked"),
            kept: *kept,
        }),
        goal_state: rm
            .goal_state
            .as_ref()
            .map(|state| vocabulary.state(&state.name).expect("checked")),
        control,
        conflicts: Conflicts(conflicts),
        level,
    }
}

fn narrow(count: usize) -> u16 {
    u16::try_from(count).expect("bounded by MECHANISMS_MAX")
}
