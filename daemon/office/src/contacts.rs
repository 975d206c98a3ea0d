//! What touched the robot, and whose doing it was.
//!
//! A contact is an event: it begins when the gap between rim and thing falls to a millimetre and
//! ends when the gap has opened to a centimetre, so that resting against something counts once.

use crate::discs::Disc;
use crate::robot::Robot;
use crate::space::Space;
use serde::Serialize;
use std::collections::VecDeque;
use std::sync::Arc;

/// How many of the latest contacts are kept: enough for a page, few enough to copy.
pub const CONTACTS_KEPT_MAX: usize = 64;
/// Speed of the robot toward the thing above which it caused the contact, m/s.
pub const CAUSED_ABOVE_M_S: f64 = 0.01;
/// Gap at which two things touch, m.
const TOUCH_M: f64 = 0.001;
/// Gap at which a contact has ended, m.
const PART_M: f64 = 0.01;

/// One contact between the robot and something else.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contact {
    /// When it began, s since the start.
    pub time_s: f64,
    /// What touched the robot.
    pub other: Arc<str>,
    /// The robot's own speed toward it at that moment, m/s; negative when it was backing away.
    pub approach_m_s: f64,
    /// Whether the robot caused it: an approach of more than [`CAUSED_ABOVE_M_S`].
    pub caused: bool,
}

/// All contacts since the start, counted, and the latest ones in full.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Contacts {
    /// Contacts of the robot with anything.
    pub all: u64,
    /// Those of them that the robot caused.
    pub caused: u64,
    /// The latest, oldest first, at most [`CONTACTS_KEPT_MAX`].
    pub recent: VecDeque<Contact>,
}

/// Watches the gaps around the robot from step to step.
pub(crate) struct Touch {
    pub(crate) contacts: Contacts,
    /// For every thing and then every disc: the last step in which it touched the robot.
    touched: Vec<u64>,
    /// Which disc it watches.
    own: usize,
    people_from: usize,
    step: u64,
}

impl Touch {
    pub(crate) fn new(own: usize, things: usize, discs_max: usize) -> Touch {
        let recent = VecDeque::with_capacity(CONTACTS_KEPT_MAX);
        Touch {
            contacts: Contacts {
                all: 0,
                caused: 0,
                recent,
            },
            touched: vec![0; things + discs_max],
            own,
            people_from: things,
            step: 1,
        }
    }

    /// Looks at everything near the robot once a step; `names` are those of the discs.
    pub(crate) fn look(
        &mut self,
        time_s: f64,
        robot: &Robot,
        space: &Space,
        discs: &[Disc],
        names: &[Arc<str>],
    ) {
        self.step += 1;
        let rim = discs[self.own];
        space.each_near(rim.at, rim.radius + PART_M, |near| {
            let approach = robot.approach(near.away * -1.0);
            let gap = near.distance - rim.radius;
            self.one(near.thing, gap, time_s, approach, || space.name(near.thing));
        });
        let own = self.own;
        for index in (0..discs.len()).filter(|&i| i != own) {
            let disc = &discs[index];
            let gap = rim.gap(disc);
            if gap <= PART_M {
                let approach = robot.approach((disc.at - rim.at).unit());
                self.one(self.people_from + index, gap, time_s, approach, || {
                    names[index].clone()
                });
            }
        }
    }

    fn one(&mut self, other: usize, gap: f64, time_s: f64, approach_m_s: f64, name: impl Fn() -> Arc<str>) {
        let goes_on = self.touched[other] + 1 >= self.step;
        if goes_on || gap <= TOUCH_M {
            self.touched[other] = self.step;
        }
        if goes_on || gap > TOUCH_M {
            return;
        }
        let caused = approach_m_s > CAUSED_ABOVE_M_S;
        self.contacts.all += 1;
        self.contacts.caused += u64::from(caused);
        if self.contacts.recent.len() == CONTACTS_KEPT_MAX {
            self.contacts.recent.pop_front();
        }
        self.contacts.recent.push_back(Contact {
            time_s,
            other: name(),
            approach_m_s,
            caused,
        });
    }
}
