//! The people in the office: where each of them wants to go next.
//!
//! ```text
//! walker:    1 Stand ──time──► 2 Go ──arrived, or no headway──► 1
//! attacker:  3 Chase ──close──► 4 Pester ──time──► 2 Go (away) ──arrived──► 1 Stand ──time──► 3
//!            4 ──robot got away──► 3        3 ──no headway──► 2
//! cornerer:  as an attacker, but 3 goes to where the robot has the nearest wall behind it, and 4 lasts
//! talker:    6 Join, in step with two others: three with one goal, each at an own side of it
//!            6 ──no headway──► 2 ──arrived, or no headway──► 1 ──time──► 6
//! scripted:  5 Straight, for ever
//! ```
//!
//! People decide; they never end inside a wall, each other or the robot, because `discs.rs` settles
//! their moves like everybody's. A person who does touch the robot walked into it.

use crate::config::PERSON_RADIUS_M;
use crate::discs::{Disc, settled};
use crate::noise::Noise;
use crate::plane::Vec2;
use crate::space::Space;
use crate::view::PersonKind;
use crate::ways::Ways;

mod begin;
mod manners;

pub(crate) use begin::starting_place;
pub(crate) use manners::GROUP;
use manners::{
    ACCELERATION_M_S2, APPROACH_RADIUS_M, ASIDE_M, ATTACK_PACE_M_S, AWAY_S, BALKED_S, CARELESS, CORNER_M,
    CORNER_OFF_M, CORNER_S, CORNERED_M, FOLLOW_M, GROUP_RADIUS_M, GROUP_S, HEADWAY, LOOK_S, PACE_M_S,
    PESTER_S, REACHED_M, STAND_OFF_M, STAND_S,
};

#[derive(Clone, Copy, Debug)]
enum Intent {
    Stand { until_s: f64 },
    Go { goal: usize, via: usize },
    Chase { look_s: f64, via: Option<usize> },
    Pester { until_s: f64 },
    Join { goal: usize, via: usize },
    Straight { velocity: Vec2 },
}

/// What a person can know of the office.
pub(crate) struct Surroundings<'a> {
    pub(crate) space: &'a Space,
    pub(crate) ways: &'a Ways,
    /// The robots first, then the people.
    pub(crate) discs: &'a [Disc],
    /// How many robots.
    pub(crate) robots: usize,
    pub(crate) time_s: f64,
    pub(crate) dt_s: f64,
}

pub(crate) struct Person {
    pub(crate) kind: PersonKind,
    pub(crate) heading: f64,
    /// This person's place in the row of discs.
    index: usize,
    /// The robot that this person has to do with.
    prey: usize,
    /// Number of this person's group, and place in it.
    group: (usize, usize),
    velocity: Vec2,
    pace: f64,
    stand_off: f64,
    careless: bool,
    intent: Intent,
    /// Where this person was when headway was last looked at, and when it will be again.
    mark: Vec2,
    mark_s: f64,
}

impl Person {
    /// A walker or an attacker, standing for a moment before the first way.
    pub(crate) fn new(
        kind: PersonKind,
        (index, prey): (usize, usize),
        group: (usize, usize),
        at: Vec2,
        noise: &mut Noise,
    ) -> Person {
        let pace = match kind {
            PersonKind::Walker | PersonKind::Talker => noise.between(PACE_M_S.0, PACE_M_S.1),
            _ => ATTACK_PACE_M_S,
        };
        Person {
            kind,
            heading: 0.0,
            index,
            prey,
            group,
            velocity: Vec2::default(),
            pace,
            stand_off: noise.between(STAND_OFF_M.0, STAND_OFF_M.1),
            careless: false,
            intent: Intent::Stand {
                until_s: noise.between(0.0, 5.0),
            },
            mark: at,
            mark_s: 0.0,
        }
    }

    /// Somebody who walks on a straight line at `velocity`, m/s, whatever is in the way.
    pub(crate) fn scripted(index: usize, at: Vec2, velocity: Vec2) -> Person {
        Person {
            kind: PersonKind::Scripted,
            heading: velocity.angle(),
            index,
            prey: 0,
            group: (0, 0),
            velocity,
            pace: velocity.length(),
            stand_off: 0.0,
            careless: true,
            intent: Intent::Straight { velocity },
            mark: at,
            mark_s: 0.0,
        }
    }

