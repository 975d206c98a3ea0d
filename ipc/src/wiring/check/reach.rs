//! Reach: something can come to every module, no loop waits for itself, no two layers lean on each other.
//!
//! Must never refuse a loop that something can enter: wires delay by a beat, so such loops are well defined.

use std::collections::{HashMap, HashSet};

use super::{Checker, Draft};
use crate::wiring::catalog::{Declaration, Takes};
use crate::wiring::creature::PortName;
use crate::wiring::rule::Rule;

/// How many names of a circle are spelt out.
const NAMES_MAX: usize = 8;

impl Checker<'_> {
    /// Layers of one level that read from each other in a circle.
    pub(super) fn layer_cycles(&mut self, drafts: &[Draft<'_, '_>]) {
        let mut reads: Vec<HashMap<usize, &super::Placed<PortName>>> = vec![HashMap::new(); drafts.len()];
        for draft in drafts {
            for (from, _) in &draft.raw.wires {
                let source = self.modules.get(&from.value.module).map(|k| k.layer);
                let level = source.and_then(|s| drafts.get(s)).map(|d| d.layer.level);
                if let Some(source) = source
                    && source != draft.index
                    && level == Some(draft.layer.level)
                {
                    reads[draft.index].entry(source).or_insert(from);
                }
            }
        }
        let sorted = |r: &HashMap<usize, _>| {
            let mut of: Vec<usize> = r.keys().copied().collect();
            of.sort_unstable();
            of
        };
        let edges: Vec<Vec<usize>> = reads.iter().map(sorted).collect();
        for circle in circles(&edges) {
            let (first, next) = (circle[0], circle[1 % circle.len()]);
            let names = circle.iter().map(|i| drafts[*i].layer.name.as_str());
            let message = format!("layers read from each other: {}", spell(names, " reads "));
            let help = "neither could be debugged before the other: put the modules into one layer, \
                        or one of the layers on a higher level";
            self.findings
                .refuse(Rule::LayerCycle, reads[first][&next].at.clone(), message, help);
        }
    }

    /// A module none of whose inputs anything can reach will never do anything.
    pub(super) fn reached(&mut self, drafts: &[Draft<'_, '_>], open: &[PortName]) {
        // A wire or a tap that could not be read may be the missing one.
        if self.findings.has_lost_wires() {
            return;
        }
        let modules: Vec<_> = drafts.iter().flat_map(|d| &d.layer.modules).collect();
        let index: HashMap<&str, usize> = modules
            .iter()
            .enumerate()
            .map(|(i, m)| (m.name.as_str(), i))
            .collect();
        let mut feeds: Vec<Vec<usize>> = vec![Vec::new(); modules.len()];
        let mut begins: Vec<bool> = modules.iter().map(|m| may_begin(m.declaration)).collect();
        let mut fed: HashSet<usize> = HashSet::new();
        let taps = drafts
            .iter()
            .flat_map(|d| &d.layer.taps)
            .map(|t| (&t.from, &t.to));
        let wires = drafts
            .iter()
            .flat_map(|d| &d.raw.wires)
            .map(|(from, to)| (&from.value, &to.value));
        for (from, to) in wires.chain(taps) {
            let Some(to) = index.get(to.module.as_str()) else {
                continue;
            };
            fed.insert(*to);
            match index.get(from.module.as_str()) {
                Some(from) => feeds[*to].push(*from),
                // The body, the host, or a module whose kind is unknown: any of them may speak.
                None => begins[*to] = true,
            }
        }
        for port in open {
            if let Some(to) = index.get(port.module.as_str()) {
                fed.insert(*to);
                begins[*to] = true;
            }
        }
        for (i, module) in modules.iter().enumerate() {
            if !fed.contains(&i) && !module.declaration.inputs.is_empty() {
                let inputs = module.declaration.inputs.iter().map(|p| format!("{:?}", p.name));
                let message = format!("nothing reaches module {:?}", module.name);
                let help = format!(
                    "expected a wire or a tap into one of its inputs: {}",
                    inputs.collect::<Vec<_>>().join(", ")
                );
                let at = self.modules[&module.name].at.clone();
                self.findings.refuse(Rule::Unreachable, at, message, help);
                // What it feeds is not to blame.
                begins[i] = true;
            }
        }
        let names: Vec<&str> = modules.iter().map(|m| m.name.as_str()).collect();
        self.dead_loops(&names, &feeds, begins);
    }

    fn dead_loops(&mut self, names: &[&str], feeds: &[Vec<usize>], mut awake: Vec<bool>) {
        let mut readers: Vec<Vec<usize>> = vec![Vec::new(); names.len()];
        for (to, sources) in feeds.iter().enumerate() {
            for from in sources {
                readers[*from].push(to);
            }
        }
        let mut ahead: Vec<usize> = (0..names.len()).filter(|i| awake[*i]).collect();
        while let Some(i) = ahead.pop() {
            for reader in &readers[i] {
                if !std::mem::replace(&mut awake[*reader], true) {
                    ahead.push(*reader);
                }
            }
        }
        let asleep = |i: usize| !awake[i];
        let edges: Vec<Vec<usize>> = (0..names.len())
            .map(|i| {
                let sources = feeds[i].iter().copied().filter(|_| asleep(i));
                sources.filter(|from| asleep(*from)).collect()
            })
            .collect();
        for mut circle in circles(&edges) {
            // From source to reader, as the wires are written.
            circle.reverse();
            let message = format!(
                "no module of this loop can speak first: {}",
                spell(circle.iter().map(|i| names[*i]), " -> ")
            );
            let help = "wires may form loops, but something must come in from outside: \
                        expected a wire or a tap from a sensor, a source or another module";
            let at = self.modules[names[circle[0]]].at.clone();
            self.findings.refuse(Rule::DeadLoop, at, message, help);
        }
    }
}

