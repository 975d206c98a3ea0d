//! The robot run by its hierarchy, beat by beat on the virtual clock.
//!
//! ```text
//! an MCU ended, or a priority interrupt ──► evaluate from the top ──► outputs ──► MCUs work ──► beat ──┐
//!        ▲                                                                                            │
//!        └────────────────────────────────────────────────────────────────────────────────────────────┘
//! ```

use serde::Serialize;

use super::geometry::Point;
use super::motor::Working;
use super::world::World;
use super::{BEAT_S, PROGRAM, vocabulary};
use crate::hierarchy::{Goal, Hierarchy, OUTPUTS_MAX, Output};
use crate::language::{Problems, Running};

/// A goal that moved by less than this is the same goal to an MCU at work, metres.
const SAME_GOAL_M: f64 = 0.02;

/// What a run has come to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measures {
    /// Time since the start, seconds.
    pub time_s: f64,
    /// Way of the middle of the robot, metres.
    pub path_m: f64,
    /// Fuel used, in tanks.
    pub tanks: f64,
    /// Fuel in the tank at its lowest.
    pub lowest_fuel: f64,
    /// Evaluations from the top.
    pub evaluations: u64,
    /// Times the robot ran into something.
    pub bumps: u32,
    /// Whether the tank ever ran dry.
    pub stranded: bool,
    /// Whether the wanted number lies at the site.
    pub complete: bool,
}

/// A robot in a world under the control of a hierarchy.
#[derive(Clone, Debug)]
pub struct Run {
    /// The world.
    pub world: World,
    /// The hierarchy, its program and the commands applied to it.
    pub control: Running,
    working: [Option<Working>; OUTPUTS_MAX],
    ended: bool,
    evaluated: bool,
    lowest_fuel: f64,
}

impl Run {
    /// The nest-building program in a world.
    ///
    /// # Panics
    /// Never: the program is part of the crate and tested.
    #[must_use]
    pub fn new(world: World) -> Self {
        Self::with_program(world, PROGRAM).expect("the nest-building program is right")
    }

    /// Another program in a world.
    ///
    /// # Errors
    /// Every problem in the program.
    pub fn with_program(mut world: World, program: &str) -> Result<Self, Problems> {
        let control = Running::load(program, vocabulary())?;
        world.look();
        world.interrupt = true;
        let lowest_fuel = world.robot.fuel;
        Ok(Self {
            world,
            control,
            working: [None; OUTPUTS_MAX],
            ended: true,
            evaluated: false,
            lowest_fuel,
        })
    }

    /// One beat: evaluates if an MCU ended or an interrupt is due, then lets the world go on. Tells whether
    /// there was an evaluation.
    pub fn beat(&mut self) -> bool {
        self.evaluated = self.ended || self.world.interrupt;
        if self.evaluated {
            self.world.interrupt = false;
            self.ended = false;
            self.control.hierarchy_mut().evaluate(&self.world);
            let hierarchy = self.control.hierarchy();
            self.working = called(&self.working, hierarchy.outputs(), self.world.now_s);
            self.world.note_search(hierarchy);
            self.world.plan();
        }
        let (control, ended) = (&mut self.control, &mut self.ended);
        self.world.beat(&mut self.working, |mcu, succeeded| {
            *ended = true;
            if !succeeded {
                control.hierarchy_mut().report_failure(mcu);
            }
        });
        self.ended |= self.working.iter().all(Option::is_none);
        self.lowest_fuel = self.lowest_fuel.min(self.world.robot.fuel);
        self.evaluated
    }

    /// Lets the world go on until something holds, for so many seconds at most; tells whether it held.
    pub fn until(&mut self, limit_s: f64, mut holds: impl FnMut(&Self) -> bool) -> bool {
        let end_s = self.world.now_s + limit_s;
        while self.world.now_s < end_s - BEAT_S / 2.0 {
            self.beat();
            if holds(self) {
                return true;
            }
        }
        false
    }

    /// Whether an RM was active in the latest evaluation.
    #[must_use]
    pub fn active(&self, rm: &str) -> bool {
        let hierarchy = self.control.hierarchy();
        hierarchy.find(rm).is_some_and(|found| hierarchy.active(found))
    }

    /// The goal of an active RM.
    #[must_use]
    pub fn goal(&self, rm: &str) -> Option<Goal> {
        let hierarchy = self.control.hierarchy();
        hierarchy.find(rm).and_then(|found| hierarchy.goal(found))
    }

    /// What the run has come to so far.
    #[must_use]
    pub fn measures(&self) -> Measures {
        Measures {
            time_s: self.world.now_s,
            path_m: self.world.way_m,
            tanks: self.world.burnt,
            lowest_fuel: self.lowest_fuel,
            evaluations: self.control.hierarchy().number(),
            bumps: self.world.bumps,
            stranded: self.world.stranded,
            complete: self.world.nest_complete(),
        }
    }
}

impl World {
    /// Tells the robot's search patterns which of them is being followed.
    pub(super) fn note_search(&mut self, hierarchy: &Hierarchy) {
        let (place, now_s) = (self.robot.place, self.now_s);
        let sweeps = &mut self.robot.sweeps;
        for sweep in [&mut sweeps.site, &mut sweeps.object, &mut sweeps.station] {
            let followed = hierarchy
                .active_path()
                .filter_map(|rm| hierarchy.goal(rm))
                .any(|goal| sweep.next(place) == Some(Point::new(goal.x_m, goal.y_m)));
            if followed {
                sweep.go(place, now_s);
            } else {
                sweep.pause(now_s);
            }
        }
    }
}

/// The chosen MCUs at work; one that worked on the same goal already goes on.
pub(super) fn called(
    before: &[Option<Working>; OUTPUTS_MAX],
    outputs: &[Output],
    now_s: f64,
) -> [Option<Working>; OUTPUTS_MAX] {
    let mut working = [None; OUTPUTS_MAX];
    for (slot, output) in working.iter_mut().zip(outputs) {
        let same = before.iter().flatten().find(|working| goes_on(working, output));
        *slot = Some(same.map_or(
            Working {
                mcu: output.mcu,
                goal: output.goal,
                since_s: now_s,
                driven_m: 0.0,
            },
            |working| *working,
        ));
    }
    working
}

fn goes_on(working: &Working, output: &Output) -> bool {
    let near = |one: f64, other: f64| (one - other).abs() <= SAME_GOAL_M;
    working.mcu == output.mcu
        && working.goal.thing == output.goal.thing
        && near(working.goal.x_m, output.goal.x_m)
        && near(working.goal.y_m, output.goal.y_m)
        && near(working.goal.value, output.goal.value)
}
