//! One trial: a creature, or two, in its world on the virtual clock, watched from outside.
//!
//! Must never do to the creature what its row does not say, nor look at it through anything but its wires, its
//! halt channel and its world.

use std::collections::BTreeSet;
use std::path::Path;

use afsm::Kinds;
use afsm::random::Random;
use daemon::body::office::{OfficeGuard, OfficeWorld};
use daemon::body::warehouse::WarehouseWorld;
use daemon::gate::Causes;
use daemon::machine::{Machine, kinds};
use daemon::virtual_run::{BEGIN, VirtualRun};
use ipc::clock::{Span, Time};
use ipc::message::{Payload, Polar};
use ipc::wire::{Page, Reader};
use ipc::wiring::{Source, check, directory::output_ports};
use office::Pose;

use crate::disturb;
use crate::figures::{Caused, Figures};
use crate::row::{Disturbance, Row};

/// How often the observer looks.
const LOOK: Span = Span::millis(100);
/// Side of the squares in which floor is counted, m.
const SQUARE_M: f64 = 0.5;
/// Moving: faster than this, m/s.
const MOVING_M_S: f64 = 0.02;
/// Stuck: so long within so far.
const STUCK: (Span, f64) = (Span::secs(30), 0.25);
/// A place counts as reached within this, m: `near` of pathplan, and what odometry may be off by.
const REACHED_M: f64 = 1.0;
/// Mean time that a killed layer lives, and that it is dead, s.
const LIFE_S: f64 = 90.0;
/// When a layer that is killed for good dies: it has spoken by then, and has hardly taken the robot anywhere.
const CUT_AFTER: Span = Span::secs(60);

/// Modules of Allen and of the disturbances.
pub fn all_kinds() -> Kinds {
    kinds().with([&disturb::NONSENSE, &disturb::CHATTER])
}

/// A robot on trial.
pub(crate) struct Robot {
    pub(crate) run: VirtualRun,
    index: usize,
    wires: Wires,
    watch: Watch,
    figures: Figures,
}

/// What the observer listens to, where there is such a wire.
struct Wires {
    path: Option<Reader>,
    start: Option<Reader>,
    reached: Option<Reader>,
}

/// What the observer remembers from look to look.
struct Watch {
    begin: Pose,
    before: Pose,
    halted: bool,
    squares: BTreeSet<(i32, i32)>,
    rooms: BTreeSet<usize>,
    anchor: (f64, f64),
    anchored: Span,
    touched: u64,
    started: u64,
    arrived: u64,
    place: Option<((f64, f64), Time)>,
}

/// Runs one trial of `row`, whose creature is `text`, with `seed` for `hours`: the figures of each robot. `stop` is
/// asked now and then and ends it early, with nothing.
///
/// # Panics
/// With the checker's findings, when the text is not a creature.
pub fn run_text(
    row: &Row,
    text: &str,
    seed: u64,
    hours: f64,
    stop: &dyn Fn() -> bool,
) -> Option<Vec<Figures>> {
    let mut robots = robots(row, text, seed);
    let mut killer = Killer::new(row, seed);
    let looks = (hours * 3600.0 / LOOK.seconds()).round() as u64;
    for look in 0..looks {
        if look % 600 == 0 && stop() {
            return None;
        }
        if let Some(killer) = &mut killer {
            robots.iter_mut().for_each(|robot| killer.act(&mut robot.run));
        }
        advance(&mut robots);
        robots.iter_mut().for_each(Robot::look);
    }
    let finish = |robot: Robot| robot.finish(seed, hours);
    Some(robots.into_iter().map(finish).collect())
}