/// Whether a module may speak without having heard anything: it has no inputs, or may have a timer.
fn may_begin(declaration: &Declaration) -> bool {
    let timer = |p: &crate::wiring::Parameter| matches!(p.takes, Takes::Span { .. });
    declaration.inputs.is_empty() || declaration.parameters.iter().any(timer)
}

fn spell<'n>(names: impl ExactSizeIterator<Item = &'n str> + Clone, between: &str) -> String {
    let first = names.clone().next().unwrap_or("");
    let long = names.len() > NAMES_MAX;
    let mut spelt: Vec<&str> = names.take(NAMES_MAX).collect();
    if long {
        spelt.push("...");
    }
    spelt.push(first);
    spelt.join(between)
}

/// One circle of each knot of a graph, each from its least node; `edges[i]` are the nodes that `i` points to.
fn circles(edges: &[Vec<usize>]) -> Vec<Vec<usize>> {
    // Nodes without a way on are in no circle; taking them away leaves those that lead into one.
    let mut out: Vec<usize> = edges.iter().map(Vec::len).collect();
    let mut into: Vec<Vec<usize>> = vec![Vec::new(); edges.len()];
    for (i, targets) in edges.iter().enumerate() {
        for target in targets {
            into[*target].push(i);
        }
    }
    let mut ends: Vec<usize> = (0..edges.len()).filter(|i| out[*i] == 0).collect();
    while let Some(end) = ends.pop() {
        for source in &into[end] {
            out[*source] -= 1;
            if out[*source] == 0 {
                ends.push(*source);
            }
        }
    }
    let mut found = Vec::new();
    let mut walk_of = vec![usize::MAX; edges.len()];
    for start in (0..edges.len()).filter(|i| out[*i] > 0) {
        let mut path = Vec::new();
        let mut here = start;
        while walk_of[here] == usize::MAX {
            walk_of[here] = start;
            path.push(here);
            here = *edges[here]
                .iter()
                .find(|e| out[**e] > 0)
                .expect("a node left over leads on");
        }
        if walk_of[here] != start {
            continue;
        }
        let begin = path.iter().position(|p| *p == here).expect("it was walked");
        let mut circle = path.split_off(begin);
        let least = circle
            .iter()
            .enumerate()
            .min_by_key(|(_, n)| **n)
            .map_or(0, |(i, _)| i);
        circle.rotate_left(least);
        found.push(circle);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::circles;

    #[test]
    fn each_knot_gives_one_circle_and_what_leads_into_it_none() {
        // 0 -> 1 -> 2 -> 1, 3 -> 3, 4 -> 0, 5 alone, 6 -> 5
        let edges = vec![vec![1], vec![2], vec![1], vec![3], vec![0], vec![], vec![5]];
        assert_eq!(circles(&edges), vec![vec![1, 2], vec![3]]);
        assert!(circles(&[vec![1], vec![2], vec![]]).is_empty());
    }
}
