//! Hierarchies of releasing mechanisms behind wires: level 2 on Allen comes and goes, and the nest builder builds
//! over wires in seeded worlds, allocating nothing in a beat.

use std::sync::Arc;

use daemon::body::nest::NestWorld;
use daemon::body::office::OfficeWorld;
use daemon::machine::kinds;
use daemon::virtual_run::{BEGIN, Manifest, Options, Stimulus, VirtualRun};
use ipc::clock::Span;
use ipc::wiring::creature::Creature;
use ipc::wiring::{Source, check};

fn creature(name: &str, text: &str) -> Creature {
    let checked = check::creature(&Source::new(name, text), &kinds());
    checked.unwrap_or_else(|rejected| panic!("{rejected}"))
}

fn office(run: &mut VirtualRun) -> (f64, u64) {
    let body = run.machine.body.as_mut().expect("the creature has a body");
    let world = body.world.as_any().downcast_mut::<OfficeWorld>();
    let office = world.expect("it is in an office").office();
    (office.distance_travelled_m(), office.contacts().caused)
}

#[test]
fn a_hierarchy_as_level_2_drives_allen_and_is_gone_without_a_trace() {
    let allen = creature("allen-01.toml", allen::CREATURE_01);
    let mut run = VirtualRun::with(allen, &kinds(), &Options::default());
    let drives = || Manifest {
        source: mechanisms::drives_manifest(),
        table: None,
    };
    let headings = |run: &VirtualRun| {
        let tap = run.tap("drives.heading", "avoid.goal");
        tap.map_or(0, |tap| tap.counts.delivered)
    };
    let mut before = 0;
    for _ in 0..3 {
        run.advance(Span::secs(5));
        let refused = run.moment(BEGIN + run.elapsed(), &[Stimulus::Plug(Arc::new(drives()))]);
        assert!(refused.is_empty(), "{:?}", refused[0].1);
        run.advance(Span::secs(200));
        let said = headings(&run);
        assert!(
            said > before + 100,
            "level 2 drove nowhere: {} headings",
            said - before
        );
        run.moment(BEGIN + run.elapsed(), &[Stimulus::Leave("drives".into())]);
        run.advance(Span::secs(2));
        before = headings(&run);
        let (gone_m, _) = office(&mut run);
        run.advance(Span::secs(100));
        assert_eq!(headings(&run), before, "nobody speaks for a layer that is gone");
        assert!(office(&mut run).0 > gone_m + 1.0, "levels 0 and 1 do not go on");
    }
    assert_eq!(
        office(&mut run).1,
        0,
        "whatever level 2 wants, level 0 hits nothing"
    );
}

fn nest(number: u32) -> VirtualRun {
    let text = mechanisms::NEST.replace("number = 3 ", &format!("number = {number} "));
    VirtualRun::with(creature("nest.toml", &text), &kinds(), &Options::default())
}

fn floor(run: &mut VirtualRun) -> &mut adroit::nest::World {
    let body = run.machine.body.as_mut().expect("the creature has a body");
    let world = body.world.as_any().downcast_mut::<NestWorld>();
    &mut world.expect("it is on the nest builder's floor").floor
}

#[test]
fn the_nest_is_built_by_a_layer_over_wires() {
    let mut complete = 0;
    let mut longest_s: f64 = 0.0;
    for number in 0..20 {
        let mut run = nest(number);
        while !floor(&mut run).nest_complete() && run.elapsed() < Span::secs(1800) {
            run.advance(Span::secs(5));
        }
        complete += u32::from(floor(&mut run).nest_complete());
        longest_s = longest_s.max(run.elapsed().seconds());
    }
    println!("{complete} of 20 complete, the last after {longest_s} s");
    assert!(complete >= 19, "{complete} of 20 nests");
}

#[test]
fn an_emergency_stop_freezes_the_nest_builder_arm_and_all() {
    let mut run = nest(3);
    run.advance(Span::secs(60));
    run.moment(BEGIN + run.elapsed(), &[Stimulus::Halt]);
    run.advance(Span::millis(200));
    let held = floor(&mut run).robot.clone();
    run.advance(Span::secs(5));
    let still = &floor(&mut run).robot;
    assert_eq!((held.place, held.heading_rad), (still.place, still.heading_rad));
    assert_eq!(
        (held.arm_m, held.arm_rad, held.steering_rad, held.held),
        (still.arm_m, still.arm_rad, still.steering_rad, still.held)
    );
    run.moment(BEGIN + run.elapsed(), &[Stimulus::Reset]);
    run.advance(Span::secs(20));
    assert_ne!(
        held.place,
        floor(&mut run).robot.place,
        "after the reset it goes on"
    );
}
