//! The rules of the hierarchy, a scenario each.

mod stage;

use adroit::hierarchy::{Goal, Outcome, Yielded};
use stage::{Switches, evaluated, running, simple};

#[test]
fn largest_positive_output_wins() {
    let mut creature = running(&(simple("one", "a", 1.0, "m") + &simple("two", "b", 2.0, "n")));
    let mut senses = Switches::default();
    senses.set("a", 1.0).set("b", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["n"]);
    senses.set("b", 0.4);
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
}

#[test]
fn an_output_must_exceed_the_threshold() {
    let mut creature = running(&(simple("one", "a", 1.0, "m") + "threshold of rm one is 0.5."));
    let mut senses = Switches::default();
    senses.set("a", 0.5);
    assert_eq!(
        evaluated(&mut creature, &senses),
        ["r"],
        "equal to the threshold is not above it"
    );
    senses.set("a", 0.52);
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
}

#[test]
fn negative_inputs_inhibit() {
    let mut creature =
        running(&(simple("one", "a", 2.0, "m") + "add stimulus b to rm one with magnitude -1.5."));
    let mut senses = Switches::default();
    senses.set("a", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
    senses.set("a", 0.7).set("b", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["r"]);
}

#[test]
fn a_choice_without_goal_parameters_is_put_to_zero_and_the_next_is_tried() {
    let program = simple("one", "a", 3.0, "m") + "rm one selects goal p.\n" + &simple("two", "a", 2.0, "n");
    let mut creature = running(&program);
    let mut senses = Switches::default();
    senses.set("a", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["n"]);
    let one = creature.hierarchy().find("one").expect("declared");
    assert_eq!(creature.hierarchy().yielded(one), Some(Yielded::NoGoal));
    senses.goal("p", Some(Goal::object(7, 1.0, 2.0)));
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
    assert_eq!(creature.hierarchy().outputs()[0].goal.thing, 7);
}

const TOWER: &str = "rm building reports to top. add stimulus a to rm building with magnitude 5.
    rm seek reports to rm building. add stimulus a to rm seek with magnitude 1.
    rm sweep reports to rm seek. add stimulus b to rm sweep with magnitude 1. mcu m reports to rm sweep.
    rm refuel reports to top. add stimulus c to rm refuel with magnitude 1. mcu n reports to rm refuel.";

#[test]
fn failure_climbs_to_the_top_and_another_activity_is_taken() {
    let mut creature = running(TOWER);
    let mut senses = Switches::default();
    senses.set("a", 1.0).set("b", 1.0).set("c", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
    senses.set("b", 0.0);
    assert_eq!(
        evaluated(&mut creature, &senses),
        ["n"],
        "two levels of failure, then the next at the top"
    );
    for name in ["building", "seek"] {
        let rm = creature.hierarchy().find(name).expect("declared");
        assert_eq!(creature.hierarchy().yielded(rm), Some(Yielded::Below), "{name}");
    }
}

#[test]
fn the_top_always_finds_something() {
    let mut creature = running(TOWER);
    for bits in 0..8_u8 {
        let mut senses = Switches::default();
        for (bit, name) in ["a", "b", "c"].iter().enumerate() {
            senses.set(name, f64::from(bits >> bit & 1));
        }
        let evaluation = creature.hierarchy_mut().evaluate(&senses);
        assert_eq!(evaluation.outcome, Outcome::Acting);
        assert_eq!(creature.hierarchy().outputs().len(), 1);
    }
}

#[test]
fn a_program_whose_top_may_find_nothing_is_refused() {
    let refused = adroit::language::check(&simple("one", "a", 1.0, "m"), &stage::vocabulary());
    assert!(
        refused
            .expect_err("nothing to fall back on")
            .to_string()
            .contains("may find nothing to choose")
    );
}

#[test]
fn equal_outputs_that_do_not_conflict_both_run() {
    let mut creature = running(&(simple("one", "a", 1.0, "m") + &simple("two", "a", 1.0, "n")));
    let mut senses = Switches::default();
    senses.set("a", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["m", "n"]);
}

#[test]
fn equal_outputs_that_conflict_both_yield_to_a_displacement_activity() {
    let program = simple("fight", "a", 1.0, "m")
        + &simple("flee", "b", 1.0, "n")
        + "rm fight conflicts with rm flee.\n"
        + &simple("preen", "c", 0.5, "o");
    let mut creature = running(&program);
    let mut senses = Switches::default();
    senses.set("a", 1.0).set("b", 1.0).set("c", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["o"]);
    let fight = creature.hierarchy().find("fight").expect("declared");
    assert_eq!(creature.hierarchy().yielded(fight), Some(Yielded::Conflict));
    senses.set("a", 1.25);
    assert_eq!(
        evaluated(&mut creature, &senses),
        ["m"],
        "no tie, no displacement"
    );
}

#[test]
fn a_bystander_of_a_tie_is_not_suppressed() {
    let program = simple("one", "a", 1.0, "m")
        + &simple("two", "a", 1.0, "n")
        + &simple("three", "a", 1.0, "o")
        + "rm two conflicts with rm one.";
    let mut creature = running(&program);
    let mut senses = Switches::default();
    senses.set("a", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["o"]);
}

#[test]
fn one_mcu_serves_one_of_two_rms_active_side_by_side() {
    let program = simple("one", "a", 1.0, "m") + "rm one selects goal p. rm two selects goal q.\n";
    let mut creature = running(&(program + &simple("two", "a", 1.0, "m")));
    let mut senses = Switches::default();
    senses
        .set("a", 1.0)
        .goal("p", Some(Goal::at(1.0, 0.0)))
        .goal("q", Some(Goal::at(2.0, 0.0)));
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
    let two = creature.hierarchy().find("two").expect("declared");
    assert_eq!(creature.hierarchy().yielded(two), Some(Yielded::Motor));
}

#[test]
fn rms_below_an_inactive_superordinate_do_not_listen() {
    let mut creature = running(TOWER);
    let mut senses = Switches::default();
    senses.set("b", 1.0).set("c", 1.0);
    evaluated(&mut creature, &senses);
    let listens = |creature: &adroit::language::Running, name: &str| {
        creature
            .hierarchy()
            .listens(creature.hierarchy().find(name).expect("declared"))
    };
    assert!(
        listens(&creature, "building") && listens(&creature, "refuel") && listens(&creature, "maintenance")
    );
    assert!(!listens(&creature, "seek") && !listens(&creature, "sweep"));
    senses.set("a", 1.0);
    evaluated(&mut creature, &senses);
    assert!(listens(&creature, "seek") && listens(&creature, "sweep"));
}

#[test]
fn a_goal_state_that_holds_suppresses_action() {
    let program = "rm carry reports to top. add stimulus always to rm carry with magnitude 2.
        rm go reports to rm carry. add stimulus always to rm go with magnitude 2. goal state of rm go is x.
        mcu m reports to rm go.
        rm drop reports to rm carry. add stimulus always to rm drop with magnitude 1. mcu n reports to rm drop.";
    let mut creature = running(program);
    let mut senses = Switches::default();
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
    senses.state("x", true);
    assert_eq!(evaluated(&mut creature, &senses), ["n"]);
    let go = creature.hierarchy().find("go").expect("declared");
    assert_eq!(creature.hierarchy().yielded(go), Some(Yielded::GoalHolds));
}

#[test]
fn a_failed_mcu_sets_off_the_back_up_once() {
    let mut creature = running(&(simple("one", "a", 2.0, "m") + &simple("two", "a", 1.0, "n")));
    let mut senses = Switches::default();
    senses.set("a", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
    let unit = stage::vocabulary().mcu("m").expect("known");
    creature.hierarchy_mut().report_failure(unit);
    assert_eq!(evaluated(&mut creature, &senses), ["n"]);
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
}

#[test]
fn goals_are_reviewed_at_every_evaluation_unless_kept() {
    for (verb, expected) in [("selects", 2), ("keeps", 1)] {
        let mut creature = running(&(simple("one", "a", 1.0, "m") + &format!("rm one {verb} goal p.")));
        let mut senses = Switches::default();
        senses.set("a", 1.0).goal("p", Some(Goal::object(1, 0.0, 0.0)));
        evaluated(&mut creature, &senses);
        senses.goal("p", Some(Goal::object(2, 0.0, 0.0)));
        evaluated(&mut creature, &senses);
        assert_eq!(creature.hierarchy().outputs()[0].goal.thing, expected, "{verb}");
    }
}

#[test]
fn a_subroutine_is_shared_and_works_on_the_goal_of_its_caller() {
    let program =
        "rm fetch reports to top. add stimulus a to rm fetch with magnitude 2. rm fetch selects goal p.
        goal parameters of rm fetch go to subroutine go-to.
        rm visit reports to top. add stimulus b to rm visit with magnitude 1. rm visit selects goal q.
        goal parameters of rm visit go to subroutine go-to.
        rm drive reports to subroutine go-to. add stimulus always to rm drive with magnitude 1.
        mcu m reports to rm drive.";
    let mut creature = running(program);
    let mut senses = Switches::default();
    senses
        .set("b", 1.0)
        .goal("p", Some(Goal::object(1, 0.0, 0.0)))
        .goal("q", Some(Goal::object(2, 0.0, 0.0)));
    evaluated(&mut creature, &senses);
    assert_eq!(creature.hierarchy().outputs()[0].goal.thing, 2);
    senses.set("a", 1.0);
    evaluated(&mut creature, &senses);
    assert_eq!(creature.hierarchy().outputs()[0].goal.thing, 1);
    assert_eq!(
        creature.hierarchy().levels().len(),
        2,
        "one level for both callers"
    );
}