/// Lets [`LOOK`] pass for all robots. Those in one office take turns beat by beat: whoever ran ahead would let
/// the world go on under the orders that the other gave before.
pub(crate) fn advance(robots: &mut [Robot]) {
    let end = BEGIN + robots[0].run.elapsed() + LOOK;
    while let Some(next) = robots
        .iter()
        .filter_map(|r| r.run.next_beat())
        .min()
        .filter(|t| *t < end)
    {
        let after = Time(next.0 + 1);
        robots.iter_mut().for_each(|robot| robot.run.advance_to(after));
    }
    robots.iter_mut().for_each(|robot| robot.run.advance_to(end));
}

/// A creature's text; files that it names are found from where the program was started.
pub fn source(text: &str) -> Source {
    Source::of_file(Path::new("trial.toml"), text)
}

fn machine(text: &str) -> Machine {
    let kinds = all_kinds();
    let creature = check::creature(&source(text), &kinds);
    let creature = creature.unwrap_or_else(|rejected| panic!("{rejected}"));
    let page = Page::in_memory(output_ports(&creature).count());
    Machine::new(creature, &kinds, page, None)
}

pub(crate) fn robots(row: &Row, text: &str, seed: u64) -> Vec<Robot> {
    let mut first = machine(text);
    if row.robots == 1 {
        return vec![Robot::new(first, 0)];
    }
    // The second starts in another room: the first goal of the people's that is far from the first robot.
    let body = first.creature.body.clone().expect("the creature has a body");
    let far = far_place(&mut first).expect("an office is larger than four metres");
    let world = OfficeWorld::new(&body.settings, seed, None, &[(far.0, far.1, 0.0)]);
    let fellow = world.fellow(1);
    let mut second = machine(&text.replacen("creature = \"allen\"", "creature = \"fellow\"", 1));
    put(&mut first, world);
    put(&mut second, fellow);
    vec![Robot::new(first, 0), Robot::new(second, 1)]
}

/// The first goal of the people's that is far from the first robot, x and y in m.
fn far_place(first: &mut Machine) -> Option<(f64, f64)> {
    let begin = office_of(first).true_pose();
    let places = office_of(first).floor_plan().places;
    let far = places
        .iter()
        .find(|p| p.goal && (p.x - begin.x).hypot(p.y - begin.y) > 4.0);
    far.map(|p| (p.x, p.y))
}

/// Whether there is room for all robots of `row` in the office of `text`, which is a creature in one.
pub fn has_room(row: &Row, text: &str) -> bool {
    row.robots == 1 || far_place(&mut machine(text)).is_some()
}

fn put(machine: &mut Machine, world: OfficeWorld) {
    machine.body.as_mut().expect("the creature has a body").world = Box::new(world);
}

fn world_of(machine: &mut Machine) -> &mut OfficeWorld {
    let body = machine.body.as_mut().expect("the creature has a body");
    let world = body.world.as_any().downcast_mut::<OfficeWorld>();
    world.expect("the body is in an office")
}

pub(crate) fn warehouse_of(machine: &mut Machine) -> Option<&mut WarehouseWorld> {
    let body = machine.body.as_mut().expect("the creature has a body");
    body.world.as_any().downcast_mut::<WarehouseWorld>()
}

/// Where a robot truly is, and in which room.
fn seen(machine: &mut Machine, robot: usize) -> (Pose, Option<usize>) {
    if let Some(warehouse) = warehouse_of(machine) {
        let (x, y, heading) = warehouse.warehouse.report().pose;
        return (Pose { x, y, heading }, None);
    }
    let office = office_of(machine);
    let pose = office.true_pose_of(robot);
    let room = office.rooms().iter().position(|room| room.holds(pose.x, pose.y));
    (pose, room)
}

pub(crate) fn office_of(machine: &mut Machine) -> OfficeGuard<'_> {
    world_of(machine).office()
}

/// The wire called `name`, if the creature has one.
fn wire(machine: &Machine, name: &str) -> Option<Reader> {
    let ports = output_ports(&machine.creature).enumerate();
    let found = ports
        .map(|(i, (port, declared, _))| (i, port.to_string(), declared.kind))
        .find(|(_, port, _)| port == name);
    found.and_then(|(i, _, kind)| machine.page.reader(i, kind))
}

