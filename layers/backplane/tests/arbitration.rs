//! Selection order, inhibition, clearing and feedback, on a creature that is no truck.

use std::cell::RefCell;
use std::rc::Rc;

use backplane::{
    ACTIONS_MAX, Action, BehaviourLayer, CommunicationBackplane, Creature, Executor, Feedback, LayerId,
    Phase, Proposal, SELECTIONS_MAX, Selector, SteppedTurn, TurnEnd, take_turn,
};

/// A snail that can crawl some inches in a turn.
struct Snail;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Crawl(i32);

#[derive(Default)]
struct Shell {
    crawled: i32,
    minutes: i32,
}

impl Creature for Snail {
    type Body<'turn> = Shell;
    type Action = Crawl;
    type Outcome = i32;

    fn slot_is_used_up(body: &Shell) -> bool {
        body.minutes <= 0
    }
}

impl Action<Snail> for Crawl {
    fn do_action(self, body: &mut Shell) -> i32 {
        body.crawled += self.0;
        body.minutes -= self.0.max(0);
        body.crawled
    }
}

type Journal = Rc<RefCell<Vec<String>>>;

/// Proposes a fixed plan, inhibits fixed layers, writes down every call.
struct Scripted {
    plan: Vec<i32>,
    inhibits: Vec<u8>,
    journal: Journal,
    name: &'static str,
}

impl BehaviourLayer<Snail> for Scripted {
    fn feedback(&mut self, heard: &Feedback<'_, Snail>, _: &Shell) {
        let selected = heard.selected().map(|selected| {
            assert_eq!(selected.plan.actions().len(), selected.outcomes.len());
            (
                selected.layer.0,
                selected.plan.actions()[0].0,
                selected.outcomes.to_vec(),
            )
        });
        self.journal.borrow_mut().push(format!(
            "{} heard {selected:?} mine {} inhibited {}",
            self.name,
            heard.was_mine(),
            heard.my_control().is_inhibited()
        ));
    }

    fn go(&mut self, proposal: &mut Proposal<'_, Snail>, _: &Shell) {
        assert!(proposal.plan().is_empty(), "the memory is cleared before go");
        self.journal.borrow_mut().push(format!("{} go", self.name));
        for &inches in &self.plan {
            proposal.add(Crawl(inches)).expect("a short plan");
        }
        for &below in &self.inhibits {
            proposal.inhibit(LayerId(below));
        }
    }
}

fn stack(plans: [(&[i32], &[u8]); 3]) -> (Vec<Scripted>, Journal) {
    let journal = Journal::default();
    let layers = plans
        .into_iter()
        .zip(["low", "middle", "high"])
        .map(|((plan, inhibits), name)| Scripted {
            plan: plan.to_vec(),
            inhibits: inhibits.to_vec(),
            journal: Rc::clone(&journal),
            name,
        })
        .collect();
    (layers, journal)
}

fn holder(plans: [(&[i32], &[u8]); 3]) -> Option<u8> {
    let (mut layers, _) = stack(plans);
    let mut backplane = CommunicationBackplane::new(3);
    Selector::select(&mut layers, &mut backplane, &Shell::default()).map(|layer| layer.0)
}

#[test]
fn left_alone_the_lowest_layer_with_a_plan_acts() {
    assert_eq!(holder([(&[1], &[]), (&[2], &[]), (&[3], &[])]), Some(0));
    assert_eq!(holder([(&[], &[]), (&[2], &[]), (&[3], &[])]), Some(1));
    assert_eq!(holder([(&[], &[]), (&[], &[]), (&[3], &[])]), Some(2));
    assert_eq!(holder([(&[], &[]), (&[], &[]), (&[], &[])]), None);
}

#[test]
fn a_layer_that_knows_better_inhibits_those_below_it() {
    assert_eq!(holder([(&[1], &[]), (&[2], &[0]), (&[3], &[])]), Some(1));
    assert_eq!(holder([(&[1], &[]), (&[2], &[]), (&[3], &[0, 1])]), Some(2));
    assert_eq!(
        holder([(&[1], &[]), (&[2], &[]), (&[3], &[1])]),
        Some(0),
        "any of them, not all"
    );
    assert_eq!(holder([(&[1], &[]), (&[2], &[0]), (&[3], &[1])]), Some(2));
    assert_eq!(
        holder([(&[1], &[]), (&[], &[]), (&[], &[0])]),
        None,
        "inhibiting without a plan waits"
    );
}

