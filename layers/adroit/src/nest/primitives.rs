//! The primitives of the robot: everything a program may name, and what each answers.

use super::geometry::{Point, between_rad};
use super::motor::{HAND_M, Unit, on_course};
use super::robot::ARM_M;
use super::world::World;
use crate::hierarchy::{CriterionId, Goal, Senses, StateId, StimulusId};
use crate::language::Vocabulary;

/// Names of the primitive stimuli; the last two are cues that mean nothing to the program.
pub const STIMULI: [&str; 16] = [
    "cold",
    "ordered",
    "site-unknown",
    "holding",
    "hand-empty",
    "fuel-missing",
    "filling",
    "one-obstacle",
    "two-obstacles",
    "many-obstacles",
    "person-near",
    "plan-ready",
    "bumped",
    "object-in-view",
    "whistle",
    "red-light",
];

const CRITERIA: [&str; 13] = [
    "closest-object",
    "leftmost-object",
    "nest-spot",
    "closest-station",
    "look-out-for-site",
    "look-out-for-object",
    "look-out-for-station",
    "straight-course",
    "course-past-one",
    "course-past-two",
    "course-past-many",
    "planned-course",
    "back-off",
];

const STATES: [&str; 5] = [
    "nest-complete",
    "within-reach",
    "hand-at-goal",
    "wheel-on-course",
    "tank-full",
];

/// Fuel above which the tank counts as full.
const FULL: f64 = 0.99;
/// Within reach, the arm still has this much to spare, metres.
const SPARE_M: f64 = 0.05;

/// A person is near within this, metres.
const NEAR_M: f64 = 1.3;

/// The vocabulary of the robot.
#[must_use]
pub fn vocabulary() -> Vocabulary {
    Vocabulary::new(&STIMULI, &CRITERIA, &STATES, &Unit::ALL.map(Unit::name))
}

fn switch(on: bool) -> f64 {
    f64::from(u8::from(on))
}

fn place(goal: &Goal) -> Point {
    Point::new(goal.x_m, goal.y_m)
}

fn look_out(next: Option<Point>) -> Option<Goal> {
    next.map(|next| Goal::at(next.x_m, next.y_m))
}

impl World {
    /// Of some things in view, the one with the least of a measure.
    fn least(things: &[(u32, Point)], measure: impl Fn(Point) -> f64) -> Option<Goal> {
        let mut best: Option<(f64, Goal)> = None;
        for &(id, at) in things {
            let value = measure(at);
            if best.is_none_or(|(least, _)| value < least) {
                best = Some((value, Goal::object(id, at.x_m, at.y_m)));
            }
        }
        best.map(|(_, goal)| goal)
    }

    /// Where in the nest the next object goes: in a spiral, so that the pile can be seen to grow.
    fn nest_spot(&self) -> Option<Goal> {
        let site = self.known_site()?;
        let turn = self.robot.counted as f64;
        let spot = site.place.towards(turn * 2.4, (0.08 + 0.07 * turn).min(0.5));
        Some(Goal::object(site.id, spot.x_m, spot.y_m))
    }

    /// Someone is near enough to walk into a way that was planned without them.
    fn person_near(&self) -> bool {
        self.persons
            .iter()
            .any(|person| self.robot.place.distance_m(person.place) < NEAR_M)
    }
}

impl Senses for World {
    fn stimulus(&self, stimulus: StimulusId, given: &Goal) -> f64 {
        match STIMULI[usize::from(stimulus.0) - 1] {
            "cold" => switch(self.cold),
            "ordered" => switch(self.ordered()),
            "site-unknown" => switch(self.robot.site.is_none()),
            "holding" => switch(self.robot.held.is_some()),
            "hand-empty" => switch(self.robot.held.is_none()),
            "fuel-missing" => 1.0 - self.robot.fuel,
            "filling" => switch(self.robot.filling),
            "one-obstacle" => switch(self.faces(place(given)).count() == 1),
            "two-obstacles" => switch(self.faces(place(given)).count() == 2),
            "many-obstacles" => switch(self.faces(place(given)).count() > 2),
            "person-near" => switch(self.person_near()),
            "plan-ready" => {
                self.planner.want(place(given));
                switch(self.planning && self.planner.ready_for(place(given)))
            }
            "bumped" => switch(self.robot.bumped),
            "object-in-view" => switch(!self.seen.objects.is_empty()),
            "whistle" => switch(self.whistle),
            "red-light" => switch(self.red_light),
            unknown => unreachable!("no stimulus {unknown}"),
        }
    }

    fn select(&self, criterion: CriterionId, given: &Goal) -> Option<Goal> {
        let robot = &self.robot;
        match CRITERIA[usize::from(criterion.0)] {
            "closest-object" => Self::least(&self.seen.objects, |at| robot.place.distance_m(at)),
            "leftmost-object" => Self::least(&self.seen.objects, |at| {
                -between_rad(robot.heading_rad, robot.place.direction_rad(at))
            }),
            "nest-spot" => self.nest_spot(),
            "closest-station" => Self::least(&self.seen.stations, |at| robot.place.distance_m(at)),
            "look-out-for-site" => look_out(robot.sweeps.site.next(robot.place)),
            "look-out-for-object" => look_out(robot.sweeps.object.next(robot.place)),
            "look-out-for-station" => look_out(robot.sweeps.station.next(robot.place)),
            "straight-course" => Some(self.course(given, place(given))),
            "course-past-one" | "course-past-two" | "course-past-many" => self.pass(given),
            "planned-course" => {
                let next = self.planner.next(robot.place, &robot.map)?;
                let course = self.course(given, next);
                Some(course.with_value(course.value.min(robot.place.distance_m(next).max(0.05))))
            }
            "back-off" => Some(self.backward()),
            unknown => unreachable!("no goal criterion {unknown}"),
        }
    }

    fn holds(&self, state: StateId, goal: &Goal) -> bool {
        let at = place(goal);
        match STATES[usize::from(state.0)] {
            "nest-complete" => self.robot.site.is_some() && self.robot.counted >= self.wanted,
            "within-reach" => self.robot.place.distance_m(at) < ARM_M - SPARE_M,
            "hand-at-goal" => self.robot.hand().distance_m(at) <= HAND_M / 2.0,
            "wheel-on-course" => on_course(&self.robot, at),
            "tank-full" => self.robot.fuel >= FULL,
            unknown => unreachable!("no goal state {unknown}"),
        }
    }
}
