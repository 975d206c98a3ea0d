//! Columns: how far each module stands from the sensors, by the longest path, with cycles broken.
//!
//! Must never let what leads upward decide before what leads along a layer: lower levels are drawn first.

use ipc::wiring::creature::How;

use crate::model::{Model, Role};

/// An edge between modules: `to` stands at least `apart` columns right of `from`.
struct Edge {
    from: usize,
    to: usize,
    apart: usize,
}

/// The column of every node: sensors in 0, actuators in the last one.
pub(crate) fn columns(model: &Model) -> Vec<usize> {
    let nodes = &model.nodes;
    let edges = acyclic(model);
    let mut columns = vec![1; nodes.len()];
    // Without cycles the longest path is found after as many rounds as it has edges.
    for _ in 0..nodes.len() {
        let mut moved = false;
        for e in &edges {
            let least = columns[e.from] + e.apart;
            if columns[e.to] < least {
                columns[e.to] = least;
                moved = true;
            }
        }
        if !moved {
            break;
        }
    }
    // What nothing leads to stands just before what it leads to.
    let fed = |node: usize| {
        let ends = model.nets.iter().filter(|n| n.from.0 != node);
        ends.flat_map(|n| &n.ends).any(|e| e.node == node && !inhibits(e))
    };
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by_key(|&n| std::cmp::Reverse(columns[n]));
    for node in order {
        if nodes[node].band().is_none() || fed(node) {
            continue;
        }
        let next = edges
            .iter()
            .filter(|e| e.from == node)
            .map(|e| columns[e.to] - e.apart);
        if let Some(next) = next.min() {
            columns[node] = next;
        }
    }
    let modules = (0..nodes.len()).filter(|&n| nodes[n].band().is_some());
    let last = modules.map(|n| columns[n]).max().unwrap_or(0) + 1;
    for (column, node) in columns.iter_mut().zip(nodes) {
        match node.role {
            Role::Sensor => *column = 0,
            Role::Actuator => *column = last,
            Role::Module(_) => {}
        }
    }
    columns
}

fn inhibits(end: &crate::model::End) -> bool {
    end.tap.is_some_and(|t| t.how == How::Inhibit)
}

/// Edges that make no cycle: those within a layer count first, then those downward, then those upward.
fn acyclic(model: &Model) -> Vec<Edge> {
    let mut edges = Vec::new();
    for net in &model.nets {
        let from = net.from.0;
        for end in &net.ends {
            let (Some(a), Some(b)) = (model.nodes[from].band(), model.nodes[end.node].band()) else {
                continue;
            };
            if from == end.node {
                continue;
            }
            let apart = usize::from(!inhibits(end));
            let rank = match a.cmp(&b) {
                std::cmp::Ordering::Equal => 0,
                std::cmp::Ordering::Greater => 1,
                std::cmp::Ordering::Less => 2,
            };
            let to = end.node;
            edges.push((rank, Edge { from, to, apart }));
        }
    }
    edges.sort_by_key(|(rank, _)| *rank);
    let mut after: Vec<Vec<usize>> = vec![Vec::new(); model.nodes.len()];
    let mut kept = Vec::new();
    for (_, edge) in edges {
        if reaches(&after, edge.to, edge.from) {
            continue;
        }
        after[edge.from].push(edge.to);
        kept.push(edge);
    }
    kept
}

fn reaches(after: &[Vec<usize>], from: usize, to: usize) -> bool {
    let mut seen = vec![false; after.len()];
    let mut waiting = vec![from];
    while let Some(node) = waiting.pop() {
        if node == to {
            return true;
        }
        if !std::mem::replace(&mut seen[node], true) {
            waiting.extend(&after[node]);
        }
    }
    false
}
