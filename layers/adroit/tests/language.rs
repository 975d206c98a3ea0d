//! The language: its errors, its formatter, and commands to a running hierarchy.

mod stage;

use adroit::language::{check, format};
use stage::{Switches, evaluated, running, simple, vocabulary};

const REST: &str =
    "rm rest reports to top. add stimulus always to rm rest with magnitude 1. mcu r reports to rm rest.\n";

/// The problems of a text, as a person reads them.
fn problems(text: &str) -> String {
    check(text, &vocabulary()).expect_err("has problems").to_string()
}

#[test]
fn every_problem_has_a_place_an_expectation_and_a_suggestion() {
    for (text, expected) in [
        (
            "rm rest reprots to top.",
            "1:9: expected `reports` or `selects` or `keeps` or `conflicts`, found `reprots`; did you mean `reports`?",
        ),
        (
            "rm rest reports to top\nmcu r reports to rm rest.",
            "2:1: expected `.` at the end of the statement, found `mcu`",
        ),
        (
            "  add stimulus a to rm b with magnitude much.",
            "1:41: expected a number, found `much`",
        ),
        (
            "threshold of rm 7 is 1.",
            "1:17: expected the name of an rm, found the number 7",
        ),
        (
            "rm one ; reports to top.",
            "1:8: expected a word, a number or `.`, found `;`",
        ),
        (
            "threshold of rm one is -.",
            "1:24: expected a number like -2 or 0.5",
        ),
        (
            "rm rest reports to",
            "1:19: expected `top` or `rm` or `subroutine`, found the end of the text",
        ),
    ] {
        let found = problems(text);
        assert!(
            found.contains(expected),
            "for {text:?}\nexpected {expected}\nfound    {found}"
        );
    }
}

#[test]
fn names_are_checked_against_the_body_and_the_program() {
    for (text, expected) in [
        (
            "add stimulus alwais to rm rest with magnitude 1.",
            "2:14: unknown stimulus `alwais`; expected one that the body has; did you mean `always`?",
        ),
        (
            "rm rest selects goal fuel.",
            "2:22: unknown goal criterion `fuel`",
        ),
        (
            "goal state of rm rest is done.",
            "2:26: unknown goal state `done`",
        ),
        (
            "threshold of rm tset is 1.",
            "2:17: there is no rm `tset`; expected the name of an rm that reports to something; did you mean `rest`?",
        ),
        (
            "rm go reports to rm rset. mcu m reports to rm go.",
            "2:21: there is no rm `rset`; expected an rm that reports to something; did you mean `rest`?",
        ),
        ("rm idle reports to top.", "2:4: rm `idle` controls nothing"),
        (
            "rm rest reports to top.",
            "2:4: rm `rest` reports to something already, at line 1",
        ),
        (
            "mcu m reports to rm rest.",
            "2:5: `r` is the mcu of its rm already, at line 1",
        ),
        (
            "add stimulus always to rm rest with magnitude 2.",
            "2:14: `always` is an input of rm `rest` already, at line 1",
        ),
        (
            "rm go reports to top. goal parameters of rm go go to subroutine gone.",
            "2:65: no rm reports to subroutine `gone`",
        ),
        (
            "rm go reports to subroutine unused. mcu m reports to rm go.",
            "2:29: the goal parameters of no rm go to subroutine `unused`",
        ),
        (
            "rm rest conflicts with rm rest.",
            "2:27: rm `rest` cannot conflict with itself",
        ),
        (
            "rm i reports to rm j. rm j reports to rm i.",
            "2:4: rm `i` reports in a circle that never reaches the top",
        ),
        (
            "rm go reports to top. goal parameters of rm go go to subroutine s.
          rm in reports to subroutine s. goal parameters of rm in go to subroutine s.",
            "more than 16 levels, or a circle",
        ),
    ] {
        let found = problems(&format!("{REST}{text}"));
        assert!(
            found.contains(expected),
            "for {text:?}\nexpected {expected}\nfound    {found}"
        );
    }
}