    /// One step: where this person ends, m.
    pub(crate) fn step(&mut self, around: &Surroundings<'_>, noise: &mut Noise) -> Vec2 {
        let at = around.discs[self.index].at;
        let direction = self.wish(at, around, noise);
        let wished = match self.intent {
            Intent::Straight { velocity } => velocity,
            _ => self.aside(direction, around) * self.pace,
        };
        let change = wished - self.velocity;
        let change_max = ACCELERATION_M_S2 * around.dt_s;
        let length = change.length();
        self.velocity = if length > change_max {
            self.velocity + change * (change_max / length)
        } else {
            wished
        };
        if self.velocity.length() == 0.0 {
            return at;
        }
        let now = settled(
            around.space,
            around.discs,
            self.index,
            at + self.velocity * around.dt_s,
        );
        let moved = now - at;
        if moved.length() > 0.2 * self.pace * around.dt_s {
            self.heading = moved.angle();
        }
        now
    }

    /// The direction this person would like to walk in: a unit vector, or zero to stand.
    fn wish(&mut self, at: Vec2, around: &Surroundings<'_>, noise: &mut Noise) -> Vec2 {
        let robot = around.discs[self.prey];
        let gap = robot.gap(&around.discs[self.index]);
        let headway = self.headway(at, around.time_s);
        match self.intent {
            Intent::Straight { velocity } => velocity.unit(),
            Intent::Stand { until_s } => {
                if around.time_s >= until_s {
                    match self.kind {
                        PersonKind::Attacker | PersonKind::Cornerer => self.chase(around.time_s, noise),
                        PersonKind::Talker => self.join(at, around),
                        _ => self.go(at, around, noise),
                    }
                }
                Vec2::default()
            }
            Intent::Go { goal, via } => {
                if !headway {
                    self.stand(around.time_s, BALKED_S, noise);
                    return Vec2::default();
                }
                let to = around.ways.place(via) - at;
                if to.length() > REACHED_M {
                    return to.unit();
                }
                if via == goal {
                    let stay = if matches!(self.kind, PersonKind::Attacker | PersonKind::Cornerer) {
                        AWAY_S
                    } else {
                        STAND_S
                    };
                    self.stand(around.time_s, stay, noise);
                } else {
                    self.intent = Intent::Go {
                        goal,
                        via: around.ways.next(via, goal),
                    };
                }
                to.unit()
            }
            Intent::Chase { look_s, via } => {
                if gap <= self.stand_off.max(0.001) {
                    let stay = if self.kind == PersonKind::Cornerer {
                        CORNER_S
                    } else {
                        PESTER_S
                    };
                    let until_s = around.time_s + noise.between(stay.0, stay.1);
                    self.intent = Intent::Pester { until_s };
                } else if !headway {
                    self.go(at, around, noise);
                } else if around.time_s >= look_s {
                    let via = self.look(at, robot.at, around);
                    self.intent = Intent::Chase {
                        look_s: around.time_s + LOOK_S,
                        via,
                    };
                }
                let aim = || {
                    if self.kind == PersonKind::Cornerer {
                        open_side(at, robot, around)
                    } else {
                        robot.at
                    }
                };
                (via.map_or_else(aim, |place| around.ways.place(place)) - at).unit()
            }
            Intent::Join { goal, via } => {
                if !headway {
                    // Gives way, as everybody does: two who would step on one point held whoever stood on it.
                    self.go(at, around, noise);
                    return Vec2::default();
                }
                if self.meeting(around).is_none_or(|meeting| meeting != goal) {
                    self.stand(around.time_s, BALKED_S, noise);
                    return Vec2::default();
                }
                let to = self.spot(around, via, goal) - at;
                if to.length() > REACHED_M {
                    return to.unit();
                }
                if via == goal {
                    // Talks until the group moves on.
                    self.mark_s = around.time_s + HEADWAY.0;
                    self.heading = (around.ways.place(goal) - at).angle();
                    return Vec2::default();
                }
                let via = around.ways.next(via, goal);
                self.intent = Intent::Join { goal, via };
                to.unit()
            }
            Intent::Pester { until_s } => {
                if around.time_s >= until_s {
                    self.go(at, around, noise);
                } else if gap > self.stand_off.max(0.0) + FOLLOW_M {
                    self.chase(around.time_s, noise);
                }
                self.heading = (robot.at - at).angle();
                Vec2::default()
            }
        }
    }

    /// False when this person has hardly moved since the last look.
    fn headway(&mut self, at: Vec2, time_s: f64) -> bool {
        let walks = matches!(
            self.intent,
            Intent::Go { .. } | Intent::Chase { .. } | Intent::Join { .. }
        );
        if !walks {
            (self.mark, self.mark_s) = (at, time_s + HEADWAY.0);
            return true;
        }
        if time_s < self.mark_s {
            return true;
        }
        let moved = (at - self.mark).length();
        (self.mark, self.mark_s) = (at, time_s + HEADWAY.0);
        moved >= HEADWAY.1
    }

    fn stand(&mut self, time_s: f64, how_long: (f64, f64), noise: &mut Noise) {
        self.intent = Intent::Stand {
            until_s: time_s + noise.between(how_long.0, how_long.1),
        };
    }

