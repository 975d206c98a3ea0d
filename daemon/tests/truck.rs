//! A truck over wires plays the game that it plays in the arena, to the cent.

use daemon::body::ootland::{OotlandWorld, trucks};
use daemon::machine::kinds;
use daemon::virtual_run::{Options, Stimulus, VirtualRun};
use ipc::clock::Span;
use ipc::wiring::{Source, check};
use truckin::ootland::{Game, World};
use truckin::strategies::{Chromosome, SLOTS};

const SEED: u64 = 7;
const GAME: u64 = 3;

/// A creature of the truck called `name`, in a game of so many slots with so many others.
fn creature(name: &Chromosome, slots: u32, others: usize) -> String {
    let word = |slot: usize| SLOTS[slot].alleles[usize::from(name.genes()[slot])].name;
    format!(
        r#"
creature = "truck"
seed = 99

[body]
kind = "ootland"
period = "2ms"
slots = {slots}
slot = "2ms"
patience = "60s"
others = {others}
seed = {SEED}
game = {GAME}

[[layer]]
name = "drive"
level = 0
period = "2ms"
wires = ["body.dials -> driver.dials", "body.answer -> driver.answer", "driver.order -> body.order"]

[layer.modules.driver]
kind = "truckin.driver"
gas = "{}"
capital = "{}"
trading = "{}"
information = "{}"
seed = {SEED}
game = {GAME}
"#,
        word(0),
        word(1),
        word(2),
        word(3)
    )
}

fn run(text: &str) -> VirtualRun {
    let source = Source::new("truck.toml", text);
    let creature = check::creature(&source, &kinds()).unwrap_or_else(|rejected| panic!("{rejected}"));
    VirtualRun::with(creature, &kinds(), &Options::default())
}

fn game(run: &mut VirtualRun) -> &Game {
    let body = run.machine.body.as_mut().expect("the creature has a body");
    let world = body.world.as_any().downcast_ref::<OotlandWorld>();
    world.expect("the body is in OOTland").game()
}

fn standing(game: &Game) -> Vec<(i64, i32)> {
    let standings = game.standings();
    standings.map(|s| (s.profit_cents, s.tank_millilitres)).collect()
}

#[test]
fn over_wires_it_is_the_same_game() {
    for (name, slots, others) in [
        ("3234", 400, 5),
        ("4331", 400, 0),
        ("0000", 300, 19),
        ("2142", 400, 3),
    ] {
        let name: Chromosome = name.parse().expect("a chromosome");
        let mut run = run(&creature(&name, slots, others));
        while !game(&mut run).is_over() {
            run.advance(Span::secs(1));
            assert!(run.elapsed() < Span::secs(3_600), "{name}: the game does not end");
        }
        let mut all = trucks(others, SEED, GAME);
        all[0] = name;
        let mut arena = Game::new(&World::default(), &all, slots, SEED, GAME);
        arena.play(true).expect("a game by the rules");
        game(&mut run).check().expect("conserved over wires as well");
        assert_eq!(standing(game(&mut run)), standing(&arena), "{name}");
        assert_ne!(standing(&arena)[0].0, 0, "{name}: it did something");
    }
}

#[test]
fn halted_the_truck_does_nothing_and_the_country_goes_on() {
    let name: Chromosome = "3234".parse().expect("a chromosome");
    let text = creature(&name, 5_000, 2).replace("60s", "100ms");
    let mut run = run(&text);
    run.advance(Span::secs(2));
    let now = run.next_beat().expect("it beats");
    run.moment(now, &[Stimulus::Halt]);
    run.advance(Span::millis(50));
    let (slot, own) = (game(&mut run).clock().slot, standing(game(&mut run))[0]);
    run.advance(Span::secs(5));
    assert_ne!(own, (0, 50_000), "it was on its way");
    assert_eq!(standing(game(&mut run))[0], own, "halted");
    assert!(game(&mut run).clock().slot > slot + 20, "slots go by");
    let now = run.next_beat().expect("it beats");
    run.moment(now, &[Stimulus::Reset]);
    run.advance(Span::secs(5));
    assert_ne!(standing(game(&mut run))[0], own, "reset, it goes on");
}
