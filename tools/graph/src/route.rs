//! Ways of all wires: each net is a tree from its output to all that hears it.
//!
//! Nets are found one after the other, then each again while the others stay, which takes out crossings that
//! only the order had made. Must never leave out an end because it is hard to reach: then there is more room.

use crate::maze::{Goal, Maze, Point};
use crate::model::{Model, Node};
use crate::place::{ABOVE, BELOW, Place, Places};

/// The way to one end of a net.
#[derive(Clone, Debug)]
pub(crate) struct Branch {
    /// The end's index in its net.
    pub(crate) end: usize,
    /// Points one step apart, from the output's terminal or a joint to the end's terminal or circle.
    pub(crate) way: Vec<Point>,
    /// What it cost when it was found.
    pub(crate) cost: u32,
}

/// How often all nets are begun anew with the one first that found no way.
const TRIES_MAX: usize = 12;
/// How often each net is found again while the others stay.
const ROUNDS: usize = 3;

/// How many lines before an input and behind an output others are asked to leave alone.
const HALO: usize = 6;

/// The branches of every net, or the number of nets that found no way.
pub(crate) fn route(model: &Model, columns: &[usize], places: &Places) -> Result<Vec<Vec<Branch>>, usize> {
    let mut order: Vec<usize> = (0..model.nets.len()).collect();
    order.sort_by_key(|&net| (reach(model, places, net), net));
    for _ in 0..TRIES_MAX {
        let mut maze = enclose(model, columns, places);
        let mut branches = vec![Vec::new(); model.nets.len()];
        let failed = order
            .iter()
            .position(|&net| match lay(model, places, &mut maze, net) {
                Some(found) => {
                    branches[net] = found;
                    false
                }
                None => true,
            });
        let Some(failed) = failed else {
            again(model, places, &mut maze, &order, &mut branches);
            return Ok(branches);
        };
        let net = order.remove(failed);
        order.insert(0, net);
    }
    Err(order[0])
}

fn again(model: &Model, places: &Places, maze: &mut Maze, order: &[usize], branches: &mut [Vec<Branch>]) {
    for _ in 0..ROUNDS {
        for &net in order {
            let old = std::mem::take(&mut branches[net]);
            enter(model, places, maze, net, &old, false);
            branches[net] = match lay(model, places, maze, net) {
                Some(found) => found,
                None => {
                    enter(model, places, maze, net, &old, true);
                    old
                }
            };
        }
    }
}

/// How far the ends of a net lie apart: short wires come first.
fn reach(model: &Model, places: &Places, net: usize) -> usize {
    let from = source(model, places, net);
    let ends = model.nets[net].ends.iter();
    let apart = ends.map(|e| {
        let p = target(model, places, net, e.node, e.port);
        let tall = p.y.abs_diff(from.y);
        // A wire that runs straight on comes before all others.
        if tall == 0 && p.edge > from.edge {
            0
        } else {
            tall + p.edge.abs_diff(from.edge)
        }
    });
    apart.sum()
}

fn source<'p>(model: &Model, places: &'p Places, net: usize) -> &'p Place {
    let (node, port) = model.nets[net].from;
    &places.outputs[node][port]
}

fn target<'p>(model: &Model, places: &'p Places, net: usize, node: usize, port: usize) -> &'p Place {
    let inhibits = model.nets[net]
        .ends
        .iter()
        .any(|e| e.node == node && e.port == port && is_inhibitor(e));
    if inhibits {
        &places.outputs[node][port]
    } else {
        &places.inputs[node][port]
    }
}

fn is_inhibitor(end: &crate::model::End) -> bool {
    end.tap
        .is_some_and(|t| t.how == ipc::wiring::creature::How::Inhibit)
}

/// The place of an end's port, and the goal of the way to it.
pub(crate) fn goal(model: &Model, places: &Places, net: usize, end: usize) -> Goal {
    let e = &model.nets[net].ends[end];
    let (node, place): (&Node, &Place) = (
        &model.nodes[e.node],
        if is_inhibitor(e) {
            &places.outputs[e.node][e.port]
        } else {
            &places.inputs[e.node][e.port]
        },
    );
    if e.tap.is_none() {
        return Goal::Eastward((place.terminal, place.y));
    }
    let port = if is_inhibitor(e) {
        &node.outputs[e.port]
    } else {
        &node.inputs[e.port]
    };
    let which = port.taps.iter().position(|t| *t == (net, end)).unwrap_or(0);
    Goal::Circle((place.circles[which], place.y))
}