impl Robot {
    /// The wire called `name`, if the creature has one.
    pub(crate) fn wire(&self, name: &str) -> Option<Reader> {
        wire(&self.run.machine, name)
    }

    fn new(mut machine: Machine, index: usize) -> Robot {
        let (begin, _) = seen(&mut machine, index);
        let wires = Wires {
            path: wire(&machine, "stereo.path"),
            start: wire(&machine, "pathplan.start"),
            reached: wire(&machine, "pathplan.reached"),
        };
        Robot {
            run: VirtualRun::new(machine),
            index,
            wires,
            watch: Watch {
                begin,
                before: begin,
                halted: false,
                squares: BTreeSet::new(),
                rooms: BTreeSet::new(),
                anchor: (begin.x, begin.y),
                anchored: Span::ZERO,
                touched: 0,
                started: 0,
                arrived: 0,
                place: None,
            },
            figures: Figures::default(),
        }
    }

    fn look(&mut self) {
        let (pose, room) = seen(&mut self.run.machine, self.index);
        let (watch, figures) = (&mut self.watch, &mut self.figures);
        let speed = (pose.x - watch.before.x).hypot(pose.y - watch.before.y) / LOOK.seconds();
        let halted = self.run.machine.halt.decided().0.has(Causes::REFLEX);
        if halted && !watch.halted && speed > MOVING_M_S {
            figures.halts += 1.0;
        }
        watch.halted = halted;
        watch.before = pose;
        let square = |m: f64| (m / SQUARE_M).floor() as i32;
        watch.squares.insert((square(pose.x), square(pose.y)));
        watch.rooms.extend(room);
        let from_begin = (pose.x - watch.begin.x).hypot(pose.y - watch.begin.y);
        figures.drift_m = figures.drift_m.max(from_begin);
        if (pose.x - watch.anchor.0).hypot(pose.y - watch.anchor.1) > STUCK.1 {
            watch.anchor = (pose.x, pose.y);
            watch.anchored = Span::ZERO;
        } else {
            watch.anchored = Span(watch.anchored.0 + LOOK.0);
            if watch.anchored >= STUCK.0 {
                figures.stuck_s += LOOK.seconds();
            }
        }
        self.look_at_places(pose);
        self.look_at_contacts(pose);
    }

    /// Notes the contacts since the last look that are the robot's doing; the office remembers the latest ones, the
    /// warehouse the latest.
    fn look_at_contacts(&mut self, pose: Pose) {
        if let Some(world) = warehouse_of(&mut self.run.machine) {
            let report = world.warehouse.report();
            let new = report.caused > std::mem::replace(&mut self.watch.touched, report.caused);
            self.figures
                .caused_with
                .extend(report.latest.filter(|_| new).map(|c| {
                    Caused {
                        robot: 1,
                        time_s: c.time_s,
                        other: c
                            .person
                            .map_or("the floor".into(), |n| format!("person {}", n + 1)),
                        approach_m_s: c.approach_m_s,
                        at: (pose.x, pose.y),
                    }
                }));
            return;
        }
        let index = self.index;
        let office = office_of(&mut self.run.machine);
        let contacts = office.contacts_of(index);
        let new = (contacts.all - self.watch.touched) as usize;
        self.watch.touched = contacts.all;
        let caused = contacts.recent.iter().rev().take(new).rev().filter(|c| c.caused);
        self.figures.caused_with.extend(caused.map(|c| Caused {
            robot: index + 1,
            time_s: c.time_s,
            other: c.other.to_string(),
            approach_m_s: c.approach_m_s,
            at: (pose.x, pose.y),
        }));
    }

