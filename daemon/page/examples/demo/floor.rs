//! A small office and how far a sonar sees in it.

use serde_json::{Value, json};

/// Walls as line segments, doors left open.
pub(crate) const WALLS: [[f64; 4]; 13] = [
    [0.0, 0.0, 12.0, 0.0],
    [12.0, 0.0, 12.0, 8.0],
    [12.0, 8.0, 0.0, 8.0],
    [0.0, 8.0, 0.0, 0.0],
    [0.0, 4.6, 1.6, 4.6],
    [2.6, 4.6, 5.6, 4.6],
    [6.6, 4.6, 9.8, 4.6],
    [10.8, 4.6, 12.0, 4.6],
    [4.2, 4.6, 4.2, 8.0],
    [8.4, 4.6, 8.4, 8.0],
    [0.0, 2.9, 2.4, 2.9],
    [3.4, 2.9, 4.2, 2.9],
    [4.2, 0.0, 4.2, 2.9],
];

/// Name, centre, size and heading of the furniture.
pub(crate) const BOXES: [(&str, f64, f64, f64, f64, f64); 9] = [
    ("desk", 1.0, 7.2, 1.6, 0.8, 0.0),
    ("chair", 1.0, 6.5, 0.45, 0.45, 0.3),
    ("desk", 6.3, 7.3, 1.6, 0.8, 0.0),
    ("chair", 6.2, 6.6, 0.45, 0.45, -0.2),
    ("table", 10.3, 6.4, 1.4, 0.9, 0.5),
    ("shelf", 0.3, 1.2, 0.4, 1.6, 0.0),
    ("sofa", 6.6, 0.55, 1.9, 0.8, 0.0),
    ("plant", 11.5, 0.5, 0.5, 0.5, 0.0),
    ("box", 9.2, 1.6, 0.6, 0.5, 0.7),
];

/// The floor of `/api/plan`.
pub(crate) fn plan() -> Value {
    let boxes: Vec<Value> = BOXES
        .iter()
        .map(|(name, x, y, w, h, heading)| {
            json!({"name": name, "x": x, "y": y, "w": w, "h": h, "heading": heading})
        })
        .collect();
    json!({"walls": WALLS, "boxes": boxes, "bounds": [0.0, 0.0, 12.0, 8.0]})
}

/// How far it is from `(x, y)` along `angle` to the first thing, at most `max_m`.
pub(crate) fn range(x: f64, y: f64, angle: f64, people: &[(f64, f64)], max_m: f64) -> f64 {
    let (dx, dy) = (angle.cos(), angle.sin());
    let mut nearest = max_m;
    let mut hit = |wall: [f64; 4]| {
        let [x1, y1, x2, y2] = wall;
        let (ex, ey) = (x2 - x1, y2 - y1);
        let cross = dx * ey - dy * ex;
        if cross.abs() < 1e-9 {
            return;
        }
        let along = ((x1 - x) * ey - (y1 - y) * ex) / cross;
        let part = ((x1 - x) * dy - (y1 - y) * dx) / cross;
        if along > 0.0 && (0.0..=1.0).contains(&part) {
            nearest = nearest.min(along);
        }
    };
    WALLS.into_iter().for_each(&mut hit);
    for (_, cx, cy, w, h, heading) in BOXES {
        let (c, s) = (f64::cos(heading), f64::sin(heading));
        let corner = |a: f64, b: f64| {
            (
                cx + a * w / 2.0 * c - b * h / 2.0 * s,
                cy + a * w / 2.0 * s + b * h / 2.0 * c,
            )
        };
        let corners = [
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ];
        for index in 0..4 {
            let (from, to) = (corners[index], corners[(index + 1) % 4]);
            hit([from.0, from.1, to.0, to.1]);
        }
    }
    for (px, py) in people {
        hit([px - dy * 0.25, py + dx * 0.25, px + dy * 0.25, py - dx * 0.25]);
    }
    nearest
}
