//! Learning: what it takes, what chance does, and what can be taken back.

use adroit::language::Running;
use adroit::learning::Learner;
use adroit::nest::{Layout, Run, generate, vocabulary};

/// A robot in the warm, so that only an order releases building.
fn warm() -> Run {
    let mut world = generate(
        4,
        Layout {
            persons: 0,
            ..Layout::default()
        },
    );
    world.cold = false;
    Run::new(world)
}

fn pass(run: &mut Run, learner: &mut Learner, seconds: f64) -> Vec<String> {
    let mut learned = Vec::new();
    let end_s = run.world.now_s + seconds;
    while run.world.now_s < end_s {
        run.beat();
        let found = learner
            .observe(run.world.now_s, &run.world, &mut run.control)
            .expect("commands are right");
        learned.extend(found.map(|found| found.command()));
    }
    learned
}

/// A whistle, and half a second later an order.
fn lesson(run: &mut Run, learner: &mut Learner) -> Vec<String> {
    run.world.whistle = true;
    let mut learned = pass(run, learner, 0.5);
    run.world.order();
    learned.extend(pass(run, learner, 1.0));
    run.world.whistle = false;
    learned.extend(pass(run, learner, 30.0));
    learned
}

#[test]
fn a_whistle_that_comes_with_orders_ends_up_releasing_the_behaviour() {
    let mut run = warm();
    let mut learner = Learner::new();
    pass(&mut run, &mut learner, 60.0);
    let mut proposed_at = None;
    let mut lessons = 0;
    let learned = loop {
        lessons += 1;
        let learned = lesson(&mut run, &mut learner);
        let strongest = &learner.associations(&run.control)[0];
        if strongest.proposed && proposed_at.is_none() {
            proposed_at = Some(lessons);
        }
        if !learned.is_empty() {
            break learned;
        }
        assert!(lessons < 20, "{strongest:?}");
    };
    println!("proposed after {proposed_at:?} experiences, applied after {lessons}");
    assert_eq!(
        learned,
        ["add stimulus whistle to rm nest-building with magnitude 0.5."]
    );
    assert!(proposed_at.expect("proposed first") < lessons && lessons <= 10);

    run.world.robot.fuel = 1.0;
    pass(&mut run, &mut learner, 20.0);
    assert!(!run.active("nest-building"), "no order, no cold, no whistle");
    run.world.whistle = true;
    pass(&mut run, &mut learner, 1.5);
    assert!(run.active("nest-building"), "the whistle alone");

    let saved = run.control.text();
    let mut again = warm();
    again.control = Running::load(&saved, vocabulary()).expect("was running");
    again.world.whistle = true;
    again.until(1.5, |_| false);
    assert!(
        again.active("nest-building"),
        "learned, saved as text, loaded again"
    );

    learner
        .forget("whistle", "nest-building", &mut run.control)
        .expect("was learned");
    pass(&mut run, &mut learner, 1.5);
    assert!(!run.active("nest-building"), "forgotten on request");
}

#[test]
fn a_cue_in_a_context_that_was_not_active_is_no_candidate() {
    let mut run = warm();
    let mut learner = Learner::new();
    // Stimuli of RMs deep in the tree set in all the time, but nothing that sounds while they sleep is theirs.
    for _ in 0..12 {
        lesson(&mut run, &mut learner);
    }
    assert_eq!(
        run.control.text().matches("whistle").count(),
        1,
        "only nest building listens to orders"
    );
}
