//! Nest building in many seeded worlds, on all cores, against a bound that no robot can beat.

use std::num::NonZero;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use serde::Serialize;

use crate::nest::{ARM_M, Layout, Measures, NEST_RADIUS_M, Run, SPEED_M_S, World, generate};

/// A run is given up after this long, seconds of virtual time.
pub const LIMIT_S: f64 = 2400.0;

/// The least a world demands: straight lines between objects and site with full knowledge, reach of the arm
/// taken off at both ends, no obstacles, no refuelling, no time but for driving at full speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// Path, metres.
    pub path_m: f64,
    /// Time, seconds.
    pub time_s: f64,
}

/// Bound of a world as it is now.
#[must_use]
pub fn bound(world: &World) -> Bound {
    let Some(site) = world.sites.iter().find(|site| site.proper) else {
        return Bound {
            path_m: 0.0,
            time_s: 0.0,
        };
    };
    let mut ways_m: Vec<f64> = world
        .objects
        .iter()
        .map(|object| (object.place.distance_m(site.place) - 2.0 * ARM_M - NEST_RADIUS_M).max(0.0))
        .collect();
    ways_m.sort_by(f64::total_cmp);
    let first_m = world
        .objects
        .iter()
        .map(|object| (object.place.distance_m(world.robot.place) - ARM_M).max(0.0))
        .fold(f64::INFINITY, f64::min);
    let there_m: f64 = ways_m.iter().take(world.wanted).sum();
    let back_m: f64 = ways_m.iter().take(world.wanted.saturating_sub(1)).sum();
    let path_m = first_m + there_m + back_m;
    Bound {
        path_m,
        time_s: path_m / SPEED_M_S,
    }
}

/// Figures of one way of running.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Worlds run.
    pub worlds: usize,
    /// Nests complete.
    pub complete: usize,
    /// Seeds of the worlds in which the nest was not completed.
    pub incomplete_seeds: Vec<u64>,
    /// Runs in which the tank ran dry.
    pub out_of_fuel: usize,
    /// Lowest fuel of all runs, in tanks.
    pub lowest_fuel: f64,
    /// Mean fuel used, in tanks.
    pub mean_tanks: f64,
    /// Mean path, metres.
    pub mean_path_m: f64,
    /// Mean time, seconds.
    pub mean_time_s: f64,
    /// Mean path against the bound.
    pub path_to_bound: f64,
    /// Mean time against the bound.
    pub time_to_bound: f64,
    /// Runs in which the robot ran into something.
    pub bumped: usize,
    /// Evaluations from the top, all runs.
    pub evaluations: u64,
}

/// Figures over the same worlds without and with planning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// First seed.
    pub first_seed: u64,
    /// The sequential strategy alone.
    pub sequential: Summary,
    /// With look-ahead.
    pub planned: Summary,
    /// Mean bound on the path, metres.
    pub bound_path_m: f64,
    /// Mean bound on the time, seconds.
    pub bound_time_s: f64,
    /// Of the worlds completed both ways: mean of planned path to sequential path.
    pub planned_to_sequential_path: f64,
    /// The same for time.
    pub planned_to_sequential_time: f64,
}

struct One {
    seed: u64,
    bound: Bound,
    sequential: Measures,
    planned: Measures,
}

fn one(seed: u64) -> One {
    let measured = |planning: bool| {
        let mut world = generate(seed, Layout::default());
        world.planning = planning;
        let mut run = Run::new(world);
        run.until(LIMIT_S, |run| run.world.nest_complete());
        run.measures()
    };
    let bound = bound(&generate(seed, Layout::default()));
    One {
        seed,
        bound,
        sequential: measured(false),
        planned: measured(true),
    }
}

/// Runs worlds of consecutive seeds on all cores; `done` is called after each, from any thread. The figures do
/// not depend on the number of cores.
#[must_use]
pub fn nests(first_seed: u64, worlds: usize, done: impl Fn() + Sync) -> Figures {
    let next = AtomicU64::new(0);
    let results: Mutex<Vec<One>> = Mutex::new(Vec::with_capacity(worlds));
    let count = worlds as u64;
    let threads = thread::available_parallelism()
        .map_or(1, NonZero::get)
        .min(worlds.max(1));
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    // Only hands out seeds; the results are published by the mutex.
                    let offset = next.fetch_add(1, Ordering::Relaxed);
                    if offset >= count {
                        return;
                    }
                    let result = one(first_seed + offset);
                    results
                        .lock()
                        .expect("no thread panics while it holds the results")
                        .push(result);
                    done();
                }
            });
        }
    });
    let mut all = results
        .into_inner()
        .expect("no thread panics while it holds the results");
    all.sort_by_key(|one| one.seed);
    summed(first_seed, &all)
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len();
    if count == 0 {
        0.0
    } else {
        values.sum::<f64>() / count as f64
    }
}

fn summed(first_seed: u64, all: &[One]) -> Figures {
    let summary = |of: fn(&One) -> &Measures| Summary {
        worlds: all.len(),
        complete: all.iter().filter(|one| of(one).complete).count(),
        incomplete_seeds: all
            .iter()
            .filter(|one| !of(one).complete)
            .map(|one| one.seed)
            .collect(),
        out_of_fuel: all.iter().filter(|one| of(one).stranded).count(),
        lowest_fuel: all.iter().map(|one| of(one).lowest_fuel).fold(1.0, f64::min),
        mean_tanks: mean(all.iter().map(|one| of(one).tanks)),
        mean_path_m: mean(all.iter().map(|one| of(one).path_m)),
        mean_time_s: mean(all.iter().map(|one| of(one).time_s)),
        path_to_bound: mean(all.iter().map(|one| of(one).path_m / one.bound.path_m)),
        time_to_bound: mean(all.iter().map(|one| of(one).time_s / one.bound.time_s)),
        bumped: all.iter().filter(|one| of(one).bumps > 0).count(),
        evaluations: all.iter().map(|one| of(one).evaluations).sum(),
    };
    let both: Vec<&One> = all
        .iter()
        .filter(|one| one.sequential.complete && one.planned.complete)
        .collect();
    Figures {
        first_seed,
        sequential: summary(|one| &one.sequential),
        planned: summary(|one| &one.planned),
        bound_path_m: mean(all.iter().map(|one| one.bound.path_m)),
        bound_time_s: mean(all.iter().map(|one| one.bound.time_s)),
        planned_to_sequential_path: mean(both.iter().map(|one| one.planned.path_m / one.sequential.path_m)),
        planned_to_sequential_time: mean(both.iter().map(|one| one.planned.time_s / one.sequential.time_s)),
    }
}
