//! `mechanisms.nest`: the nest-building hierarchy with its motor control units, between sensors and actuators.
//!
//! ```text
//!  Blind ──pose──► Acting: on every pose, setpoints := pilot(sensed)      evaluated when a unit ended or at once
//!    ▲               │ no new pose: nothing is said, and the body halts      on a priority interrupt
//!    └───────────────┘
//! ```
//! What is wanted when stands in a program (`adroit/programs/nest.adroit`); this module brings it wires.
//!
//! Must never plan: a search allocates. The sequential strategy of the program finds the way.

use adroit::nest::{OBSTACLES_TOLD_MAX, Pilot, Point, Sensed, TOLD_MAX, Told};
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::Time;
use ipc::message::{Kind, Map, Polar, Pose, SONARS};
use ipc::wiring::{Declaration, Parameter, Port};

use crate::desk::{self, Seat};
use crate::lamps::lamps;
use crate::programs::NEST;

const POSE: In<Pose> = In::at(0);
const STEERING: In<f64> = In::at(1);
const ROLLED: In<f64> = In::at(2);
const ARM: In<Polar> = In::at(3);
const HELD: In<f64> = In::at(4);
const FUEL: In<f64> = In::at(5);
/// Filling, bumped, cold, ordered, whistle, red light.
const CUES: [In<bool>; 6] = [In::at(6), In::at(7), In::at(8), In::at(9), In::at(10), In::at(11)];
const OBJECTS: In<Map> = In::at(12);
const STATIONS: In<Map> = In::at(13);
const PERSONS: In<Map> = In::at(14);
const SITE: In<Map> = In::at(15);
const OBSTACLES: [In<Map>; 3] = [In::at(16), In::at(17), In::at(18)];

const WHEEL: Out<f64> = Out::at(0);
const STEER: Out<f64> = Out::at(1);
const REACH: Out<Polar> = Out::at(2);
const HAND: Out<f64> = Out::at(3);
const ACTIVE: Out<Map> = Out::at(4);
const LISTENING: Out<Map> = Out::at(5);

const _: () = assert!(3 * TOLD_MAX == SONARS, "three numbers each fill a message");
const _: () = assert!(OBSTACLES.len() * TOLD_MAX == OBSTACLES_TOLD_MAX);

/// The kind `mechanisms.nest`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(NestModule::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "mechanisms.nest",
    about: "the nest-building hierarchy of releasing mechanisms, with its five motor control units",
    diagram: "Blind --pose--> Acting --every pose/setpoints := units of the hierarchy--> Acting --no pose--> Blind",
    inputs: &[
        Port::new("pose", Kind::Pose, "where the robot is"),
        Port::new("steering", Kind::Number, "steering wheel against straight ahead").unit("rad"),
        Port::new("rolled", Kind::Number, "way of the driven wheel since the start").unit("m"),
        Port::new("arm", Kind::Polar, "length and direction of the arm").unit("m"),
        Port::new(
            "held",
            Kind::Number,
            "number of the object in the hand, zero for none",
        ),
        Port::new("fuel", Kind::Number, "fuel in the tank").unit("1"),
        Port::new("filling", Kind::Bit, "fuel flows"),
        Port::new("bumped", Kind::Bit, "the body is against something"),
        Port::new("cold", Kind::Bit, "temperature is below the threshold"),
        Port::new("ordered", Kind::Bit, "an order to build is heard"),
        Port::new("whistle", Kind::Bit, "someone whistles"),
        Port::new("red_light", Kind::Bit, "a red light is on"),
        Port::new(
            "objects",
            Kind::Map,
            "objects in view: number, x, y of the four nearest",
        ),
        Port::new("stations", Kind::Map, "gas stations in view: number, x, y"),
        Port::new("persons", Kind::Map, "persons in view: number, x, y"),
        Port::new(
            "site",
            Kind::Map,
            "a nest site in view: number, x, y, how many objects lie there",
        ),
        Port::new(
            "obstacles",
            Kind::Map,
            "obstacles in view: radius in millimetres, x, y of the nearest",
        ),
        Port::new("obstacles_2", Kind::Map, "the next four obstacles"),
        Port::new("obstacles_3", Kind::Map, "four more"),
    ],
    outputs: &[
        Port::new("wheel", Kind::Number, "speed of the driven wheel").unit("m/s"),
        Port::new("steer", Kind::Number, "how the steering wheel shall stand").unit("rad"),
        Port::new(
            "reach",
            Kind::Polar,
            "how long the arm shall be, and its direction",
        )
        .unit("m"),
        Port::new(
            "hand",
            Kind::Number,
            "number of the object to hold, zero for none",
        ),
        Port::new(
            "active",
            Kind::Map,
            "which RMs are in control, 48 to a word, from the top down",
        ),
        Port::new("listening", Kind::Map, "which RMs have their inputs open"),
    ],
    parameters: &[Parameter::number("wanted", 6.0, "how many objects make a nest")
        .between(1.0, 100.0)
        .unit("1")],
};

