//! Places on a grid of lines: which port of a module stands in which slot, and where boxes, circles and
//! labels keep wires out.
//!
//! ```text
//!   column 1      channel: labels, tracks, circles      column 2
//!  ┌────────┐                                          ┌────────┐
//!  │ module ├─map──┐   ┌────────────────────(S)───────►│ module │
//! ```
//!
//! Lines are counted, not measured: there are more of them than wires need, and the unused ones take no room
//! later. Must never put two ports of one side of a box on one line.

use crate::model::{Model, Role};
use crate::order::Order;

/// Lines from one slot of a row to the next: one for the port, one for its label, one for wires between.
const SLOT: usize = 3;
/// Lines from one circle to the next: the circle and two below its time constant.
const CIRCLE: usize = 3;

/// Where a port stands.
#[derive(Clone, Debug, Default)]
pub(crate) struct Place {
    /// Its horizontal line.
    pub(crate) y: usize,
    /// The box's edge.
    pub(crate) edge: usize,
    /// The vertical line of each of its taps' circles, in the order of its taps.
    pub(crate) circles: Vec<usize>,
    /// Whether it is a reset line, which has a circle right before the box.
    pub(crate) reset: bool,
    /// Where free routing begins.
    pub(crate) terminal: usize,
}

/// Where everything stands on the grid.
#[derive(Debug)]
pub(crate) struct Places {
    /// How many vertical lines there are.
    pub(crate) width: usize,
    /// How many horizontal lines there are.
    pub(crate) height: usize,
    /// The left edge of each column.
    pub(crate) left: Vec<usize>,
    /// The right edge of each column.
    pub(crate) right: Vec<usize>,
    /// First and last horizontal line of each band.
    pub(crate) bands: Vec<(usize, usize)>,
    /// Inputs of each node.
    pub(crate) inputs: Vec<Vec<Place>>,
    /// Outputs of each node.
    pub(crate) outputs: Vec<Vec<Place>>,
    /// First and last horizontal line of each node's ports.
    pub(crate) span: Vec<(usize, usize)>,
}

/// Lines above a box's first port that belong to it, and below its last.
pub(crate) const ABOVE: usize = 3;
/// See [`ABOVE`].
pub(crate) const BELOW: usize = 1;

/// Slots of a node's inputs and outputs.
#[derive(Clone, Debug, Default)]
struct Slots {
    inputs: Vec<i64>,
    outputs: Vec<i64>,
}

impl Slots {
    fn range(&self) -> (i64, i64) {
        let all = || self.inputs.iter().chain(&self.outputs).copied();
        (all().min().unwrap_or(0), all().max().unwrap_or(0))
    }
}