    fn chase(&mut self, time_s: f64, noise: &mut Noise) {
        let off = if self.kind == PersonKind::Cornerer {
            CORNER_OFF_M
        } else {
            STAND_OFF_M
        };
        self.stand_off = noise.between(off.0, off.1);
        self.intent = Intent::Chase {
            look_s: time_s,
            via: None,
        };
    }

    /// Sets out for a goal drawn at random; stands on where there is none.
    fn go(&mut self, at: Vec2, around: &Surroundings<'_>, noise: &mut Noise) {
        let goals = around.ways.goals();
        if goals.is_empty() {
            return self.stand(around.time_s, STAND_S, noise);
        }
        self.careless = noise.unit() < CARELESS;
        let goal = goals[noise.below(goals.len())];
        match around.ways.join(around.space, at, Some(goal)) {
            Some(via) => self.intent = Intent::Go { goal, via },
            None => self.stand(around.time_s, STAND_S, noise),
        }
    }

    /// Where this person's group meets now: all of it reckons the same.
    fn meeting(&self, around: &Surroundings<'_>) -> Option<usize> {
        let goals = around.ways.goals();
        let turn = (around.time_s / GROUP_S) as u64;
        let mixed = (turn * 31 + self.group.0 as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 33;
        (!goals.is_empty()).then(|| goals[mixed as usize % goals.len()])
    }

    /// Sets out for where the group meets.
    fn join(&mut self, at: Vec2, around: &Surroundings<'_>) {
        let Some(goal) = self.meeting(around) else { return };
        if let Some(via) = around.ways.join(around.space, at, Some(goal)) {
            self.intent = Intent::Join { goal, via };
            (self.mark, self.mark_s) = (at, around.time_s + HEADWAY.0);
        }
    }

    /// The point to walk to for way point `via`: at the goal each has an own side.
    fn spot(&self, around: &Surroundings<'_>, via: usize, goal: usize) -> Vec2 {
        let place = around.ways.place(via);
        if via != goal {
            return place;
        }
        let side = core::f64::consts::TAU * self.group.1 as f64 / GROUP as f64;
        let spot = place + Vec2::at_angle(side) * GROUP_RADIUS_M;
        if around.space.passable(place, spot, PERSON_RADIUS_M) {
            spot
        } else {
            place
        }
    }

    /// The way point by which an attacker gets at the robot; none when the way is straight.
    fn look(&self, at: Vec2, robot: Vec2, around: &Surroundings<'_>) -> Option<usize> {
        if around.space.passable(at, robot, APPROACH_RADIUS_M) {
            return None;
        }
        let near_robot = around.ways.join(around.space, robot, None)?;
        let via = around.ways.join(around.space, at, Some(near_robot))?;
        if (around.ways.place(via) - at).length() > REACHED_M {
            return Some(via);
        }
        (via != near_robot).then(|| around.ways.next(via, near_robot))
    }

    /// `direction` bent round whoever is in the way: those on the left are passed on the right, and
    /// those dead ahead too.
    fn aside(&self, direction: Vec2, around: &Surroundings<'_>) -> Vec2 {
        let me = &around.discs[self.index];
        let skip_robot = self.careless || matches!(self.intent, Intent::Chase { .. });
        let mut bent = direction;
        for (index, other) in around.discs.iter().enumerate() {
            let robot = index < around.robots;
            if index == self.index || (robot && skip_robot && me.gap(other) > 0.01) {
                continue;
            }
            let gap = me.gap(other);
            let to = (other.at - me.at).unit();
            let ahead = bent.dot(to);
            if gap > ASIDE_M || ahead <= 0.3 || (robot && matches!(self.intent, Intent::Chase { .. })) {
                continue;
            }
            let nearness = 1.0 - (gap / ASIDE_M).max(0.0);
            let on_the_right = direction.dot(to.left()) > 0.2;
            let way_round = if on_the_right { to.left() } else { to.left() * -1.0 };
            bent = bent - to * (ahead * nearness) + way_round * nearness;
        }
        if bent.length() > 1.0 { bent.unit() } else { bent }
    }
}

/// Where to stand so that the robot has a wall behind it: on the line from the nearest wall through it.
fn open_side(at: Vec2, robot: Disc, around: &Surroundings<'_>) -> Vec2 {
    let Some(near) = around.space.nearest(robot.at, CORNERED_M) else {
        return robot.at;
    };
    let side = robot.at + near.away * CORNER_M;
    // Once there, on to the robot.
    if (side - at).length() < REACHED_M || (at - robot.at).dot(near.away) > 0.8 * (at - robot.at).length() {
        robot.at
    } else {
        side
    }
}