#[test]
fn the_phases_come_in_the_order_of_the_source() {
    let (mut layers, journal) = stack([(&[], &[]), (&[4, 5], &[]), (&[9], &[])]);
    let mut backplane = CommunicationBackplane::new(3);
    let mut body = Shell {
        crawled: 0,
        minutes: 10,
    };
    Selector::select(&mut layers, &mut backplane, &body);
    assert_eq!(Executor::execute(&mut backplane, &mut body), 2);
    journal.borrow_mut().clear();
    Selector::select(&mut layers, &mut backplane, &body);
    let expected = [
        "low heard Some((1, 4, [4, 9])) mine false inhibited false",
        "middle heard Some((1, 4, [4, 9])) mine true inhibited false",
        "high heard Some((1, 4, [4, 9])) mine false inhibited false",
        "low go",
        "middle go",
        "high go",
    ];
    assert_eq!(*journal.borrow(), expected);
}

#[test]
fn a_layer_hears_that_it_was_inhibited_and_the_memory_is_cleared() {
    let (mut layers, journal) = stack([(&[1], &[]), (&[2], &[0]), (&[], &[])]);
    let mut backplane = CommunicationBackplane::new(3);
    let mut body = Shell {
        crawled: 0,
        minutes: 10,
    };
    assert_eq!(
        Selector::select(&mut layers, &mut backplane, &body),
        Some(LayerId(1))
    );
    Executor::execute(&mut backplane, &mut body);
    layers[1].inhibits.clear();
    layers[1].plan.clear();
    journal.borrow_mut().clear();
    assert_eq!(
        Selector::select(&mut layers, &mut backplane, &body),
        Some(LayerId(0)),
        "released"
    );
    assert_eq!(
        journal.borrow()[0],
        "low heard Some((1, 2, [2])) mine false inhibited true"
    );
    assert!(backplane.control(LayerId(1)).plan().is_empty());
    assert_eq!(
        backplane.selected().map(|selected| selected.outcomes.len()),
        Some(0)
    );
}

#[test]
fn a_turn_repeats_until_the_slot_is_used_up() {
    let (mut layers, _) = stack([(&[], &[]), (&[4], &[]), (&[], &[])]);
    let mut backplane = CommunicationBackplane::new(3);
    let mut body = Shell {
        crawled: 0,
        minutes: 10,
    };
    assert_eq!(
        take_turn(&mut layers, &mut backplane, &mut body),
        TurnEnd::SlotUsedUp
    );
    assert_eq!((body.crawled, body.minutes), (12, -2));
    layers[1].plan.clear();
    body.minutes = 10;
    assert_eq!(
        take_turn(&mut layers, &mut backplane, &mut body),
        TurnEnd::NothingToDo
    );
}

#[test]
fn a_plan_that_costs_no_time_cannot_hold_the_turn_for_ever() {
    let (mut layers, journal) = stack([(&[0], &[]), (&[], &[]), (&[], &[])]);
    let mut backplane = CommunicationBackplane::new(3);
    let mut body = Shell {
        crawled: 0,
        minutes: 10,
    };
    assert_eq!(
        take_turn(&mut layers, &mut backplane, &mut body),
        TurnEnd::CutShort
    );
    let calls = journal.borrow().iter().filter(|line| *line == "low go").count();
    assert_eq!(calls, SELECTIONS_MAX as usize);
}

