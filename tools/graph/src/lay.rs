//! From the model to the drawing: columns, rows, places, ways, lengths.
//!
//! Must never depend on anything but the model: the same model gives the same drawing.

use ipc::wiring::creature::How;

use crate::compact::{FOOT, HEAD, Lengths, NAME, PILL, Slot, box_width, constant, each_port, measure};
use crate::drawing::{Circle, Drawing, Frame, Line, RADIUS, Shape, Strip, Wire};
use crate::maze::Goal;
use crate::measure::width;
use crate::model::{Model, Node, Role};
use crate::pieces::{Path, paths};
use crate::place::{Places, place};
use crate::route::{goal, route};
use crate::{compact, order, rank};

/// Tracks in each channel beside those that it probably needs; more when a wire finds no way.
const SPARE: [usize; 4] = [8, 16, 32, 64];
/// Room around the picture, in pixels.
const MARGIN: f64 = 10.0;

/// Decides where everything stands.
pub fn draw(model: &Model) -> Drawing {
    let mut model = model.clone();
    let columns = rank::columns(&model);
    let rows = order::rows(&model, &columns);
    let found = SPARE.into_iter().find_map(|spare| {
        let tried = [false, true].map(|upward| {
            let places = place(&model, &columns, &rows, spare, upward);
            let branches = route(&model, &columns, &places).ok()?;
            let cost: u32 = branches.iter().flatten().map(|b| b.cost).sum();
            Some((cost, places, branches))
        });
        tried.into_iter().flatten().min_by_key(|t| t.0)
    });
    let found = found.map(|(_, places, branches)| (places, branches));
    let (places, branches) = found.unwrap_or_else(|| {
        // So much that nothing more fits: the boxes at least, and a word about it.
        model
            .faults
            .push("the wires found no way: the picture shows the modules only".into());
        model.nets.clear();
        for node in &mut model.nodes {
            node.inputs.clear();
            node.outputs.clear();
        }
        (place(&model, &columns, &rows, SPARE[0], false), Vec::new())
    });
    let paths = paths(&model, &places, &branches);
    let lengths = measure(&model, &columns, &places, &paths);
    compose(&model, &columns, &places, &paths, &lengths)
}

fn compose(model: &Model, columns: &[usize], places: &Places, paths: &[Path], lengths: &Lengths) -> Drawing {
    let widest = |role: Role| {
        let ends = model.nodes.iter().filter(|n| n.role == role);
        ends.map(box_width).fold(0.0, f64::max)
    };
    // Titles of bands, then sensors, then column 1.
    let titles = model
        .bands
        .iter()
        .map(|b| width(&b.name, NAME) * 1.06)
        .fold(70.0, f64::max);
    let dx = MARGIN + 12.0 + titles + 14.0 + widest(Role::Sensor) - lengths.columns[0].1;
    let dy = MARGIN - top(lengths);
    let frames: Vec<Frame> = model
        .nodes
        .iter()
        .enumerate()
        .map(|(node, n)| frame(n, node, columns, places, lengths, (dx, dy)))
        .collect();
    let right = lengths.columns.last().map_or(0.0, |c| c.0) + widest(Role::Actuator) + dx + 12.0;
    let bottom = lengths.bands.iter().map(|b| b.1).fold(0.0, f64::max) + dy;
    let bottom = frames.iter().map(|f| f.bottom).fold(bottom, f64::max);
    let mut drawing = Drawing {
        name: model.name.clone(),
        width: (right + MARGIN).ceil(),
        height: (bottom + MARGIN).ceil(),
        bands: Vec::new(),
        boxes: frames,
        faults: model.faults.clone(),
        ..Drawing::default()
    };
    for (band, &(top, bottom)) in model.bands.iter().zip(&lengths.bands).rev() {
        drawing.bands.push(Strip {
            name: band.name.clone(),
            level: band.level,
            process: band.process.clone(),
            top: (top + dy).round(),
            bottom: (bottom + dy).round(),
        });
    }
    let at = |net, p| {
        let (x, y) = lengths.at(net, p);
        ((x + dx).round(), (y + dy).round())
    };
    wires(model, paths, &at, &mut drawing);
    circles(model, columns, places, lengths, (dx, dy), &mut drawing);
    drawing
}

/// The highest point of any band.
fn top(lengths: &Lengths) -> f64 {
    let bands = lengths.bands.iter().map(|b| b.0);
    bands.reduce(f64::min).unwrap_or(0.0)
}