    /// Whether a place was chosen or reached since the last look.
    fn look_at_places(&mut self, pose: Pose) {
        let (watch, figures) = (&mut self.watch, &mut self.figures);
        let wire = |reader: &Option<Reader>, seen: u64| reader.as_ref().and_then(|r| r.newer_than(seen));
        if let Some(start) = wire(&self.wires.start, watch.started) {
            watch.started = start.number;
            figures.chosen += 1.0;
            let path = self.wires.path.as_ref().and_then(Reader::read);
            let path = path.map_or(Polar::default(), |reading| Polar::unpack(&reading.words));
            let way = pose.heading + path.bearing;
            let place = (pose.x + path.length * way.cos(), pose.y + path.length * way.sin());
            watch.place = Some((place, start.stamp));
        }
        if let Some(reached) = wire(&self.wires.reached, watch.arrived) {
            watch.arrived = reached.number;
            let Some((place, since)) = watch.place.take() else {
                return;
            };
            if (pose.x - place.0).hypot(pose.y - place.1) <= REACHED_M {
                figures.reached += 1.0;
                figures.reaching_s += reached.stamp.since(since).seconds();
            }
        }
    }

    fn finish(mut self, seed: u64, hours: f64) -> Figures {
        let mut figures = self.figures;
        // A place that is still being made for has been neither reached nor missed.
        let pursuing = self.run.machine.stations.iter();
        let pursuing = pursuing
            .filter_map(|s| s.running.state_of("pathplan"))
            .any(|s| s == "pursuing");
        if pursuing && self.watch.place.is_some() {
            figures.chosen -= 1.0;
        }
        figures.seed = seed;
        figures.hours = hours;
        figures.area_m2 = self.watch.squares.len() as f64 * SQUARE_M * SQUARE_M;
        figures.rooms = self.watch.rooms.len() as f64;
        for tap in &self.run.machine.taps {
            figures.refused += tap.gauge.counts().faults as f64;
        }
        if let Some(warehouse) = warehouse_of(&mut self.run.machine) {
            let report = warehouse.warehouse.report();
            (figures.caused, figures.contacts) = (report.caused as f64, report.contacts as f64);
            figures.distance_m = report.travelled_m;
            return figures;
        }
        let battery = world_of(&mut self.run.machine).battery();
        (figures.flat, figures.charges) = (battery.flat as f64, battery.charges as f64);
        let office = office_of(&mut self.run.machine);
        let contacts = office.contacts_of(self.index);
        figures.caused = contacts.caused as f64;
        figures.contacts = contacts.all as f64;
        figures.distance_m = office.distance_travelled_of_m(self.index);
        figures
    }
}

/// Kills level 2, once for all or to start it again and again.
pub(crate) struct Killer {
    random: Random,
    dead: bool,
    /// When to act next; never again with none.
    due: Option<Span>,
    restarts: bool,
}

impl Killer {
    pub(crate) fn new(row: &Row, seed: u64) -> Option<Killer> {
        let mut random = Random::new(seed ^ 0x4b11);
        let (due, restarts) = match row.disturbance {
            Disturbance::Killed => (life(&mut random), true),
            Disturbance::Cut => (CUT_AFTER, false),
            _ => return None,
        };
        Some(Killer {
            random,
            dead: false,
            due: Some(due),
            restarts,
        })
    }

    pub(crate) fn act(&mut self, run: &mut VirtualRun) {
        if self.due.is_none_or(|due| run.elapsed() < due) {
            return;
        }
        self.dead = !self.dead;
        self.due = self.restarts.then(|| run.elapsed() + life(&mut self.random));
        let stations = run.machine.stations.iter();
        let explore = stations
            .map(|s| s.spec.level)
            .position(|level| level == 2)
            .expect("the creature has a level 2");
        if self.dead {
            run.kill(explore);
        } else {
            run.restart(explore);
        }
    }
}

/// A time with mean [`LIFE_S`].
fn life(random: &mut Random) -> Span {
    let seconds = -LIFE_S * (1.0 - random.between(0.0, 1.0)).ln();
    Span::from_seconds(seconds).unwrap_or(Span::secs(LIFE_S as u64))
}
