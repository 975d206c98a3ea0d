//! What a picture must keep whatever the creature: nothing left out, nothing on top of something else.

mod files;
mod random;

use graph::{Drawing, Model, Shape, draw};
use proptest::prelude::*;

type Piece = (usize, graph::At, graph::At);

/// Straight pieces of all lines with the number of their wire.
fn pieces(drawing: &Drawing) -> Vec<Piece> {
    let wires = drawing.wires.iter().enumerate();
    let lines = wires.flat_map(|(net, w)| w.branches.iter().map(move |b| (net, &b.points)));
    let mut pieces: Vec<Piece> = lines
        .flat_map(|(net, points)| points.windows(2).map(move |p| (net, p[0], p[1])))
        .collect();
    let count = drawing.wires.len();
    pieces.extend(
        drawing
            .stubs
            .iter()
            .enumerate()
            .map(|(k, s)| (count + k, s[0], s[1])),
    );
    pieces
}

/// Whether two closed stretches share more than `least`.
fn share(a: (f64, f64), b: (f64, f64), least: f64) -> bool {
    a.0.max(a.1).min(b.0.max(b.1)) - a.0.min(a.1).max(b.0.min(b.1)) > least
}

fn level(p: &Piece) -> bool {
    p.1.1 == p.2.1
}

/// Everything that is wrong with a drawing.
fn wrongs(model: &Model, drawing: &Drawing) -> Vec<String> {
    let mut wrong = Vec::new();
    let pieces = pieces(drawing);
    for p in &pieces {
        if !level(p) && p.1.0 != p.2.0 {
            wrong.push(format!("a slanting piece {p:?}"));
        }
        for b in &drawing.boxes {
            let inside = share((p.1.0, p.2.0), (b.left + 1.0, b.right - 1.0), -0.5)
                && share((p.1.1, p.2.1), (b.top + 1.0, b.bottom - 1.0), -0.5);
            if inside {
                wrong.push(format!("{p:?} runs through {}", b.name));
            }
        }
        for t in drawing.taps.iter().filter(|t| !touches(drawing, p.0, t)) {
            let near = graph::RADIUS + 1.0;
            let (x, y) = t.at;
            if share((p.1.0, p.2.0), (x - near, x + near), -0.5)
                && share((p.1.1, p.2.1), (y - near, y + near), -0.5)
            {
                wrong.push(format!("{p:?} runs through the tap of {} on {}", t.from, t.to));
            }
        }
    }
    for (k, a) in pieces.iter().enumerate() {
        for b in &pieces[k + 1..] {
            if a.0 == b.0 {
                continue;
            }
            let both = level(a) == level(b);
            let (near, along) = if level(a) {
                ((a.1.1 - b.1.1).abs(), share((a.1.0, a.2.0), (b.1.0, b.2.0), -3.0))
            } else {
                ((a.1.0 - b.1.0).abs(), share((a.1.1, a.2.1), (b.1.1, b.2.1), -3.0))
            };
            if both && near < 6.0 && along {
                wrong.push(format!("{a:?} and {b:?} lie on each other"));
            }
            if !both {
                let (h, v) = if level(a) { (a, b) } else { (b, a) };
                let inner = |x: f64, p: f64, q: f64| p.min(q) + 5.0 <= x && x <= p.max(q) - 5.0;
                let meets = share((h.1.0, h.2.0), (v.1.0, v.1.0), -3.0)
                    && share((v.1.1, v.2.1), (h.1.1, h.1.1), -3.0);
                let tapped = |t: &graph::Circle| (t.at.0 - v.1.0).abs() < 1.0 && (t.at.1 - h.1.1).abs() < 1.0;
                if meets
                    && !drawing.taps.iter().any(tapped)
                    && !(inner(v.1.0, h.1.0, h.2.0) && inner(h.1.1, v.1.1, v.2.1))
                {
                    wrong.push(format!("{a:?} and {b:?} meet where one of them ends"));
                }
            }
        }
    }
    wrong.extend(boxes(drawing));
    wrong.extend(missing(model, drawing));
    wrong
}

/// Whether a tap's circle stands on that wire or is its end.
fn touches(drawing: &Drawing, net: usize, tap: &graph::Circle) -> bool {
    let Some(wire) = drawing.wires.get(net) else {
        return true;
    };
    wire.name == tap.from
        || wire.name == tap.to
        || wire.branches.iter().any(|b| b.to == tap.to && b.tap.is_none())
}

