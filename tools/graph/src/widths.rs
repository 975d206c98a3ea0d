//! From left to right: columns, upright pieces of wires, circles, labels.
//!
//! Must never look at heights but as lines that are counted: they are decided afterwards.

use std::collections::HashMap;

use crate::compact::{CONSTANT, LABEL, LANE, Lengths, RESET, box_width, constant, each_port};
use crate::drawing::RADIUS;
use crate::maze::Point;
use crate::measure::width;
use crate::model::Model;
use crate::pieces::{Item, Path, Piece, covering, pieces, separate};
use crate::place::Places;
use crate::solve::Distances;

/// Decides where everything stands from left to right.
pub(crate) fn from_left_to_right(
    model: &Model,
    columns: &[usize],
    places: &Places,
    paths: &[Path],
    lengths: &mut Lengths,
) {
    let mut d = Distances::default();
    let edges: Vec<(usize, usize)> = places
        .left
        .iter()
        .zip(&places.right)
        .map(|(&l, &r)| (d.line(4 * l + 1), d.line(4 * r + 2)))
        .collect();
    for (node, &column) in model.nodes.iter().zip(columns) {
        if node.band().is_some() {
            d.apart(edges[column].0, edges[column].1, box_width(node));
        }
    }
    for pair in edges.windows(2) {
        d.apart(pair[0].1, pair[1].0, 30.0);
    }
    let upright = pieces(paths, true, &mut d);
    let mut items: Vec<Item> = Vec::new();
    for p in &upright {
        let next = places.left.partition_point(|&l| l <= p.line).min(edges.len() - 1);
        d.apart(p.var, edges[next].0, 14.0);
        d.apart(edges[next - 1].1, p.var, 11.0);
        items.push(Item {
            var: p.var,
            from: p.low as f64,
            to: p.high as f64,
            before: LANE,
            behind: LANE,
        });
    }
    let mut circles = HashMap::new();
    signs(
        model,
        columns,
        places,
        &edges,
        &upright,
        &mut d,
        &mut items,
        &mut circles,
    );
    labels(model, columns, places, &edges, &circles, &mut d, &mut items);
    let mut ends = HashMap::new();
    for path in paths {
        for &p in &path.points {
            let here = covering(&upright, path.net, p.0, p.1).or_else(|| {
                let right = places.right.iter().position(|&r| r == p.0).map(|c| edges[c].1);
                right.or_else(|| places.left.iter().position(|&l| l == p.0).map(|c| edges[c].0))
            });
            let here = here.or_else(|| circles.get(&p).copied());
            let var = here.unwrap_or_else(|| {
                let var = d.line(4 * p.0 + 2);
                let next = places.left.partition_point(|&l| l <= p.0).min(edges.len() - 1);
                d.apart(var, edges[next].0, 14.0);
                d.apart(edges[next - 1].1, var, 30.0);
                // The loose end of an output that nothing hears keeps others away as a wire does.
                items.push(Item {
                    var,
                    from: p.1 as f64,
                    to: p.1 as f64,
                    before: LANE,
                    behind: LANE,
                });
                var
            });
            ends.insert((path.net, p), var);
        }
        for pair in path.points.windows(2) {
            if pair[0].1 == pair[1].1 {
                d.apart(ends[&(path.net, pair[0])], ends[&(path.net, pair[1])], 2.0 * LANE);
            }
        }
    }
    separate(&items, &mut d);
    let at = d.solve();
    lengths.columns = edges.iter().map(|&(l, r)| (at[l], at[r])).collect();
    lengths.x = ends.into_iter().map(|(k, var)| (k, at[var])).collect();
    lengths.circles = circles.into_iter().map(|(k, var)| (k, at[var])).collect();
}

/// Circles of taps and reset lines.
#[allow(clippy::too_many_arguments)]
fn signs(
    model: &Model,
    columns: &[usize],
    places: &Places,
    edges: &[(usize, usize)],
    upright: &[Piece],
    d: &mut Distances,
    items: &mut Vec<Item>,
    circles: &mut HashMap<Point, usize>,
) {
    for outputs in [false, true] {
        for (node, port, place) in each_port(model, places, outputs) {
            let column = columns[node];
            for (tap, &x) in port.taps.iter().zip(&place.circles) {
                let var = d.line(4 * x + 2);
                if let Some(line) = covering(upright, tap.0, x, place.y) {
                    d.join(var, line);
                }
                let written = width(&constant(model, *tap), CONSTANT) + RADIUS + 5.0;
                if outputs {
                    d.apart(edges[column].1, var, RADIUS + 5.0);
                    if let Some(next) = edges.get(column + 1) {
                        d.apart(var, next.0, written + 12.0);
                    }
                } else {
                    d.apart(var, edges[column].0, written + 4.0);
                    d.apart(edges[column - 1].1, var, RADIUS + 10.0);
                }
                items.push(Item {
                    var,
                    from: place.y as f64 - 1.0,
                    to: place.y as f64,
                    before: RADIUS + 1.0,
                    behind: written,
                });
                circles.insert((x, place.y), var);
            }
            if place.reset {
                items.push(Item {
                    var: edges[column].0,
                    from: place.y as f64,
                    to: place.y as f64,
                    before: RESET,
                    behind: 0.0,
                });
            }
        }
    }
}

/// Labels of wires, behind the output and its circles.
fn labels(
    model: &Model,
    columns: &[usize],
    places: &Places,
    edges: &[(usize, usize)],
    circles: &HashMap<Point, usize>,
    d: &mut Distances,
    items: &mut Vec<Item>,
) {
    for (node, port, place) in each_port(model, places, true) {
        if model.nodes[node].band().is_none() {
            continue;
        }
        let (owner, room) = match (place.circles.last(), port.taps.last()) {
            (Some(&x), Some(&tap)) => (
                circles[&(x, place.y)],
                RADIUS + 6.0 + width(&constant(model, tap), CONSTANT),
            ),
            _ => (edges[columns[node]].1, 0.0),
        };
        let written = room + width(&port.name, LABEL) + 8.0;
        if let Some(next) = edges.get(columns[node] + 1) {
            d.apart(owner, next.0, written + 14.0);
        }
        items.push(Item {
            var: owner,
            from: place.y as f64 - 1.0,
            to: place.y as f64,
            before: -1e9,
            behind: written,
        });
    }
}