/// Finds the tree of a net and enters it.
fn lay(model: &Model, places: &Places, maze: &mut Maze, net: usize) -> Option<Vec<Branch>> {
    let from = source(model, places, net);
    let start = (from.terminal, from.y);
    let owner = net as u32;
    let mut goals: Vec<(usize, Goal)> = (0..model.nets[net].ends.len())
        .map(|end| (end, goal(model, places, net, end)))
        .collect();
    goals.sort_by_key(|&(end, g)| {
        let (Goal::Eastward(p) | Goal::Circle(p)) = g;
        (p.0.abs_diff(start.0) + p.1.abs_diff(start.1), end)
    });
    let mut branches: Vec<Branch> = Vec::new();
    for (end, goal) in goals {
        let mut sources = Vec::new();
        if branches.is_empty() {
            sources.push((start, Some(0)));
        } else {
            for b in &branches {
                let inner = &b.way[..b.way.len() - 1];
                let free = inner.iter().filter(|&&p| maze.may_branch(p, owner));
                sources.extend(free.map(|&p| (p, None)));
            }
            if sources.is_empty() {
                sources.push((start, None));
            }
        }
        let Some((way, cost)) = maze.find(&sources, goal, owner) else {
            enter(model, places, maze, net, &branches, false);
            return None;
        };
        let branch = Branch { end, way, cost };
        enter(model, places, maze, net, std::slice::from_ref(&branch), true);
        branches.push(branch);
    }
    Some(branches)
}

/// Enters or removes branches; terminals and circles belong to their ports for good.
fn enter(model: &Model, places: &Places, maze: &mut Maze, net: usize, branches: &[Branch], enter: bool) {
    let from = source(model, places, net);
    let start = (from.terminal, from.y);
    for b in branches {
        maze.mark(&b.way, start, net as u32, enter);
    }
}

/// A maze with boxes, labels and the stubs of all ports in it.
fn enclose(model: &Model, columns: &[usize], places: &Places) -> Maze {
    let mut maze = Maze::new(places.width, places.height, &places.left, &places.right);
    let mut stranger = model.nets.len() as u32;
    for (node, n) in model.nodes.iter().enumerate() {
        let (first, last) = places.span[node];
        let (top, bottom) = match n.band() {
            Some(_) => (first - ABOVE, last + BELOW),
            None => (first.saturating_sub(1), (last + 1).min(places.height - 1)),
        };
        let column = columns[node];
        for y in top..=bottom {
            if column > 0 {
                maze.block((places.left[column], y));
            }
            maze.block((places.right[column].min(places.width - 1), y));
        }
        for (port, place) in n.inputs.iter().zip(&places.inputs[node]) {
            stranger += 1;
            let owner = port.net.map_or(stranger, |net| net as u32);
            (place.terminal + 1..place.edge).for_each(|x| maze.pass((x, place.y), owner));
            maze.give((place.terminal, place.y), owner);
            let near = place.terminal.saturating_sub(HALO);
            (near..place.terminal).for_each(|x| maze.shade((x, place.y), owner));
            circles(&mut maze, place, owner);
        }
        for (port, place) in n.outputs.iter().zip(&places.outputs[node]) {
            stranger += 1;
            let owner = port.net.map_or(stranger, |net| net as u32);
            (place.edge + 1..place.terminal).for_each(|x| maze.pass((x, place.y), owner));
            maze.give((place.terminal, place.y), owner);
            let near = (place.terminal + 1 + HALO).min(places.width);
            (place.terminal + 1..near).for_each(|x| maze.shade((x, place.y), owner));
            if n.band().is_some() {
                (place.terminal - 2..place.terminal).for_each(|x| maze.block((x, place.y - 1)));
            }
            circles(&mut maze, place, owner);
        }
    }
    maze
}

fn circles(maze: &mut Maze, place: &Place, owner: u32) {
    for &x in &place.circles {
        maze.give((x, place.y), owner);
        if place.y > 0 {
            maze.block((x + 1, place.y - 1));
            maze.block((x + 2, place.y - 1));
        }
    }
}