fn boxes(drawing: &Drawing) -> Vec<String> {
    let mut wrong = Vec::new();
    for (k, a) in drawing.boxes.iter().enumerate() {
        if a.left < 0.0 || a.top < 0.0 || a.right > drawing.width || a.bottom > drawing.height {
            wrong.push(format!("{} stands outside the picture", a.name));
        }
        for b in &drawing.boxes[k + 1..] {
            if share((a.left, a.right), (b.left, b.right), -4.0)
                && share((a.top, a.bottom), (b.top, b.bottom), -4.0)
            {
                wrong.push(format!("{} and {} overlap", a.name, b.name));
            }
        }
    }
    for (k, a) in drawing.taps.iter().enumerate() {
        for b in &drawing.taps[k + 1..] {
            if (a.at.0 - b.at.0).hypot(a.at.1 - b.at.1) < 2.0 * graph::RADIUS {
                wrong.push(format!("taps {} and {} overlap", a.from, b.from));
            }
        }
    }
    for pair in drawing.bands.windows(2) {
        if pair[0].level < pair[1].level || pair[0].bottom >= pair[1].top {
            wrong.push("levels do not lie on each other".into());
        }
    }
    wrong
}

/// Everything of the model that the drawing does not have, and lines that do not arrive where they lead.
fn missing(model: &Model, drawing: &Drawing) -> Vec<String> {
    let mut wrong = Vec::new();
    if drawing.boxes.len() != model.nodes.len() || drawing.bands.len() != model.bands.len() {
        wrong.push("boxes or bands are missing".into());
    }
    for (net, n) in model.nets.iter().enumerate() {
        let Some(wire) = drawing.wires.get(net).filter(|w| w.name == n.name) else {
            wrong.push(format!("wire {} is missing", n.name));
            continue;
        };
        let leads = wire.branches.iter().filter(|b| !b.to.is_empty()).count();
        if leads != n.ends.len() {
            wrong.push(format!("{} leads to {leads} ends, not {}", n.name, n.ends.len()));
        }
        let start = &drawing.boxes[n.from.0];
        if wire.branches[0].points[0].0 != start.right {
            wrong.push(format!("{} does not begin at {}", n.name, start.name));
        }
        for b in wire.branches.iter().filter(|b| !b.to.is_empty()) {
            let last = *b.points.last().expect("a line has points");
            let arrives = match b.tap {
                Some(how) => drawing
                    .taps
                    .iter()
                    .any(|t| t.at == last && t.how == how && t.from == wire.name && t.to == b.to),
                None => drawing
                    .boxes
                    .iter()
                    .any(|f| f.left == last.0 && f.top < last.1 && last.1 < f.bottom),
            };
            if !arrives {
                wrong.push(format!("{} does not arrive at {}", n.name, b.to));
            }
        }
    }
    wrong
}

fn hold(model: &Model) {
    let drawing = draw(model);
    let wrong = wrongs(model, &drawing);
    assert!(wrong.is_empty(), "{}\n{model:#?}", wrong.join("\n"));
    let file = |d: &Drawing| graph::svg(d, graph::Dress::File);
    assert!(
        file(&drawing) == file(&draw(model)),
        "two drawings of one creature differ"
    );
}

#[test]
fn allen_with_one_two_and_three_levels() {
    for levels in 1..=3 {
        hold(&files::allen(levels));
    }
}

#[test]
fn twenty_modules_in_five_layers() {
    hold(&files::read(&[include_str!("files/herbert.toml")]));
}

#[test]
fn level_0_lies_at_the_bottom_sensors_left_actuators_right() {
    let drawing = draw(&files::allen(3));
    let levels: Vec<u8> = drawing.bands.iter().map(|b| b.level).collect();
    assert_eq!(levels, [2, 1, 0]);
    let of = |shape| drawing.boxes.iter().filter(move |b| b.shape == shape);
    let left = of(Shape::Module).map(|b| b.left).fold(f64::MAX, f64::min);
    let right = of(Shape::Module).map(|b| b.right).fold(0.0, f64::max);
    assert!(of(Shape::Sensor).all(|b| b.right < left));
    assert!(of(Shape::Actuator).all(|b| b.left > right));
}

#[test]
fn suppressors_stand_in_series_before_the_input_the_highest_level_nearest() {
    let drawing = draw(&files::read(&[include_str!("files/herbert.toml")]));
    let on = drawing.taps.iter().filter(|t| t.to == "drive.heading");
    let mut on: Vec<_> = on.map(|t| (t.at.0, t.from.as_str())).collect();
    on.sort_by(|a, b| a.0.total_cmp(&b.0));
    let names: Vec<&str> = on.iter().map(|t| t.1).collect();
    assert_eq!(names, ["follow.heading", "through.heading", "home.heading"]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn any_creature(file in random::creature()) {
        hold(&files::read(&[&file]));
    }
}
