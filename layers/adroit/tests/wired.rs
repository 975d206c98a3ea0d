//! The nest builder with wires between body and hierarchy: what is sensed and what is set comes a beat late.

use adroit::hierarchy::Hierarchy;
use adroit::language::load;
use adroit::nest::{Layout, PROGRAM, Pilot, Sensed, Setpoints, World, generate, vocabulary};

/// A body and a pilot who hear each other a beat late.
struct Wired {
    world: World,
    pilot: Pilot,
    hierarchy: Hierarchy,
    sensed: Sensed,
    setpoints: Setpoints,
}

impl Wired {
    fn new(seed: u64, layout: Layout) -> Self {
        let world = generate(seed, layout);
        Self {
            pilot: Pilot::new(world.wanted),
            sensed: world.sensed(),
            world,
            hierarchy: load(PROGRAM, &vocabulary()).expect("the program is right"),
            setpoints: Setpoints::STILL,
        }
    }

    fn beat(&mut self) {
        self.world.live(Some(&self.setpoints));
        let late = std::mem::replace(&mut self.sensed, self.world.sensed());
        (self.setpoints, _) = self.pilot.step(&mut self.hierarchy, &late);
    }

    fn until_complete(&mut self, limit_s: f64) -> bool {
        while self.world.now_s < limit_s && !self.world.nest_complete() {
            self.beat();
        }
        self.world.nest_complete()
    }
}

#[test]
fn the_nest_is_built_over_wires_as_well() {
    let mut incomplete = Vec::new();
    let mut time_s = 0.0;
    for seed in 0..40 {
        let mut wired = Wired::new(seed, Layout::default());
        if !wired.until_complete(1800.0) {
            incomplete.push((seed, wired.world.robot.fuel, wired.hierarchy.active_path().map(|rm| wired.hierarchy.name(rm).to_owned()).collect::<Vec<_>>()));
        }
        time_s += wired.world.now_s / 40.0;
    }
    println!("{time_s:.0} s on average; incomplete: {incomplete:?}");
    assert!(incomplete.len() <= 2, "at least 95 %; incomplete: {incomplete:?}");
}

#[test]
fn without_setpoints_the_robot_stands_and_the_world_goes_on() {
    let mut world = generate(3, Layout::default());
    let before = world.sensed();
    for _ in 0..200 {
        world.live(None);
    }
    let after = world.sensed();
    assert_eq!((before.place, before.heading_rad), (after.place, after.heading_rad));
    assert_eq!((before.arm_m, before.steering_rad), (after.arm_m, after.steering_rad));
    assert!((after.now_s - 10.0).abs() < 1e-9);
}

#[test]
fn a_pilot_allocates_nothing_once_it_is_made() {
    for seed in [1, 4, 9] {
        let mut wired = Wired::new(seed, Layout::default());
        for _ in 0..6000 {
            wired.world.live(Some(&wired.setpoints));
            let sensed = wired.world.sensed();
            let Wired {
                pilot,
                hierarchy,
                setpoints,
                ..
            } = &mut wired;
            let counted = allocation_counter::measure(|| (*setpoints, _) = pilot.step(hierarchy, &sensed));
            assert_eq!(counted.count_total, 0, "seed {seed} at {} s", sensed.now_s);
        }
    }
}

#[test]
fn a_run_over_wires_is_repeatable_to_the_bit() {
    let end = |seed| {
        let mut wired = Wired::new(seed, Layout::default());
        wired.until_complete(300.0);
        wired.sensed
    };
    assert_eq!(end(7), end(7));
    assert_ne!(end(7), end(8));
}
