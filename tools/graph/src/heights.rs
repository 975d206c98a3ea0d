//! From top to bottom: bands, rows of boxes, level pieces of wires.
//!
//! Must never be done before widths are known: what stands above what depends on them.

use std::collections::HashMap;

use crate::compact::{
    CONSTANT, FOOT, HEAD, LABEL, LANE, Lengths, PILL, RESET, Slot, box_width, constant, each_port,
};
use crate::drawing::RADIUS;
use crate::measure::width;
use crate::model::{Model, Role};
use crate::pieces::{Item, Path, Piece, covering, pieces, separate};
use crate::place::Places;
use crate::solve::Distances;

/// Least height of a band: its title has two lines.
const BAND_MIN: f64 = 62.0;
/// Room between a band's edge and what stands in it.
const EDGE: f64 = 8.0;

/// Decides where everything stands from top to bottom.
pub(crate) fn from_top_to_bottom(
    model: &Model,
    columns: &[usize],
    places: &Places,
    paths: &[Path],
    lengths: &mut Lengths,
) {
    let mut d = Distances::default();
    let slots = slots(model, places, &mut d);
    let level = pieces(paths, false, &mut d);
    for outputs in [false, true] {
        for (node, _, place) in each_port(model, places, outputs) {
            let slot = slots[&(Slot::of(&model.nodes[node]) as usize, place.y)];
            let mine = level
                .iter()
                .filter(|p| p.line == place.y && (p.low == place.edge || p.high == place.edge));
            mine.for_each(|p| d.join(p.var, slot));
        }
    }
    let mut items: Vec<Item> = Vec::new();
    for p in &level {
        let from = lengths.x[&(p.net, (p.low, p.line))];
        let to = lengths.x[&(p.net, (p.high, p.line))];
        items.push(Item {
            var: p.var,
            from: from - LANE,
            to: to + LANE,
            before: LANE,
            behind: LANE,
        });
    }
    boxes(model, columns, places, &slots, lengths, &mut d, &mut items);
    signs(model, columns, places, &slots, lengths, &mut items);
    separate(&items, &mut d);
    let bands = bands(model, places, &level, &slots, &mut d);
    let mut ends = HashMap::new();
    for path in paths {
        for &p in &path.points {
            let var = covering(&level, path.net, p.1, p.0).unwrap_or_else(|| {
                // A tap that comes from above ends on the line of the port it taps.
                let end = path.end.map(|end| model.nets[path.net].ends[end].node);
                let slot = Slot::of(&model.nodes[end.expect("only a way to a tap ends so")]);
                slots[&(slot as usize, p.1)]
            });
            ends.insert((path.net, p), var);
        }
        for pair in path.points.windows(2) {
            if pair[0].0 == pair[1].0 {
                d.apart(ends[&(path.net, pair[0])], ends[&(path.net, pair[1])], 2.0 * LANE);
            }
        }
    }
    let at = d.solve();
    lengths.bands = bands.iter().map(|&(top, bottom)| (at[top], at[bottom])).collect();
    lengths.y = ends.into_iter().map(|(k, var)| (k, at[var])).collect();
    lengths.slots = slots.into_iter().map(|(k, var)| (k, at[var])).collect();
}

type Slots = HashMap<(usize, usize), usize>;

/// A line for each height at which ports of a row stand, and for each sensor and actuator.
fn slots(model: &Model, places: &Places, d: &mut Distances) -> Slots {
    let mut slots = Slots::new();
    for (n, &(first, last)) in model.nodes.iter().zip(&places.span) {
        let slot = Slot::of(n) as usize;
        for y in [first, last] {
            slots.entry((slot, y)).or_insert_with(|| d.line(4 * y + 2));
        }
    }
    for outputs in [false, true] {
        for (node, _, place) in each_port(model, places, outputs) {
            let slot = Slot::of(&model.nodes[node]) as usize;
            slots
                .entry((slot, place.y))
                .or_insert_with(|| d.line(4 * place.y + 2));
        }
    }
    slots
}

