//! `mechanisms.drives`: a hierarchy of releasing mechanisms that gives level 1 headings.
//!
//! ```text
//!  Blind ──map and odometry──► Silent ⇄ Heading ⇄ Holding      as the hierarchy's motor control units say,
//!                                                               evaluated every `every`, at once on an interrupt
//! ```
//! What is wanted when stands in a program (`adroit/programs/drives.adroit`); this module brings it wires.

use adroit::drives::{Drives, Limits, RANGES, Said, Sensed};
use adroit::nest::Point;
use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use ipc::clock::{Span, Time};
use ipc::message::{Kind, Map, Pose, Pulse, SONARS};
use ipc::wiring::{Declaration, Parameter, Port};

use crate::desk::{self, Seat};
use crate::lamps::lamps;
use crate::programs::DRIVES;

const SONAR: In<Map> = In::at(0);
const ODOMETRY: In<Pose> = In::at(1);
const COMPASS: In<f64> = In::at(2);
const HEADING: Out<f64> = Out::at(0);
const HOLD: Out<Pulse> = Out::at(1);
const TIRED: Out<f64> = Out::at(2);
const ACTIVE: Out<Map> = Out::at(3);
const LISTENING: Out<Map> = Out::at(4);

const _: () = assert!(RANGES == SONARS, "a map is a ring");

/// The kind `mechanisms.drives`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(DrivesModule::new(s)),
};

static DECLARATION: Declaration = Declaration {
    name: "mechanisms.drives",
    about: "a hierarchy of releasing mechanisms above a level that follows headings: explore, rest, seek open space",
    diagram: "Blind --map and odometry--> Silent; every evaluation --> Heading, Holding or Silent",
    inputs: &[
        Port::new("sonar", Kind::Map, "what the ring heard, straight ahead first").unit("m"),
        Port::new("odometry", Kind::Pose, "where the wheels think they are"),
        Port::new("compass", Kind::Number, "which way the robot faces").unit("rad"),
    ],
    outputs: &[
        Port::new("heading", Kind::Number, "where to go, by the compass").unit("rad"),
        Port::new("hold", Kind::Pulse, "no wandering: the robot rests"),
        Port::new("tired", Kind::Number, "how tired the robot is").unit("1"),
        Port::new(
            "active",
            Kind::Map,
            "which RMs are in control, 48 to a word, from the top down",
        ),
        Port::new("listening", Kind::Map, "which RMs have their inputs open"),
    ],
    parameters: &[
        Parameter::span("every", Span::millis(250), "time between two evaluations"),
        Parameter::span(
            "stamina",
            Span::secs(90),
            "how long it drives until it is tired out",
        ),
        Parameter::span(
            "recovery",
            Span::secs(20),
            "how long it stands until it is recovered",
        ),
    ],
};

struct DrivesModule {
    seat: Seat,
    drives: Drives,
    limits: Limits,
    every: Span,
    next: Time,
    said: Option<Said>,
}

impl DrivesModule {
    fn new(settings: &Settings<'_>) -> DrivesModule {
        let limits = Limits {
            stamina_s: settings.span("stamina").seconds(),
            recovery_s: settings.span("recovery").seconds(),
        };
        DrivesModule {
            seat: desk::seat(&DRIVES),
            drives: Drives::new(limits),
            limits,
            every: settings.span("every"),
            next: Time::ZERO,
            said: None,
        }
    }

    fn say(&mut self, beat: &mut Beat<'_>, compass: f64) {
        let said = self.drives.decide(&mut self.seat.hierarchy);
        if let Some(bearing_rad) = said.bearing_rad {
            beat.emit(HEADING, compass + bearing_rad);
        }
        if said.hold {
            beat.emit(HOLD, Pulse);
        }
        let hierarchy = &self.seat.hierarchy;
        beat.emit(TIRED, self.drives.situation().tired());
        beat.emit(ACTIVE, lamps(hierarchy, |rm| hierarchy.active(rm)));
        beat.emit(LISTENING, lamps(hierarchy, |rm| hierarchy.listens(rm)));
        self.said = Some(said);
    }
}

impl Module for DrivesModule {
    fn step(&mut self, beat: &mut Beat<'_>) {
        self.seat.take_up();
        let (Some(map), Some(pose), Some(compass)) =
            (beat.latest(SONAR), beat.latest(ODOMETRY), beat.latest(COMPASS))
        else {
            return;
        };
        let now = beat.now();
        let interrupt = self.drives.sense(&Sensed {
            now_s: now.since(Time::ZERO).seconds(),
            place: Point::new(pose.x, pose.y),
            heading_rad: pose.heading,
            ranges_m: map.ranges,
        });
        if interrupt || now >= self.next {
            self.say(beat, compass);
            self.next = now + self.every;
        }
    }

    fn reset(&mut self) {
        self.seat.hierarchy.forget();
        self.drives = Drives::new(self.limits);
        self.next = Time::ZERO;
        self.said = None;
    }

    fn state(&self) -> &'static str {
        match self.said {
            None => "blind",
            Some(Said { hold: true, .. }) => "holding",
            Some(Said {
                bearing_rad: Some(_), ..
            }) => "heading",
            Some(_) => "silent",
        }
    }
}