#[test]
fn all_problems_are_found_at_once() {
    assert_eq!(
        problems("rm a rports to top.\nmcu b to rm c.\nadd stimulus.")
            .lines()
            .count(),
        3
    );
    let mixed = problems("rm a rports to top.\nadd stimulus nonsense to rm a with magnitude 1.");
    assert_eq!(
        mixed.lines().count(),
        2,
        "a name is wrong whatever else is: {mixed}"
    );
}

#[test]
fn formatting_keeps_comments_and_settles_after_one_pass() {
    let text = "# the whole\nrm   rest reports to\n top.add stimulus always to rm rest with magnitude 1.50. # why\n\n\n\n#end\nmcu r reports to rm rest.";
    let once = format(text).expect("is of the language");
    assert_eq!(
        once,
        "# the whole\nrm rest reports to top.\n  add stimulus always to rm rest with magnitude 1.5.  # why\n\n# end\n  mcu r reports to rm rest.\n"
    );
    assert_eq!(format(&once).expect("is of the language"), once);
}

#[test]
fn a_command_applies_between_evaluations_and_can_be_undone() {
    let mut creature = running(&simple("one", "a", 1.0, "m"));
    let mut senses = Switches::default();
    senses.set("b", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["r"]);
    creature
        .apply("add stimulus b to rm one with magnitude 1.")
        .expect("is right");
    assert_eq!(evaluated(&mut creature, &senses), ["m"]);
    assert_eq!(creature.list().len(), 1);
    assert_eq!(creature.list()[0].after_evaluation, 1);
    let undone = creature.undo().expect("one was applied");
    assert_eq!(undone.text.trim(), "add stimulus b to rm one with magnitude 1.");
    assert_eq!(evaluated(&mut creature, &senses), ["r"]);
    assert!(creature.undo().is_none());
}

#[test]
fn a_command_is_applied_whole_or_not_at_all() {
    let mut creature = running(&simple("one", "a", 1.0, "m"));
    let before = creature.text();
    let refused = creature
        .apply("add stimulus b to rm one with magnitude 1.\nadd stimulus c to rm oen with magnitude 1.");
    assert!(
        refused
            .expect_err("oen is unknown")
            .to_string()
            .starts_with("2:22: there is no rm `oen`")
    );
    assert_eq!(creature.text(), before);
    let mut senses = Switches::default();
    senses.set("b", 1.0);
    assert_eq!(evaluated(&mut creature, &senses), ["r"]);
    assert!(
        creature.apply("remove rm maintenance.").is_err(),
        "the top must keep something to choose"
    );
}

#[test]
fn a_command_leaves_kept_goals_of_running_rms_alone() {
    use adroit::hierarchy::Goal;
    let mut creature = running(&(simple("one", "a", 1.0, "m") + "rm one keeps goal p."));
    let mut senses = Switches::default();
    senses.set("a", 1.0).goal("p", Some(Goal::object(1, 0.0, 0.0)));
    evaluated(&mut creature, &senses);
    senses.goal("p", Some(Goal::object(2, 0.0, 0.0)));
    creature.apply(&simple("two", "b", 1.0, "n")).expect("is right");
    evaluated(&mut creature, &senses);
    assert_eq!(creature.hierarchy().outputs()[0].goal.thing, 1);
}

#[test]
fn a_saved_program_loads_to_the_same_behaviour() {
    let mut creature = running(&simple("one", "a", 1.0, "m"));
    creature
        .apply("add stimulus b to rm one with magnitude 1.")
        .expect("is right");
    creature
        .apply("remove stimulus a from rm one.")
        .expect("is right");
    let mut again = adroit::language::Running::load(&creature.text(), vocabulary()).expect("was running");
    let mut senses = Switches::default();
    senses.set("b", 1.0);
    assert_eq!(evaluated(&mut again, &senses), ["m"]);
    senses.set("b", 0.0).set("a", 1.0);
    assert_eq!(evaluated(&mut again, &senses), ["r"]);
}
