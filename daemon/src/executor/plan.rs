//! Plans: from the layers of a checked creature to the threads that beat them.
//!
//! Must never start anything: which layers share a thread, at which priority, how they wait and what they
//! may spend is decided here, once, from the file alone.
//!
//! Priorities are rate-monotonic (C. L. Liu, J. W. Layland, "Scheduling algorithms for multiprogramming in a
//! hard-real-time environment", J. ACM 20(1), 1973): the shorter the period, the higher the priority.

use ipc::clock::Span;
use ipc::wiring::creature::{Creature, Executor, Layer, Overrun, Policy, Wake, rate_monotonic};

/// Share of a period that a SCHED_DEADLINE thread reserves, all threads of one period together. The host
/// grants 95 % of each processor in all; what is left runs the world and those who watch.
const RESERVED_MAX: f64 = 0.6;

/// Threads that belong to no layer: the motor unit and the watchdog.
const OWN: usize = 2;

/// Least reservation that the kernel takes (sched(7)): 1024 ns.
const RUNTIME_MIN: Span = Span::nanos(1024);

/// How a thread is scheduled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Schedule {
    /// The ordinary scheduler.
    Ordinary,
    /// SCHED_FIFO at this priority.
    Fifo(u8),
    /// SCHED_DEADLINE: this much time in every period, by the end of the period.
    Deadline {
        /// What is reserved.
        runtime: Span,
        /// Of what.
        period: Span,
    },
}

impl std::fmt::Display for Schedule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Schedule::Ordinary => f.write_str("SCHED_OTHER"),
            Schedule::Fifo(priority) => write!(f, "SCHED_FIFO {priority}"),
            Schedule::Deadline { runtime, period } => write!(f, "SCHED_DEADLINE {runtime}/{period}"),
        }
    }
}

/// How a thread beats.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The thread's name.
    pub name: String,
    /// Time between beats.
    pub period: Span,
    /// Where the beats lie within the period.
    pub phase: Span,
    /// How it is scheduled.
    pub schedule: Schedule,
    /// The processor it is bound to, by the host's number.
    pub cpu: Option<usize>,
    /// How it waits for its beat.
    pub wake: Wake,
    /// What happens when a beat misses its deadline.
    pub overrun: Overrun,
    /// Whether it is expected to allocate nothing once it beats.
    pub sealed: bool,
}

/// A thread and the layers on it, by their index in the creature; lowest level first.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// How the thread beats.
    pub plan: Plan,
    /// Its layers.
    pub layers: Vec<usize>,
}

/// The threads of `creature`'s layers, in the order of their lowest layer.
///
/// # Errors
/// One sentence for each thing that cannot be: groups whose layers differ, spinning beyond the share.
pub fn threads(creature: &Creature) -> Result<Vec<Shared>, Vec<String>> {
    let mut faults = Vec::new();
    let groups = group(&creature.layers, &mut faults);
    check_spinning(&creature.layers, &groups, &creature.executor, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let shared = |layers: Vec<usize>| Shared {
        plan: plan(creature, &groups, &layers),
        layers,
    };
    Ok(groups.iter().cloned().map(shared).collect())
}

/// The plan of a thread that belongs to no layer; `threads` are those of the layers.
pub fn own(name: &str, period: Span, priority: u8, policy: Policy, threads: usize) -> Plan {
    Plan {
        name: name.into(),
        period,
        phase: Span::ZERO,
        schedule: match policy {
            Policy::Fifo => Schedule::Fifo(priority),
            Policy::Deadline => reserve(period, threads + OWN),
        },
        cpu: None,
        wake: Wake::Sleep,
        overrun: Overrun::Skip,
        sealed: true,
    }
}

/// Layers by thread. Those of one group must agree on everything that belongs to the thread.
fn group(layers: &[Layer], faults: &mut Vec<String>) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, layer) in layers.iter().enumerate() {
        let home = groups
            .iter_mut()
            .find(|g| layer.group.is_some() && layers[g[0]].group == layer.group);
        let Some(home) = home else {
            groups.push(vec![index]);
            continue;
        };
        let first = &layers[home[0]];
        for (what, same) in [
            ("period", first.period == layer.period),
            ("phase", first.phase == layer.phase),
            ("priority", first.priority == layer.priority),
            ("cpu", first.cpu == layer.cpu),
            ("wake-up", first.wake == layer.wake),
            ("overrun policy", first.overrun == layer.overrun),
        ] {
            if !same {
                let group = layer.group.as_deref().unwrap_or_default();
                faults.push(format!(
                    "layers {:?} and {:?} of group {group:?} share a thread and must have the same {what}",
                    first.name, layer.name
                ));
            }
        }
        home.push(index);
    }
    groups
}

/// Sees to it that no processor spends more than the share on spinning. A thread that is not bound may run
/// anywhere, so it counts on every processor.
fn check_spinning(layers: &[Layer], groups: &[Vec<usize>], executor: &Executor, faults: &mut Vec<String>) {
    let spins: Vec<(&Layer, f64)> = groups
        .iter()
        .map(|g| (&layers[g[0]], spin_share(&layers[g[0]])))
        .collect();
    for (layer, share) in &spins {
        if *share == 0.0 {
            continue;
        }
        let met = |other: &Layer| other.cpu.is_none() || layer.cpu.is_none() || other.cpu == layer.cpu;
        let sum: f64 = spins.iter().filter(|(other, _)| met(other)).map(|(_, s)| s).sum();
        if sum > executor.spin_share_max {
            let place = layer
                .cpu
                .map_or("a processor".into(), |cpu| format!("processor {cpu}"));
            faults.push(format!(
                "layer {:?}: spinning before each beat would take {:.1} % of {place} ({:.1} % for this layer, \
                 every {}), more than spin_share_max allows ({:.1} %): spin for less, sleep, or raise the share",
                layer.name,
                sum * 100.0,
                share * 100.0,
                layer.period,
                executor.spin_share_max * 100.0
            ));
        }
    }
}

/// The share of a processor that a layer's thread spins away at most.
fn spin_share(layer: &Layer) -> f64 {
    match layer.wake {
        Wake::Sleep => 0.0,
        Wake::Spin(lead) => lead.0 as f64 / layer.period.0 as f64,
    }
}

fn plan(creature: &Creature, groups: &[Vec<usize>], layers: &[usize]) -> Plan {
    let first = &creature.layers[layers[0]];
    let schedule = match creature.executor.policy {
        Policy::Fifo => {
            let mut periods: Vec<Span> = creature.layers.iter().map(|l| l.period).collect();
            periods.sort();
            periods.dedup();
            Schedule::Fifo(first.priority.unwrap_or(rate_monotonic(&periods, first.period)))
        }
        Policy::Deadline => reserve(
            first.period,
            groups.len() + OWN * usize::from(creature.body.is_some()),
        ),
    };
    Plan {
        name: match (&first.group, layers.len()) {
            (Some(group), 2..) => group.clone(),
            _ => first.name.clone(),
        },
        period: first.period,
        phase: first.phase,
        schedule,
        cpu: first.cpu,
        wake: first.wake,
        overrun: first.overrun,
        sealed: true,
    }
}

/// An equal part of the period for each of `threads` threads.
fn reserve(period: Span, threads: usize) -> Schedule {
    let part = period.0 as f64 * RESERVED_MAX / threads.max(1) as f64;
    Schedule::Deadline {
        runtime: Span(part as u64).max(RUNTIME_MIN),
        period,
    }
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
