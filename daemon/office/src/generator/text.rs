//! A generated plan in the form that `layout_text` reads, centimetres kept.

use super::plan::Plan;
use crate::layout::Surface;
use std::fmt::Write as _;

/// The text of a plan.
pub(crate) fn write(seed: u64, plan: &Plan) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = fill(&mut text, seed, plan);
    text
}

fn faced(surface: Surface) -> &'static str {
    match surface {
        Surface::Plain => "plain",
        Surface::Polished => "polished",
        Surface::Glass => "glass",
    }
}

fn fill(out: &mut String, seed: u64, plan: &Plan) -> std::fmt::Result {
    let (width, height) = plan.size;
    let (start, heading) = plan.start;
    writeln!(out, "# Drawn by the generator from seed {seed}.\n")?;
    writeln!(out, "name = \"office {seed}\"\nsize = [{width:.2}, {height:.2}]")?;
    writeln!(out, "start = [{:.2}, {:.2}, {heading:.0}.0]", start.x, start.y)?;
    for wall in &plan.walls {
        let mut doors = wall.doors.clone();
        doors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let doors: Vec<String> = doors.iter().map(|(at, w)| format!("[{at:.2}, {w:.2}]")).collect();
        writeln!(out, "\n[[wall]]\nname = {:?}", wall.name)?;
        writeln!(out, "from = [{:.2}, {:.2}]", wall.from.x, wall.from.y)?;
        writeln!(out, "to = [{:.2}, {:.2}]", wall.to.x, wall.to.y)?;
        writeln!(
            out,
            "doors = [{}]\nsurface = {:?}",
            doors.join(", "),
            faced(wall.surface)
        )?;
    }
    for (i, piece) in plan.pieces.iter().enumerate() {
        writeln!(
            out,
            "\n[[block]]\nname = \"{} {}\"\nkind = {:?}",
            piece.kind,
            i + 1,
            piece.kind
        )?;
        writeln!(out, "at = [{:.2}, {:.2}]", piece.at.x, piece.at.y)?;
        writeln!(out, "size = [{:.2}, {:.2}]", piece.size.0, piece.size.1)?;
        writeln!(
            out,
            "turned = {:.1}\nsurface = {:?}",
            piece.turned,
            faced(piece.surface)
        )?;
    }
    for (i, leaf) in plan.leaves.iter().enumerate() {
        writeln!(out, "\n[[leaf]]\nname = \"door {}\"", i + 1)?;
        writeln!(
            out,
            "at = [{:.2}, {:.2}]\nwidth = {:.2}",
            leaf.at.x, leaf.at.y, leaf.width
        )?;
        writeln!(out, "turned = {:.1}", if leaf.upright { 90.0 } else { 0.0 })?;
    }
    for (i, (at, goal)) in plan.places.iter().enumerate() {
        writeln!(out, "\n[[place]]\nname = \"place {}\"", i + 1)?;
        writeln!(out, "at = [{:.2}, {:.2}]\ngoal = {goal}", at.x, at.y)?;
    }
    for room in plan.rooms.iter().chain(&plan.corridors) {
        let (west, south, east, north) = room.rect;
        writeln!(out, "\n[[room]]\nname = {:?}", room.name)?;
        writeln!(
            out,
            "from = [{west:.2}, {south:.2}]\nto = [{east:.2}, {north:.2}]"
        )?;
    }
    Ok(())
}
