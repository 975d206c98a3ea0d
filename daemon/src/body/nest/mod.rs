//! `nest`: the robot of Friedman 1969 with its eyes, arm, hand and tank, in the world of the `adroit` crate.
//!
//! Must never know the hierarchy: it obeys setpoints and tells what is sensed.

mod declaration;

use adroit::nest::{
    BEAT_S, FLOOR_X_M, FLOOR_Y_M, Layout, Scene, Sensed, Setpoints, TOLD_MAX, Told, World as Floor,
    view as seen,
};
use ipc::clock::{Span, Time};
use ipc::message::{Map, Payload, Polar, Pose};
use ipc::wiring::Setting;
use serde_json::{Value, json};

use self::declaration::{DECLARATION, HAND, REACH, STEER, WHEEL};
use super::{BodyKind, Place, World, WorldEnd};
use crate::gate::Causes;

/// The kind `nest`.
pub static KIND: BodyKind = BodyKind {
    declaration: &DECLARATION,
    motion: &[WHEEL, STEER, REACH, HAND],
    forward: Some(WHEEL),
    stale: Span::millis(250),
    build,
};

/// One beat of the world.
const BEAT: Span = Span((BEAT_S * 1e9) as u64);
/// Most beats that are made up for; after a longer gap the world goes on from where it was.
const GAP_BEATS_MAX: u32 = 20;

/// The robot's body and the floor it works on.
pub struct NestWorld {
    /// The simulation.
    pub floor: Floor,
    lived: Option<Time>,
}

fn build(settings: &[Setting], _seed: u64, _start: Option<Place>) -> Box<dyn World> {
    let [
        Setting::Text(scene),
        Setting::Number(number),
        Setting::Number(objects),
        Setting::Number(wanted),
        Setting::Number(persons),
        Setting::Bit(site),
        Setting::Bit(cold),
    ] = settings
    else {
        panic!("settings of the nest builder are checked");
    };
    let layout = Layout {
        objects: *objects as usize,
        wanted: *wanted as usize,
        site: *site,
        persons: *persons as usize,
        ..Layout::default()
    };
    let scene = Scene::named(scene).expect("the checker knows the scenes");
    let mut floor = scene.world(*number as u64, layout);
    floor.cold = *cold;
    Box::new(NestWorld { floor, lived: None })
}

/// Four things as one message.
fn packed(things: &[Told]) -> Map {
    let mut ranges = [0.0; 3 * TOLD_MAX];
    for (words, told) in ranges.chunks_exact_mut(3).zip(things) {
        words.copy_from_slice(&[f64::from(told.number), told.place.x_m, told.place.y_m]);
    }
    Map { ranges }
}

/// Says what is sensed, the pose last: whoever hears it has all the rest.
fn tell(link: &mut WorldEnd, now: Time, sensed: &Sensed) {
    let mut say = |index: usize, words| link.tell(index, now, &words);
    say(1, sensed.steering_rad.pack());
    say(2, sensed.rolled_m.pack());
    let arm = Polar {
        length: sensed.arm_m,
        bearing: sensed.arm_rad,
    };
    say(3, arm.pack());
    say(4, f64::from(sensed.held).pack());
    say(5, sensed.fuel.pack());
    let cues = [
        sensed.filling,
        sensed.bumped,
        sensed.cold,
        sensed.ordered,
        sensed.whistle,
        sensed.red_light,
    ];
    for (index, cue) in (6..).zip(cues) {
        say(index, cue.pack());
    }
    say(12, packed(&sensed.objects).pack());
    say(13, packed(&sensed.stations).pack());
    say(14, packed(&sensed.persons).pack());
    let mut site = packed(&[sensed.site]);
    site.ranges[3] = f64::from(sensed.lying);
    say(15, site.pack());
    for (index, some) in (16..).zip(sensed.obstacles.chunks_exact(TOLD_MAX)) {
        say(index, packed(some).pack());
    }
    let pose = Pose {
        x: sensed.place.x_m,
        y: sensed.place.y_m,
        heading: sensed.heading_rad,
    };
    say(0, pose.pack());
}

impl World for NestWorld {
    fn tick(&mut self, now: Time, link: &mut WorldEnd) {
        let reach = link.motion(REACH);
        let setpoints = Setpoints {
            wheel_m_s: link.motion(WHEEL)[0],
            steering_rad: link.motion(STEER)[0],
            arm_rad: reach[1],
            arm_m: reach[0],
            hold: link.motion(HAND)[0] as u32,
        };
        // Whoever halts it says zero on every input. For a wheel that is to stop, for an arm it is a place to go to,
        // and for a hand to let go: an arm of no length, which nobody can want, means to stay as it is.
        let told = link.causes() == Causes::NONE && setpoints.arm_m > 0.0;
        let obeyed = told.then_some(&setpoints);
        let mut lived = self.lived.unwrap_or(now);
        let mut beats = 0;
        while now.since(lived) >= BEAT && beats < GAP_BEATS_MAX {
            self.floor.live(obeyed);
            lived = lived + BEAT;
            beats += 1;
        }
        if beats == GAP_BEATS_MAX {
            lived = now;
        }
        if beats > 0 || self.lived.is_none() {
            tell(link, now, &self.floor.sensed());
        }
        self.lived = Some(lived);
    }

    fn floor(&self) -> Value {
        json!({ "size_m": [FLOOR_X_M, FLOOR_Y_M] })
    }

    fn view(&self) -> Value {
        let robot = &self.floor.robot;
        json!({
            "robot": { "x": robot.place.x_m, "y": robot.place.y_m, "heading": robot.heading_rad },
            "nest": seen(&self.floor),
        })
    }
}
