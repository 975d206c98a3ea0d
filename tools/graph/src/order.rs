//! Rows: in which row of its band each module stands.
//!
//! Starts from the order of the file and exchanges places within a column as long as wires become shorter,
//! straighter and cross less. Must never leave a band or a column.

use crate::model::Model;

/// Where modules stand: columns and rows, rows counted from the top of the picture.
pub(crate) struct Order {
    /// Row of each node; for the body's ends the row of what they are nearest to.
    pub(crate) rows: Vec<usize>,
    /// First row of each band, and how many it has.
    pub(crate) bands: Vec<(usize, usize)>,
    /// How many rows there are.
    pub(crate) count: usize,
}

/// A line from one module to another.
#[derive(Clone, Copy)]
struct Line {
    from: usize,
    to: usize,
    weight: f64,
}

/// Finds the rows of nodes that stand in `columns`.
pub(crate) fn rows(model: &Model, columns: &[usize]) -> Order {
    let last = columns.iter().max().map_or(0, |c| c + 1);
    let mut bands = vec![(0, 1); model.bands.len()];
    let mut rows = vec![0; model.nodes.len()];
    let mut first = 0;
    for band in (0..model.bands.len()).rev() {
        let mut used = vec![0; last];
        for (node, row) in rows.iter_mut().enumerate() {
            if model.nodes[node].band() == Some(band) {
                *row = first + used[columns[node]];
                used[columns[node]] += 1;
            }
        }
        let count = used.into_iter().max().unwrap_or(0).max(1);
        bands[band] = (first, count);
        first += count;
    }
    let mut order = Order {
        rows,
        bands,
        count: first,
    };
    improve(model, columns, &mut order);
    order
}

fn lines(model: &Model) -> Vec<Line> {
    let mut lines = Vec::new();
    for net in &model.nets {
        for end in &net.ends {
            let (from, to) = (net.from.0, end.node);
            let (Some(a), Some(b)) = (model.nodes[from].band(), model.nodes[to].band()) else {
                continue;
            };
            if from != to {
                let weight = if a == b { 3.0 } else { 1.0 };
                lines.push(Line { from, to, weight });
            }
        }
    }
    lines
}

/// Most rounds of exchanges; each only ever makes the picture better, so this bounds the time and no more.
const ROUNDS_MAX: usize = 8;
/// Most lines for which crossings are counted: their number of pairs is what takes the time.
const CROSSINGS_LINES_MAX: usize = 160;

fn improve(model: &Model, columns: &[usize], order: &mut Order) {
    let lines = lines(model);
    let start = order.rows.clone();
    let mut best = cost(&lines, columns, order, &start);
    for _ in 0..ROUNDS_MAX {
        let mut better = false;
        for node in 0..model.nodes.len() {
            let Some(band) = model.nodes[node].band() else {
                continue;
            };
            let (first, count) = order.bands[band];
            for row in first..first + count {
                let here = order.rows[node];
                if row == here {
                    continue;
                }
                let other = (0..model.nodes.len()).find(|&o| {
                    model.nodes[o].band() == Some(band) && columns[o] == columns[node] && order.rows[o] == row
                });
                order.rows[node] = row;
                if let Some(other) = other {
                    order.rows[other] = here;
                }
                let now = cost(&lines, columns, order, &start);
                if now < best - 1e-9 {
                    best = now;
                    better = true;
                } else {
                    order.rows[node] = here;
                    if let Some(other) = other {
                        order.rows[other] = row;
                    }
                }
            }
        }
        if !better {
            break;
        }
    }
}

fn cost(lines: &[Line], columns: &[usize], order: &Order, start: &[usize]) -> f64 {
    let rows = &order.rows;
    let mut cost = 0.0;
    for l in lines {
        let (a, b) = (rows[l.from], rows[l.to]);
        cost += l.weight * a.abs_diff(b) as f64;
        let (left, right) = (columns[l.from], columns[l.to]);
        let between = |n: usize| rows[n] == a && columns[n] > left.min(right) && columns[n] < left.max(right);
        if a == b && left.abs_diff(right) > 1 && (0..rows.len()).any(between) {
            cost += 2.0;
        }
        if right <= left {
            cost += 0.5 * a.abs_diff(b) as f64;
        }
    }
    if lines.len() <= CROSSINGS_LINES_MAX {
        for (i, p) in lines.iter().enumerate() {
            let crossed = lines[i + 1..].iter().filter(|q| crosses(p, q, columns, rows));
            cost += 1.5 * crossed.count() as f64;
        }
    }
    // Among equals, the order of the file.
    let moved: usize = rows.iter().zip(start).map(|(a, b)| a.abs_diff(*b)).sum();
    cost + 0.01 * moved as f64
}

/// Whether two straight lines between modules cross, by the side on which each one's ends lie.
fn crosses(p: &Line, q: &Line, columns: &[usize], rows: &[usize]) -> bool {
    let at = |n: usize| (columns[n] as i64, rows[n] as i64);
    let side = |a: (i64, i64), b: (i64, i64), c: (i64, i64)| {
        ((b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)).signum()
    };
    let (a, b, c, d) = (at(p.from), at(p.to), at(q.from), at(q.to));
    side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0
}
