//! Lines as corners on the grid, and the straight pieces that they are made of.
//!
//! Must never join pieces of different nets.

use crate::maze::Point;
use crate::model::Model;
use crate::place::Places;
use crate::route::Branch;
use crate::solve::Distances;

/// A line along the grid: a net's corners, port to port, joint to port or joint to circle.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    pub(crate) net: usize,
    /// The end it leads to, if it leads to one.
    pub(crate) end: Option<usize>,
    /// Whether it begins at a joint.
    pub(crate) joint: bool,
    pub(crate) points: Vec<Point>,
}

/// Corners of all lines; a net that leads nowhere has its stub, an input that only taps reach one under a
/// number beyond the nets'.
pub(crate) fn paths(model: &Model, places: &Places, branches: &[Vec<Branch>]) -> Vec<Path> {
    let mut paths = Vec::new();
    for (net, found) in branches.iter().enumerate() {
        let (node, port) = model.nets[net].from;
        let from = &places.outputs[node][port];
        if found.is_empty() {
            let points = vec![(from.edge, from.y), (from.terminal, from.y)];
            paths.push(Path {
                net,
                end: None,
                joint: false,
                points,
            });
        }
        for (k, b) in found.iter().enumerate() {
            let end = &model.nets[net].ends[b.end];
            let mut points = b.way.clone();
            if k == 0 {
                points.insert(0, (from.edge, from.y));
            }
            if end.tap.is_none() {
                points.push((places.inputs[end.node][end.port].edge, points[points.len() - 1].1));
            }
            paths.push(Path {
                net,
                end: Some(b.end),
                joint: k > 0,
                points: corners(&points),
            });
        }
    }
    let mut stranger = model.nets.len();
    for (n, inputs) in model.nodes.iter().zip(&places.inputs) {
        for (_, place) in n.inputs.iter().zip(inputs).filter(|(p, _)| p.net.is_none()) {
            let start = place.circles.first().copied().unwrap_or(place.terminal);
            let points = vec![(start, place.y), (place.edge, place.y)];
            paths.push(Path {
                net: stranger,
                end: None,
                joint: false,
                points,
            });
            stranger += 1;
        }
    }
    paths
}

fn corners(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for &p in points {
        if kept.last() == Some(&p) {
            continue;
        }
        if let [.., a, b] = kept[..]
            && ((a.0 == b.0 && b.0 == p.0) || (a.1 == b.1 && b.1 == p.1))
        {
            kept.pop();
        }
        kept.push(p);
    }
    kept
}

/// Straight pieces of one net on one line that touch.
pub(crate) struct Piece {
    pub(crate) net: usize,
    pub(crate) line: usize,
    pub(crate) low: usize,
    pub(crate) high: usize,
    pub(crate) var: usize,
}

/// The straight pieces of all paths, upright or level.
pub(crate) fn pieces(paths: &[Path], upright: bool, distances: &mut Distances) -> Vec<Piece> {
    let mut raw: Vec<(usize, usize, usize, usize)> = Vec::new();
    for path in paths {
        for pair in path.points.windows(2) {
            let ((ax, ay), (bx, by)) = (pair[0], pair[1]);
            if upright && ax == bx {
                raw.push((path.net, ax, ay.min(by), ay.max(by)));
            } else if !upright && ay == by {
                raw.push((path.net, ay, ax.min(bx), ax.max(bx)));
            }
        }
    }
    raw.sort_unstable();
    let mut pieces: Vec<Piece> = Vec::new();
    for (net, line, low, high) in raw {
        match pieces.last_mut() {
            Some(p) if p.net == net && p.line == line && low <= p.high => p.high = p.high.max(high),
            _ => {
                let var = distances.line(4 * line + 2);
                pieces.push(Piece {
                    net,
                    line,
                    low,
                    high,
                    var,
                });
            }
        }
    }
    pieces
}

/// The line of the piece that covers a point.
pub(crate) fn covering(pieces: &[Piece], net: usize, line: usize, at: usize) -> Option<usize> {
    let start = pieces.partition_point(|p| (p.net, p.line) < (net, line));
    let here = pieces[start..]
        .iter()
        .take_while(|p| (p.net, p.line) == (net, line));
    here.into_iter()
        .find(|p| p.low <= at && at <= p.high)
        .map(|p| p.var)
}

/// Something that keeps its distance: a place on a line with room before and behind it, over a stretch of the
/// other direction.
pub(crate) struct Item {
    pub(crate) var: usize,
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) before: f64,
    pub(crate) behind: f64,
}

/// Keeps items apart whose stretches overlap.
pub(crate) fn separate(items: &[Item], distances: &mut Distances) {
    for (k, a) in items.iter().enumerate() {
        for b in &items[k + 1..] {
            if a.from <= b.to && b.from <= a.to {
                let (first, second) = if distances.rank(a.var) <= distances.rank(b.var) {
                    (a, b)
                } else {
                    (b, a)
                };
                distances.apart(first.var, second.var, first.behind + second.before);
            }
        }
    }
}