fn frame(
    n: &Node,
    node: usize,
    columns: &[usize],
    places: &Places,
    lengths: &Lengths,
    (dx, dy): (f64, f64),
) -> Frame {
    let slot = Slot::of(n);
    let height = |y| (lengths.slot(slot, y) + dy).round();
    let (first, last) = places.span[node];
    let (left, right) = lengths.columns[columns[node]];
    let (shape, left, right, head, foot) = match n.role {
        Role::Module(_) => (Shape::Module, left, right, HEAD, FOOT),
        Role::Sensor => (Shape::Sensor, right - box_width(n), right, PILL, PILL),
        Role::Actuator => (Shape::Actuator, left, left + box_width(n), PILL, PILL),
    };
    let bare = n.band().is_some() && n.inputs.is_empty() && n.outputs.is_empty();
    let inputs = n.inputs.iter().zip(&places.inputs[node]);
    Frame {
        name: n.name.clone(),
        kind: n.kind.clone(),
        shape,
        left: (left + dx).round(),
        top: height(first) - head + if bare { 10.0 } else { 0.0 },
        right: (right + dx).round(),
        bottom: height(last) + foot,
        inputs: inputs
            .map(|(p, place)| (p.name.clone(), height(place.y)))
            .collect(),
        fault: n.fault.clone(),
    }
}

fn wires(
    model: &Model,
    paths: &[Path],
    at: &dyn Fn(usize, crate::maze::Point) -> (f64, f64),
    drawing: &mut Drawing,
) {
    for (net, n) in model.nets.iter().enumerate() {
        let (node, port) = n.from;
        let mine: Vec<&Path> = paths.iter().filter(|p| p.net == net).collect();
        let label = model.nodes[node].band().map(|_| {
            let start = at(net, mine[0].points[0]);
            (
                model.nodes[node].outputs[port].name.clone(),
                (start.0 + 5.0, start.1 - 4.0),
            )
        });
        let branch = |p: &&Path| {
            let end = p.end.map(|e| &n.ends[e]);
            Line {
                to: end.map_or(String::new(), |e| e.to.clone()),
                points: p.points.iter().map(|&p| at(net, p)).collect(),
                tap: end.and_then(|e| e.tap).map(|t| t.how),
                fault: end.and_then(|e| e.fault.clone()),
            }
        };
        let joints = mine.iter().filter(|p| p.joint).map(|p| at(net, p.points[0]));
        drawing.wires.push(Wire {
            name: n.name.clone(),
            label,
            branches: mine.iter().map(branch).collect(),
            joints: joints.collect(),
        });
    }
    for p in paths.iter().filter(|p| p.net >= model.nets.len()) {
        drawing
            .stubs
            .push([at(p.net, p.points[0]), at(p.net, p.points[1])]);
    }
}

fn circles(
    model: &Model,
    columns: &[usize],
    places: &Places,
    lengths: &Lengths,
    (dx, dy): (f64, f64),
    drawing: &mut Drawing,
) {
    for (net, n) in model.nets.iter().enumerate() {
        for (k, end) in n.ends.iter().enumerate() {
            let Some(tap) = end.tap else { continue };
            let (Goal::Circle(p) | Goal::Eastward(p)) = goal(model, places, net, k);
            let slot = Slot::of(&model.nodes[end.node]);
            let x = (lengths.circle(p) + dx).round();
            drawing.taps.push(Circle {
                from: n.name.clone(),
                to: end.to.clone(),
                how: tap.how,
                at: (x, (lengths.slot(slot, p.1) + dy).round()),
                constant: constant(model, (net, k)),
                fault: end.fault.clone(),
            });
            // The wire's own label comes after the circles of what inhibits it.
            if tap.how == How::Inhibit
                && let Some(target) = drawing.wires.iter_mut().find(|w| w.name == end.to)
                && let Some((_, at)) = &mut target.label
            {
                let written = width(&constant(model, (net, k)), compact::CONSTANT);
                at.0 = at.0.max(x + RADIUS + written + 4.0);
            }
        }
    }
    for (node, _, place) in each_port(model, places, false).filter(|p| p.2.reset) {
        let y = lengths.slot(Slot::of(&model.nodes[node]), place.y);
        let x = lengths.columns[columns[node]].0 - RADIUS - 8.0;
        drawing.resets.push(((x + dx).round(), (y + dy).round()));
    }
}
