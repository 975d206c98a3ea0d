//! `allen.stereo`: the free-space finder: the longest way ahead that is wide enough for the robot.
//!
//! ```text
//!  Idle ──look──► Looking ──fan, `pictures` of them / path, if one is long enough──► Idle
//! ```
//! The fan is twelve free distances over sixty degrees, the leftmost strip first. Of several pictures the
//! nearest distance of each strip counts: a pane that was seen once is there. For each strip the way in its
//! direction is as long as nothing narrows it to less than the robot's width and some more.
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::message::{Kind, Map, Polar, Pulse, SONARS};
use ipc::wiring::{Declaration, Parameter, Port};

const LOOK: In<Pulse> = In::at(0);
const FAN: In<Map> = In::at(1);
const PATH: Out<Polar> = Out::at(0);

/// Strips of the fan.
const STRIPS: usize = SONARS;
/// Width of the fan, radians: sixty degrees.
const FAN_RAD: f64 = core::f64::consts::PI / 3.0;

/// The kind `allen.stereo`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Stereo::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "allen.stereo",
    about: "finds the longest free way ahead that is wide enough, from pictures of free distances",
    diagram: "Idle --look--> Looking --enough pictures/path, if long enough--> Idle",
    inputs: &[
        Port::new("look", Kind::Pulse, "look now"),
        Port::new("fan", Kind::Map, "free distances, leftmost strip first")
            .unit("m")
            .between(0.0, 100.0),
    ],
    outputs: &[Port::new(
        "path",
        Kind::Polar,
        "how far, m, and which way, in the robot's frame",
    )],
    parameters: &[
        Parameter::number("pictures", 3.0, "how many pictures make a look")
            .between(0.0, 100.0)
            .unit("1"),
        Parameter::number("half_width", 0.48, "what must be free on either side of a way")
            .between(0.0, 100.0)
            .unit("m"),
        Parameter::number("short", 0.8, "how far before what ends a way to stop")
            .between(0.0, 100.0)
            .unit("m"),
        Parameter::number("least", 1.5, "ways shorter than this lead nowhere")
            .between(0.0, 100.0)
            .unit("m"),
        Parameter::number("most", 6.0, "farther than this stereo is not to be trusted")
            .between(0.0, 100.0)
            .unit("m"),
    ],
};

#[derive(Clone, Copy)]
enum State {
    Idle,
    Looking { seen: u32, nearest: [f64; STRIPS] },
}

struct Stereo {
    state: State,
    pictures: u32,
    half_width: f64,
    short: f64,
    least: f64,
    most: f64,
}

impl Stereo {
    fn new(settings: &Settings<'_>) -> Stereo {
        Stereo {
            state: State::Idle,
            pictures: settings.number("pictures") as u32,
            half_width: settings.number("half_width"),
            short: settings.number("short"),
            least: settings.number("least"),
            most: settings.number("most"),
        }
    }

    /// The longest way, if there is one long enough; of equal ones the one nearest to straight ahead.
    fn longest(&self, fan: &[f64; STRIPS]) -> Option<Polar> {
        let mut best: Option<Polar> = None;
        for strip in 0..STRIPS {
            // From the middle outwards.
            let strip = if strip % 2 == 0 {
                STRIPS / 2 + strip / 2
            } else {
                STRIPS / 2 - 1 - strip / 2
            };
            let length = (free_way(fan, strip, self.half_width) - self.short).min(self.most);
            if length >= self.least && best.is_none_or(|b| length > b.length + 0.05) {
                best = Some(Polar {
                    length,
                    bearing: strip_bearing(strip),
                });
            }
        }
        best
    }
}

/// Bearing of a strip's middle, radians counter-clockwise.
fn strip_bearing(strip: usize) -> f64 {
    FAN_RAD / 2.0 - FAN_RAD * (strip as f64 + 0.5) / STRIPS as f64
}

/// How far the way along `strip` is free over `half_width` on either side, metres.
fn free_way(fan: &[f64; STRIPS], strip: usize, half_width: f64) -> f64 {
    let along = strip_bearing(strip);
    let mut free = fan[strip];
    for (other, &distance) in fan.iter().enumerate() {
        let off = strip_bearing(other) - along;
        let (ahead, aside) = (distance * libm::cos(off), distance * libm::sin(off));
        if aside.abs() < half_width {
            free = free.min(ahead);
        }
    }
    free
}

impl Module for Stereo {
    fn step(&mut self, beat: &mut Beat<'_>) {
        if beat.arrived(LOOK).is_some() {
            self.state = State::Looking {
                seen: 0,
                nearest: [f64::INFINITY; STRIPS],
            };
            return;
        }
        let State::Looking { seen, mut nearest } = self.state else {
            return;
        };
        let Some(fan) = beat.arrived(FAN) else { return };
        for (kept, new) in nearest.iter_mut().zip(fan.ranges) {
            *kept = kept.min(new);
        }
        let seen = seen + 1;
        if seen < self.pictures {
            self.state = State::Looking { seen, nearest };
            return;
        }
        self.state = State::Idle;
        if let Some(path) = self.longest(&nearest) {
            beat.emit(PATH, path);
        }
    }

    fn reset(&mut self) {
        self.state = State::Idle;
    }

    fn state(&self) -> &'static str {
        match self.state {
            State::Idle => "idle",
            State::Looking { .. } => "looking",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_narrower_than_the_robot_is_no_way() {
        let mut fan = [2.0; STRIPS];
        fan[6] = 8.0;
        assert!(free_way(&fan, 6, 0.48) < 2.1, "{}", free_way(&fan, 6, 0.48));
        // Fifteen degrees either side of it at two metres are 0.54 m.
        fan[3..=9].fill(8.0);
        assert!(free_way(&fan, 6, 0.48) > 7.0, "{}", free_way(&fan, 6, 0.48));
    }
}