struct NestModule {
    seat: Seat,
    pilot: Pilot,
    began: Option<Time>,
    acting: bool,
}

fn told(map: &Map) -> [Told; TOLD_MAX] {
    std::array::from_fn(|place| {
        let [number, x_m, y_m] = std::array::from_fn(|word| map.ranges[3 * place + word]);
        Told {
            number: number as u32,
            place: Point::new(x_m, y_m),
        }
    })
}

impl NestModule {
    fn new(settings: &Settings<'_>) -> NestModule {
        NestModule {
            seat: desk::seat(&NEST),
            pilot: Pilot::new(settings.number("wanted") as usize),
            began: None,
            acting: false,
        }
    }

    /// What the registers hold; none before every one of the body's own senses has spoken.
    fn sensed(&mut self, beat: &Beat<'_>) -> Option<Sensed> {
        let pose = beat.arrived(POSE)?;
        let began = *self.began.get_or_insert(beat.now());
        let arm = beat.latest(ARM)?;
        let [filling, bumped, cold, ordered, whistle, red_light] =
            CUES.map(|cue| beat.latest(cue).unwrap_or(false));
        let list = |port: In<Map>| {
            beat.latest(port)
                .map_or([Told::default(); TOLD_MAX], |map| told(&map))
        };
        let site = beat.latest(SITE);
        let mut obstacles = [Told::default(); OBSTACLES_TOLD_MAX];
        for (some, port) in obstacles.chunks_exact_mut(TOLD_MAX).zip(OBSTACLES) {
            some.copy_from_slice(&list(port));
        }
        Some(Sensed {
            now_s: beat.now().since(began).seconds(),
            place: Point::new(pose.x, pose.y),
            heading_rad: pose.heading,
            steering_rad: beat.latest(STEERING)?,
            rolled_m: beat.latest(ROLLED)?,
            arm_rad: arm.bearing,
            arm_m: arm.length,
            held: beat.latest(HELD)? as u32,
            fuel: beat.latest(FUEL)?,
            filling,
            bumped,
            cold,
            ordered,
            whistle,
            red_light,
            objects: list(OBJECTS),
            stations: list(STATIONS),
            persons: list(PERSONS),
            site: site.map_or(Told::default(), |map| told(&map)[0]),
            lying: site.map_or(0, |map| map.ranges[3] as u32),
            obstacles,
        })
    }
}

impl Module for NestModule {
    fn step(&mut self, beat: &mut Beat<'_>) {
        self.seat.take_up();
        let sensed = self.sensed(beat);
        self.acting = sensed.is_some();
        let Some(sensed) = sensed else { return };
        let hierarchy = &mut self.seat.hierarchy;
        let (setpoints, evaluated) = self.pilot.step(hierarchy, &sensed);
        beat.emit(WHEEL, setpoints.wheel_m_s);
        beat.emit(STEER, setpoints.steering_rad);
        beat.emit(
            REACH,
            Polar {
                length: setpoints.arm_m,
                bearing: setpoints.arm_rad,
            },
        );
        beat.emit(HAND, f64::from(setpoints.hold));
        if evaluated {
            beat.emit(ACTIVE, lamps(hierarchy, |rm| hierarchy.active(rm)));
            beat.emit(LISTENING, lamps(hierarchy, |rm| hierarchy.listens(rm)));
        }
    }

    fn reset(&mut self) {
        self.seat.hierarchy.forget();
        self.pilot.forget();
        self.began = None;
        self.acting = false;
    }

    fn state(&self) -> &'static str {
        if self.acting { "acting" } else { "blind" }
    }
}
