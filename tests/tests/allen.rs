//! Allen on trial (Brooks 1991 §6.2): what level 0 promises, what level 1 adds, and that both repeat to the bit.

use std::collections::BTreeSet;

use afsm::{Beat, Module, ModuleKind, Out};
use daemon::machine::kinds;
use ipc::message::{Kind, Polar};
use ipc::wiring::{Declaration, Port};
use tests::{Allen, Trial};

const HOUR_S: u64 = 3600;

#[test]
fn in_the_middle_of_an_empty_room_it_stays() {
    for seed in 1..=3 {
        let figures = Trial::new(Allen::ALONE.seeded(seed)).figures(HOUR_S);
        assert!(figures.drift_m < 0.5, "seed {seed}: {figures:?}");
    }
}

#[test]
fn approached_it_moves_away() {
    for seed in 1..=5 {
        let mut trial = Trial::new(Allen::ALONE.seeded(seed));
        trial.pass(2);
        let begin = trial.pose();
        // From the west, straight at the robot, slower than it can drive.
        trial.office().place_person(begin.x - 2.5, begin.y, 0.15, 0.0);
        trial.pass(20);
        let end = trial.pose();
        assert!(
            end.x > begin.x + 0.5,
            "seed {seed}: it went from {begin:?} to {end:?}"
        );
        assert_eq!(trial.office().contacts().caused, 0, "seed {seed}");
    }
}

#[test]
fn driven_at_a_wall_it_halts() {
    for seed in 1..=5 {
        let mut trial = Trial::of(&insisting(seed), &kinds().with([&INSIST]), None);
        trial.pass(2);
        let begin = trial.pose();
        trial.pass(60);
        let end = trial.pose();
        let clearance = trial.office().clearance_m();
        assert!(
            end.x > begin.x + 1.5,
            "seed {seed}: it drove from {begin:?} to {end:?}"
        );
        assert!(
            clearance > 0.05,
            "seed {seed}: it stopped {clearance} m from the wall"
        );
        assert_eq!(trial.office().contacts().all, 0, "seed {seed}");
    }
}

#[test]
fn an_hour_among_people_and_it_drives_into_nobody() {
    for seed in 1..=10 {
        let figures = Trial::new(Allen::LEVEL_0.seeded(seed)).figures(HOUR_S);
        assert_eq!(figures.contacts.caused, 0, "seed {seed}: {figures:?}");
        assert!(
            figures.travelled_m > 50.0,
            "seed {seed}: it ran from nobody: {figures:?}"
        );
    }
}

#[test]
fn with_level_1_it_wanders_and_drives_into_nobody() {
    let mut rooms = BTreeSet::new();
    for seed in 1..=10 {
        let figures = Trial::new(Allen::LEVEL_1.seeded(seed)).figures(HOUR_S);
        assert_eq!(figures.contacts.caused, 0, "seed {seed}: {figures:?}");
        assert!(figures.travelled_m > 100.0, "seed {seed}: {figures:?}");
        assert!(figures.headings >= 30, "seed {seed}: {figures:?}");
        rooms.extend(figures.rooms);
    }
    assert!(!rooms.is_empty(), "rooms: {rooms:?}");
}

#[test]
fn when_level_1_falls_silent_level_0_is_as_it_was() {
    // Level 1 beats once, at the very start, when there is no force yet to add to, and then not for an hour:
    // a layer that hangs.
    let hung = Allen::LEVEL_1
        .text()
        .replace("level = 1\nperiod = \"20ms\"", "level = 1\nperiod = \"5000s\"");
    assert_ne!(hung, Allen::LEVEL_1.text());
    let mut with = Trial::of(&hung, &kinds(), None);
    let mut without = Trial::new(Allen::LEVEL_0);
    for minute in 1..=20 {
        with.pass(60);
        without.pass(60);
        assert_eq!(with.pose(), without.pose(), "in minute {minute}");
    }
}

#[test]
fn one_seed_gives_one_run_whatever_the_order_of_modules() {
    let hash = |shift: usize| {
        let mut trial = Trial::new(Allen::LEVEL_1);
        for station in &mut trial.run().machine.stations {
            let mut order: Vec<usize> = (0..station.running.len()).collect();
            if shift > 0 {
                order.reverse();
                order.rotate_left(shift % station.running.len());
            }
            station.running.set_order(&order);
        }
        trial.pass_hashing(MINUTES_S);
        trial.hash()
    };
    let straight = hash(0);
    assert_eq!(straight, hash(0), "the same again");
    for shift in 1..=3 {
        assert_eq!(straight, hash(shift), "order {shift}");
    }
    let mut other = Trial::new(Allen::LEVEL_1.seeded(2));
    other.pass_hashing(MINUTES_S);
    assert_ne!(straight, other.hash(), "another seed, another run");
    assert_eq!(
        straight, GOLDEN,
        "all messages of five minutes hash to {straight:#018x}: if a module was meant to change, so must GOLDEN"
    );
}

/// Five minutes: some three hundred maps, thirty headings, a dozen encounters.
const MINUTES_S: u64 = 300;

/// The hash of all messages of levels 0 and 1, seed 1, in those minutes; debug and release builds agree on it.
const GOLDEN: u64 = 0x6d7e_430b_a7e2_4fb4;

/// A creature of level 0 with a layer above it that only ever says: straight ahead.
fn insisting(seed: u64) -> String {
    let layer = r#"
        [[layer]]
        name = "insist"
        level = 1
        period = "100ms"
        wires = []
        suppress = [{ from = "insist.heading", input = "turn.heading", time_constant = "2s" }]
        [layer.modules]
        insist = { kind = "test.insist" }
    "#;
    Allen::ALONE.seeded(seed).text() + layer
}

static INSIST: ModuleKind = ModuleKind {
    declaration: &Declaration {
        name: "test.insist",
        about: "says straight ahead, every beat",
        diagram: "Insisting --beat/heading := ahead--> Insisting",
        inputs: &[],
        outputs: &[Port::new("heading", Kind::Polar, "straight ahead")],
        parameters: &[],
    },
    build: |_| Box::new(Insist),
};

struct Insist;

impl Module for Insist {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let ahead = Polar {
            length: 9.0,
            bearing: 0.0,
        };
        beat.emit(Out::at(0), ahead);
    }

    fn reset(&mut self) {}

    fn state(&self) -> &'static str {
        "insisting"
    }
}