/// Places everything, with `spare` tracks in each channel beside those that it probably needs. Where two ends
/// of the body want one line, one gives way `upward` or downward.
pub(crate) fn place(model: &Model, columns: &[usize], order: &Order, spare: usize, upward: bool) -> Places {
    let slots = slots(model, columns, order);
    // Behind the last module is a column for actuators, also if there are none: wires come out there.
    let modules = model
        .nodes
        .iter()
        .zip(columns)
        .filter(|(n, _)| n.band().is_some());
    let last = modules.map(|(_, c)| *c).max().unwrap_or(0) + 1;
    let ends: usize = model.nets.iter().map(|n| 1 + n.ends.len()).sum();
    let mut places = Places {
        width: 0,
        height: 0,
        left: vec![0; last + 1],
        right: vec![0; last + 1],
        bands: Vec::new(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        span: vec![(0, 0); model.nodes.len()],
    };
    let tracks = spare + (ends / last).min(24);
    across(model, columns, tracks, &mut places);
    let rows = down(
        &slots,
        order,
        spare + (ends / order.count.max(1)).min(24),
        &mut places,
    );
    for (node, slots) in slots.iter().enumerate() {
        let (low, base) = rows[order.rows[node]];
        let line = |s: &i64| base + SLOT * (s - low) as usize + ABOVE + 1;
        let (first, end) = slots.range();
        places.span[node] = (line(&first), line(&end));
        let at = |slots: &[i64], edge| {
            let place = |s| Place {
                y: line(s),
                edge,
                ..Place::default()
            };
            slots.iter().map(place).collect()
        };
        places.inputs.push(at(&slots.inputs, places.left[columns[node]]));
        places
            .outputs
            .push(at(&slots.outputs, places.right[columns[node]]));
    }
    body_ends(model, upward, &mut places);
    stubs(model, &mut places);
    places
}

/// Vertical lines.
fn across(model: &Model, columns: &[usize], tracks: usize, places: &mut Places) {
    let last = places.left.len() - 1;
    let mut x = 0;
    for column in 0..=last {
        if column > 0 {
            x += zone(model, columns, column, false);
            places.left[column] = x;
            x += 1;
        }
        places.right[column] = x;
        x += zone(model, columns, column, true) + tracks;
    }
    places.width = places.right[last] + 1;
}

/// Lines that circles and labels beside a column need.
fn zone(model: &Model, columns: &[usize], column: usize, outputs: bool) -> usize {
    let here = model.nodes.iter().zip(columns).filter(|(_, c)| **c == column);
    let need = here.map(|(node, _)| {
        let ports = if outputs { &node.outputs } else { &node.inputs };
        let circles: usize = ports.iter().map(|p| p.taps.len()).sum();
        circles * CIRCLE + 8
    });
    need.max().unwrap_or(2)
}

/// Horizontal lines: the lowest slot and the first line of each row.
fn down(slots: &[Slots], order: &Order, tracks: usize, places: &mut Places) -> Vec<(i64, usize)> {
    let mut rows = vec![(0, 0); order.count];
    places.bands = vec![(0, 0); order.bands.len()];
    let mut y = 0;
    for (band, &(first, count)) in order.bands.iter().enumerate().rev() {
        let top = y;
        y += tracks;
        for (row, place) in rows.iter_mut().enumerate().skip(first).take(count) {
            let here = || {
                slots
                    .iter()
                    .zip(&order.rows)
                    .filter(|(_, r)| **r == row)
                    .map(|(s, _)| s.range())
            };
            let low = here().map(|(low, _)| low).min().unwrap_or(0);
            let high = here().map(|(_, high)| high).max().unwrap_or(0);
            *place = (low, y);
            y += ABOVE + 1 + SLOT * (high - low) as usize + 1 + BELOW + tracks;
        }
        places.bands[band] = (top, y - 1);
    }
    places.height = y.max(1);
    rows
}

/// Sensors and actuators stand beside what they are wired to first, each on a line of its own; those with the
/// shortest way choose first.
fn body_ends(model: &Model, upward: bool, places: &mut Places) {
    let mut wishes: Vec<(usize, usize, usize)> = Vec::new();
    for (node, n) in model.nodes.iter().enumerate() {
        let nearest = match n.role {
            Role::Module(_) => continue,
            Role::Sensor => {
                let nets = n.outputs.iter().filter_map(|p| p.net);
                let ends = nets.flat_map(|net| &model.nets[net].ends);
                let near = ends.filter(|e| model.nodes[e.node].band().is_some() && !inhibits(e));
                near.map(|e| &places.inputs[e.node][e.port])
                    .map(|p| (p.edge, p.y))
                    .min()
            }
            Role::Actuator => {
                let nets = n.inputs.iter().filter_map(|p| p.net);
                let taps = n.inputs.iter().flat_map(|p| &p.taps);
                let from = nets
                    .chain(taps.map(|&(net, _)| net))
                    .map(|net| model.nets[net].from);
                from.filter(|f| model.nodes[f.0].band().is_some())
                    .map(|(node, port)| &places.outputs[node][port])
                    .map(|p| (places.width - p.edge, p.y))
                    .min()
            }
        };
        let (way, y) = nearest.unwrap_or((places.width, places.height / 2));
        wishes.push((way, y, node));
    }
    wishes.sort_unstable();
    let mut taken: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
    for (_, wanted, node) in wishes {
        let n = &model.nodes[node];
        let taken = &mut taken[usize::from(n.role == Role::Actuator)];
        let extra = SLOT * n.inputs.len().max(n.outputs.len()).saturating_sub(1);
        let free = |y: &usize| taken.iter().all(|t| *t >= y + extra + SLOT || *y >= t + SLOT);
        let reach = places.height + SLOT * 4 * model.nodes.len();
        let near = (0..reach).flat_map(|d| {
            let (over, under) = (wanted.saturating_sub(d), wanted + d);
            if upward { [over, under] } else { [under, over] }
        });
        let y = near.into_iter().find(free).unwrap_or(wanted).max(1);
        places.height = places.height.max(y + extra + 2);
        taken.extend((0..=extra / SLOT).map(|k| y + SLOT * k));
        places.span[node] = (y, y + extra);
        for (k, p) in places.inputs[node].iter_mut().enumerate() {
            p.y = y + SLOT * k;
        }
        for (k, p) in places.outputs[node].iter_mut().enumerate() {
            p.y = y + SLOT * k;
        }
    }
}

fn inhibits(end: &crate::model::End) -> bool {
    end.tap
        .is_some_and(|t| t.how == ipc::wiring::creature::How::Inhibit)
}

/// Circles and labels beside the ports. Each circle of a box has a vertical line of its own, so that whatever
/// taps it can come from above or below past the other ports.
fn stubs(model: &Model, places: &mut Places) {
    for (node, n) in model.nodes.iter().enumerate() {
        let mut used = 0;
        for (port, place) in n.inputs.iter().zip(&mut places.inputs[node]) {
            let mut x = place.edge - 1;
            if port.name == "reset" && n.band().is_some() {
                place.reset = true;
                x = place.edge - 3;
            }
            // The tap that stands last in series is nearest to the module.
            for _ in &port.taps {
                used += CIRCLE;
                x = place.edge - used - 2;
                place.circles.insert(0, x);
                x -= 1;
            }
            place.terminal = x;
        }
        let mut used = 0;
        for (port, place) in n.outputs.iter().zip(&mut places.outputs[node]) {
            let mut x = place.edge;
            for _ in &port.taps {
                x = place.edge + used + 2;
                used += CIRCLE;
                place.circles.push(x);
                x += 2;
            }
            place.terminal = x + if n.band().is_some() { 3 } else { 1 };
        }
    }
}

/// Slots row by row: a wire from one module to the next in its row runs straight.
fn slots(model: &Model, columns: &[usize], order: &Order) -> Vec<Slots> {
    let mut slots = vec![Slots::default(); model.nodes.len()];
    for row in 0..order.count {
        let mut here: Vec<usize> = (0..model.nodes.len())
            .filter(|&n| model.nodes[n].band().is_some() && order.rows[n] == row)
            .collect();
        here.sort_by_key(|&n| columns[n]);
        let mut anchor = 0;
        let mut main_in = None;
        for (k, &node) in here.iter().enumerate() {
            let next = here.get(k + 1).and_then(|&next| straight(model, node, next));
            let main_out = next.map(|(out, _)| out).or_else(|| {
                let last = k + 1 == here.len();
                last.then(|| to_actuator(model, node)).flatten()
            });
            if k == 0 {
                main_in = from_sensor(model, node);
            }
            let n = &model.nodes[node];
            let inputs: Vec<f64> = (0..n.inputs.len())
                .map(|i| input_pull(model, order, node, i))
                .collect();
            let outputs: Vec<f64> = (0..n.outputs.len())
                .map(|o| output_pull(model, order, node, o))
                .collect();
            slots[node].inputs = arrange(&inputs, main_in, anchor);
            slots[node].outputs = arrange(&outputs, main_out, anchor);
            main_in = next.map(|(_, input)| input);
            anchor = next.map_or(0, |(out, _)| slots[node].outputs[out]);
        }
    }
    for (node, n) in model.nodes.iter().enumerate() {
        if n.band().is_none() {
            slots[node].inputs = vec![0; n.inputs.len()];
            slots[node].outputs = vec![0; n.outputs.len()];
        }
    }
    slots
}

/// The first wire from one node to another: its output and its input.
fn straight(model: &Model, from: usize, to: usize) -> Option<(usize, usize)> {
    let outputs = model.nodes[from].outputs.iter().enumerate();
    outputs
        .filter_map(|(o, p)| Some((o, p.net?)))
        .find_map(|(o, net)| {
            let ends = &model.nets[net].ends;
            let end = ends.iter().find(|e| e.node == to && e.tap.is_none())?;
            Some((o, end.port))
        })
}

fn to_actuator(model: &Model, node: usize) -> Option<usize> {
    model.nodes[node].outputs.iter().position(|p| {
        let ends = p.net.map_or(&[][..], |net| &model.nets[net].ends);
        ends.iter().any(|e| model.nodes[e.node].role == Role::Actuator)
    })
}

fn from_sensor(model: &Model, node: usize) -> Option<usize> {
    model.nodes[node].inputs.iter().position(|p| {
        p.net
            .is_some_and(|net| model.nodes[model.nets[net].from.0].role == Role::Sensor)
    })
}

/// Slots of ports: the main one at `anchor`, those pulled upward above it, the others below.
fn arrange(pulls: &[f64], main: Option<usize>, anchor: i64) -> Vec<i64> {
    let mut order: Vec<usize> = (0..pulls.len()).filter(|i| Some(*i) != main).collect();
    order.sort_by(|a, b| pulls[*a].total_cmp(&pulls[*b]));
    let above = match main {
        Some(_) => order.iter().filter(|i| pulls[**i] < 0.0).count(),
        None => 0,
    };
    if let Some(main) = main {
        order.insert(above, main);
    }
    let mut slots = vec![0; pulls.len()];
    for (k, port) in order.into_iter().enumerate() {
        slots[port] = anchor + k as i64 - above as i64;
    }
    slots
}

/// Which way an input is pulled: negative is upward.
fn input_pull(model: &Model, order: &Order, node: usize, input: usize) -> f64 {
    let port = &model.nodes[node].inputs[input];
    if port.name == "reset" {
        return 1000.0;
    }
    let tapped = if port.taps.is_empty() { 0.0 } else { -0.5 };
    let Some(net) = port.net else {
        return -1.0;
    };
    tapped + pull(model, order, node, model.nets[net].from.0)
}

fn output_pull(model: &Model, order: &Order, node: usize, output: usize) -> f64 {
    let Some(net) = model.nodes[node].outputs[output].net else {
        return 0.0;
    };
    let ends = &model.nets[net].ends;
    let sum: f64 = ends.iter().map(|e| pull(model, order, node, e.node)).sum();
    sum / ends.len().max(1) as f64
}

fn pull(model: &Model, order: &Order, node: usize, other: usize) -> f64 {
    if model.nodes[other].band().is_none() {
        return 0.5;
    }
    match order.rows[other] as f64 - order.rows[node] as f64 {
        0.0 => 0.3,
        apart => apart,
    }
}