#[test]
fn a_full_plan_says_so() {
    struct Talker;
    impl BehaviourLayer<Snail> for Talker {
        fn feedback(&mut self, _: &Feedback<'_, Snail>, _: &Shell) {}
        fn go(&mut self, proposal: &mut Proposal<'_, Snail>, _: &Shell) {
            for inches in 0..ACTIONS_MAX {
                assert!(proposal.add(Crawl(inches as i32)).is_ok());
            }
            assert!(proposal.add(Crawl(99)).is_err());
            assert_eq!(proposal.plan().actions().len(), ACTIONS_MAX);
        }
    }
    Selector::select(
        &mut [Talker],
        &mut CommunicationBackplane::new(1),
        &Shell::default(),
    );
}

#[test]
#[should_panic(expected = "is not below")]
fn nobody_inhibits_upwards() {
    struct Upstart;
    impl BehaviourLayer<Snail> for Upstart {
        fn feedback(&mut self, _: &Feedback<'_, Snail>, _: &Shell) {}
        fn go(&mut self, proposal: &mut Proposal<'_, Snail>, _: &Shell) {
            proposal.inhibit(LayerId(1));
        }
    }
    let mut layers = [Upstart, Upstart];
    Selector::select(
        &mut layers,
        &mut CommunicationBackplane::new(2),
        &Shell::default(),
    );
}

/// Takes a turn step by step, as over wires: each action is done between two steps. How it ended, and how many
/// steps it took.
fn take_turn_in_steps(
    layers: &mut [Scripted],
    backplane: &mut CommunicationBackplane<Snail>,
    body: &mut Shell,
) -> (TurnEnd, u32) {
    let mut turn = SteppedTurn::default();
    assert_eq!((turn.phase(), turn.wanted(backplane)), (Phase::Idle, None));
    turn.begin::<Snail>(body);
    for steps in 0.. {
        if let Phase::Over(end) = turn.phase() {
            return (end, steps);
        }
        turn.step(layers, backplane, body);
        while let Some(action) = turn.wanted(backplane) {
            let outcome = action.do_action(body);
            turn.answered(backplane, outcome, body);
        }
    }
    unreachable!("a turn ends")
}

#[test]
fn a_turn_in_steps_is_the_same_turn() {
    let stacks: [[(&[i32], &[u8]); 3]; 5] = [
        [(&[2, 3], &[]), (&[1], &[]), (&[], &[])],
        [(&[2, 3], &[]), (&[0, 4], &[0]), (&[], &[])],
        [(&[1], &[]), (&[1], &[]), (&[], &[0, 1])],
        [(&[0], &[]), (&[], &[]), (&[], &[])],
        [(&[], &[]), (&[], &[]), (&[], &[])],
    ];
    for plans in stacks {
        for minutes in [0, 1, 10] {
            let play = |stepped: bool| {
                let (mut layers, journal) = stack(plans);
                let mut backplane = CommunicationBackplane::new(3);
                let mut body = Shell { crawled: 0, minutes };
                let mut ends = Vec::new();
                for _ in 0..3 {
                    body.minutes = minutes;
                    ends.push(match stepped {
                        true => take_turn_in_steps(&mut layers, &mut backplane, &mut body).0,
                        false => take_turn(&mut layers, &mut backplane, &mut body),
                    });
                }
                let outcomes = backplane.selected().map(|selected| selected.outcomes.to_vec());
                let journal = journal.borrow().clone();
                (ends, body.crawled, outcomes, journal)
            };
            assert_eq!(play(true), play(false), "{plans:?} {minutes}");
        }
    }
}

#[test]
fn each_phase_is_a_step_of_its_own() {
    let (mut layers, journal) = stack([(&[4, 4], &[]), (&[], &[]), (&[], &[])]);
    let mut backplane = CommunicationBackplane::new(3);
    let body = Shell {
        crawled: 0,
        minutes: 5,
    };
    let mut turn = SteppedTurn::default();
    turn.begin::<Snail>(&body);
    let calls = |journal: &Journal| journal.borrow().len();
    for (phase, called) in [
        (Phase::Hear, 0),
        (Phase::Clear, 3),
        (Phase::Propose, 3),
        (Phase::Select, 6),
        (Phase::Act, 6),
        (Phase::Act, 6),
    ] {
        assert_eq!((turn.phase(), calls(&journal)), (phase, called));
        assert_eq!(turn.wanted(&backplane).is_some(), phase == Phase::Act);
        turn.step(&mut layers, &mut backplane, &body);
    }
    turn.answered(&mut backplane, 4, &body);
    assert_eq!(turn.wanted(&backplane), Some(Crawl(4)), "the plan goes on");
    let later = Shell {
        crawled: 8,
        minutes: -3,
    };
    turn.answered(&mut backplane, 8, &later);
    assert_eq!(turn.phase(), Phase::Over(TurnEnd::SlotUsedUp));
    assert_eq!(
        backplane.selected().map(|selected| selected.outcomes.to_vec()),
        Some(vec![4, 8])
    );
}
