//! A hierarchy drawn as the source draws it: a selector bar for each level, its RMs hanging from it, their
//! stimuli beside them, and motor control units or subroutines at the ends.
//!
//! Must never: evaluate anything. What is lit is what the latest evaluation left behind.

mod layout;

use std::fmt::Write;

use crate::hierarchy::{Control, Hierarchy, LevelIndex, MechanismIndex};
use crate::language::Vocabulary;
use layout::{Box, Layout};

/// Height of a line of writing, pixels.
const LINE: f64 = 13.0;

/// Draws a hierarchy as SVG. RMs active in the latest evaluation are filled, those that listened have a firm
/// edge, and the others a broken one.
#[must_use]
pub fn svg(hierarchy: &Hierarchy, vocabulary: &Vocabulary) -> String {
    let layout = Layout::of(hierarchy, vocabulary);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w:.0} {h:.0}\" width=\"{w:.0}\" height=\"{h:.0}\" \
         font-family=\"sans-serif\" font-size=\"11\">\n<style>.rm{{fill:#fff;stroke:#234}}.on{{fill:#fd6}}\
         .off{{stroke-dasharray:3 3}}.srm{{fill:#dde6f0;stroke:#234}}.end{{fill:#eee;stroke:#888}}\
         .in{{fill:#567;font-size:10px}}line{{stroke:#234}}</style>\n<rect width=\"100%\" height=\"100%\" \
         fill=\"#fff\"/>\n",
        w = layout.width,
        h = layout.height
    );
    for (level, bar) in &layout.bars {
        draw_level(&mut out, hierarchy, *level, bar, &layout);
    }
    for (rm, place) in &layout.boxes {
        draw_rm(&mut out, hierarchy, vocabulary, *rm, place);
    }
    out.push_str("</svg>\n");
    out
}

fn draw_level(out: &mut String, hierarchy: &Hierarchy, level: LevelIndex, bar: &Box, layout: &Layout) {
    let _ = writeln!(
        out,
        "<rect class=\"srm\" x=\"{:.0}\" y=\"{:.0}\" width=\"{:.0}\" height=\"{:.0}\"/>\n<text x=\"{:.0}\" y=\"{:.0}\">SRM \
         of {}</text>",
        bar.x,
        bar.y,
        bar.width,
        bar.height,
        bar.x + 5.0,
        bar.y + LINE,
        escaped(hierarchy.caption(level))
    );
    for rm in hierarchy.members(level) {
        if let Some((_, place)) = layout.boxes.iter().find(|(known, _)| *known == rm) {
            line(out, place.middle(), bar.y + bar.height, place.middle(), place.y);
        }
    }
    let above = layout
        .boxes
        .iter()
        .find(|(rm, _)| hierarchy.mechanisms()[usize::from(rm.0)].control == Control::Branch(level));
    if let Some((_, above)) = above {
        line(
            out,
            above.middle(),
            above.y + above.height,
            above.middle().clamp(bar.x, bar.x + bar.width),
            bar.y,
        );
    }
}

fn draw_rm(
    out: &mut String,
    hierarchy: &Hierarchy,
    vocabulary: &Vocabulary,
    rm: MechanismIndex,
    place: &Box,
) {
    let state = if hierarchy.active(rm) {
        " on"
    } else if hierarchy.listens(rm) {
        ""
    } else {
        " off"
    };
    let _ = writeln!(
        out,
        "<rect class=\"rm{state}\" data-rm=\"{}\" x=\"{:.0}\" y=\"{:.0}\" width=\"{:.0}\" height=\"{:.0}\" rx=\"4\"/>",
        rm.0, place.x, place.y, place.width, place.height
    );
    let lines = lines(hierarchy, vocabulary, rm);
    for (count, text) in lines.iter().enumerate() {
        let class = if count == 0 { "" } else { " class=\"in\"" };
        let y = place.y + LINE * (count as f64 + 1.0);
        let _ = writeln!(
            out,
            "<text{class} x=\"{:.0}\" y=\"{y:.0}\">{}</text>",
            place.x + 5.0,
            escaped(text)
        );
    }
    let end = match hierarchy.mechanisms()[usize::from(rm.0)].control {
        Control::Branch(_) => return,
        Control::Mcu(mcu) => format!("MCU {}", vocabulary.mcu_name(mcu)),
        Control::Subroutine(level) => hierarchy.caption(level).to_owned(),
    };
    let top = place.y + place.height + 14.0;
    line(out, place.middle(), place.y + place.height, place.middle(), top);
    let _ = writeln!(
        out,
        "<rect class=\"end\" x=\"{:.0}\" y=\"{top:.0}\" width=\"{:.0}\" height=\"18\"/>\n<text x=\"{:.0}\" y=\"{:.0}\">{}</text>",
        place.x,
        place.width,
        place.x + 5.0,
        top + LINE,
        escaped(&end)
    );
}

/// What is written into the box of an RM: its name, its inputs with their signs, its threshold and its GSM.
fn lines(hierarchy: &Hierarchy, vocabulary: &Vocabulary, rm: MechanismIndex) -> Vec<String> {
    let mechanism = &hierarchy.mechanisms()[usize::from(rm.0)];
    let mut lines = vec![hierarchy.name(rm).to_owned()];
    for input in hierarchy.inputs(rm) {
        lines.push(format!(
            "{:+} {}",
            input.magnitude,
            vocabulary.stimulus_name(input.stimulus)
        ));
    }
    if mechanism.threshold != 0.0 {
        lines.push(format!("threshold {}", mechanism.threshold));
    }
    if let Some(selection) = mechanism.selection {
        let name = vocabulary
            .criteria()
            .nth(usize::from(selection.criterion.0))
            .unwrap_or_default();
        lines.push(format!("GSM {name}"));
    }
    if let Some(state) = mechanism.goal_state {
        lines.push(format!(
            "until {}",
            vocabulary.states().nth(usize::from(state.0)).unwrap_or_default()
        ));
    }
    lines
}

fn line(out: &mut String, x1: f64, y1: f64, x2: f64, y2: f64) {
    let _ = writeln!(
        out,
        "<line x1=\"{x1:.0}\" y1=\"{y1:.0}\" x2=\"{x2:.0}\" y2=\"{y2:.0}\"/>"
    );
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