/// Boxes keep wires out, and their ports apart.
fn boxes(
    model: &Model,
    columns: &[usize],
    places: &Places,
    slots: &Slots,
    lengths: &Lengths,
    d: &mut Distances,
    items: &mut Vec<Item>,
) {
    for (node, n) in model.nodes.iter().enumerate() {
        let slot = Slot::of(n);
        let (first, last) = places.span[node];
        let (left, right) = lengths.columns[columns[node]];
        let (from, to, head, foot) = match n.role {
            Role::Module(_) => (left, right, HEAD + 8.0, FOOT + 6.0),
            Role::Sensor => (right - box_width(n), right, PILL + 3.0, PILL + 3.0),
            Role::Actuator => (left, left + box_width(n), PILL + 3.0, PILL + 3.0),
        };
        let var = |y| slots[&(slot as usize, y)];
        for (y, before, behind) in [(first, head, 0.0), (last, 0.0, foot)] {
            items.push(Item {
                var: var(y),
                from,
                to,
                before,
                behind,
            });
        }
        let ports = places.inputs[node].iter().chain(&places.outputs[node]);
        let mut lines: Vec<usize> = ports.map(|p| p.y).collect();
        lines.sort_unstable();
        lines.dedup();
        for pair in lines.windows(2) {
            d.apart(var(pair[0]), var(pair[1]), 17.0);
        }
    }
}

/// Circles with their time constants, and labels of wires.
fn signs(
    model: &Model,
    columns: &[usize],
    places: &Places,
    slots: &Slots,
    lengths: &Lengths,
    items: &mut Vec<Item>,
) {
    for outputs in [false, true] {
        for (node, port, place) in each_port(model, places, outputs) {
            let n = &model.nodes[node];
            let var = slots[&(Slot::of(n) as usize, place.y)];
            let mut add = |from, to, before, behind| {
                items.push(Item {
                    var,
                    from,
                    to,
                    before,
                    behind,
                });
            };
            let mut owner = lengths.columns[columns[node]].1;
            for (tap, &x) in port.taps.iter().zip(&place.circles) {
                let at = lengths.circle((x, place.y));
                let written = width(&constant(model, *tap), CONSTANT);
                add(at - RADIUS - 3.0, at + RADIUS + 3.0, RADIUS + 8.0, RADIUS + 8.0);
                add(at, at + RADIUS + written, 22.0, 0.0);
                owner = at + RADIUS + 2.0 + written;
            }
            if place.reset {
                let edge = lengths.columns[columns[node]].0;
                add(edge - RESET, edge, RADIUS + 4.0, RADIUS + 4.0);
            }
            if outputs && n.band().is_some() {
                add(owner, owner + width(&port.name, LABEL) + 8.0, 15.0, 0.0);
            }
        }
    }
}

/// Upper and lower edges of bands; all that lies in one stays in it.
fn bands(
    model: &Model,
    places: &Places,
    level: &[Piece],
    slots: &Slots,
    d: &mut Distances,
) -> Vec<(usize, usize)> {
    let edges: Vec<(usize, usize)> = places
        .bands
        .iter()
        .map(|&(top, bottom)| (d.line(4 * top + 1), d.line(4 * bottom + 3)))
        .collect();
    for (k, &(top, bottom)) in edges.iter().enumerate() {
        d.apart(top, bottom, BAND_MIN);
        if let Some(&(_, above)) = edges.get(k + 1) {
            d.apart(above, top, EDGE);
        }
    }
    let within = |line: usize| places.bands.iter().position(|b| b.0 <= line && line <= b.1);
    for p in level {
        if let Some(k) = within(p.line) {
            d.apart(edges[k].0, p.var, LANE + EDGE);
            d.apart(p.var, edges[k].1, LANE + EDGE);
        }
    }
    for (n, &(first, last)) in model.nodes.iter().zip(&places.span) {
        let slot = Slot::of(n);
        let (head, foot) = if slot == Slot::Row {
            (HEAD, FOOT)
        } else {
            (PILL, PILL)
        };
        if let Some(k) = within(first) {
            d.apart(edges[k].0, slots[&(slot as usize, first)], head + EDGE);
        }
        if let Some(k) = within(last) {
            d.apart(slots[&(slot as usize, last)], edges[k].1, foot + EDGE);
        }
    }
    edges
}
