//! Whole games: conservation, order of turns, repeatability, and every truck there is.

use truckin::ootland::referee::Turn;
use truckin::ootland::{Chance, Corner, Game, GameView, World};
use truckin::strategies::{Chromosome, SLOTS, all_chromosomes};

fn trucks(names: &[&str]) -> Vec<Chromosome> {
    names
        .iter()
        .map(|name| name.parse().expect("a chromosome"))
        .collect()
}

fn scores(game: &Game) -> Vec<i64> {
    game.standings().map(|standing| standing.profit_cents).collect()
}

#[test]
fn all_chromosomes_run_and_conserve() {
    let all = all_chromosomes();
    assert_eq!(all.len(), 625);
    for (number, trucks) in all.chunks(25).enumerate() {
        let mut game = Game::new(&World::default(), trucks, 300, 11, number as u64);
        game.play(true).expect("a game by the rules");
        assert_eq!(scores(&game).len(), 25);
    }
}

#[test]
fn money_and_goods_are_conserved_over_many_seeds() {
    let all = all_chromosomes();
    for seed in 0..200 {
        let mut chance = Chance::new(seed, 99);
        let trucks: Vec<Chromosome> = (0..1 + seed as usize % 20)
            .map(|_| all[chance.below(625) as usize])
            .collect();
        let mut game = Game::new(&World::default(), &trucks, 400, seed, 0);
        game.play(true)
            .unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
    }
}

#[test]
fn a_game_repeats_to_the_bit_and_watching_changes_nothing() {
    let trucks = trucks(&["4331", "2322", "0000", "1243", "3414"]);
    let play = |watched: bool| {
        let mut game = Game::new(&World::default(), &trucks, 2_000, 5, 6);
        let mut seen = Vec::new();
        while !game.is_over() {
            game.play_slot();
            if watched {
                seen.push(serde_json::to_string(&GameView::of(&game)).expect("JSON"));
            }
        }
        (scores(&game), seen)
    };
    let (first, seen) = play(true);
    assert_eq!((first.clone(), seen), play(true));
    assert_eq!(first, play(false).0);
    let mut other = Game::new(&World::default(), &trucks, 2_000, 5, 7);
    other.play(false).expect("a game");
    assert_ne!(first, scores(&other), "another game of the same seed");
}

#[test]
fn dealers_play_before_trucks_and_both_in_an_order_drawn_each_slot() {
    let mut game = Game::new(&World::default(), &trucks(&["2222"; 8]), 50, 3, 0);
    let mut truck_orders = Vec::new();
    let mut dealer_orders: Vec<Vec<Corner>> = Vec::new();
    while !game.is_over() {
        let mut turns = Vec::new();
        game.play_slot_watched(&mut |turn| turns.push(turn));
        assert_eq!(turns[0], Turn::Dealers);
        let order: Vec<usize> = turns[1..]
            .iter()
            .map(|turn| match turn {
                Turn::Truck(seat) => *seat,
                Turn::Dealers => panic!("dealers play once, and first"),
            })
            .collect();
        let mut seats = order.clone();
        seats.sort_unstable();
        assert_eq!(seats, (0..8).collect::<Vec<_>>(), "every truck once");
        truck_orders.push(order);
        dealer_orders.push(game.land().playing().to_vec());
    }
    truck_orders.sort();
    truck_orders.dedup();
    dealer_orders.sort();
    dealer_orders.dedup();
    assert!(truck_orders.len() > 45 && dealer_orders.len() > 45);
}

#[test]
fn the_strategies_come_with_their_ideas() {
    assert_eq!(SLOTS.map(|slot| slot.alleles.len()), [5; 4]);
    for allele in SLOTS.iter().flat_map(|slot| slot.alleles) {
        assert!(
            allele.source.starts_with("//! "),
            "{}: the first line says the idea",
            allele.name
        );
        assert!(allele.idea().len() > 20, "{}", allele.name);
    }
}

#[test]
fn chromosomes_are_read_and_refused() {
    let truck: Chromosome = "0312".parse().expect("a chromosome");
    assert_eq!(
        (truck.genes(), truck.to_string()),
        ([0, 3, 1, 2], "0312".to_owned())
    );
    for (text, place) in [
        ("0512", Some(2)),
        ("031x", Some(4)),
        ("-312", Some(1)),
        ("031", None),
        ("", None),
    ] {
        let fault = text.parse::<Chromosome>().expect_err(text);
        assert_eq!(fault.place, place, "{fault}");
    }
}

#[test]
fn a_layer_above_takes_over_by_inhibiting() {
    // Information gathering 2 calls around before anything below gets a word in.
    let mut game = Game::new(&World::default(), &trucks(&["2222"]), 100, 1, 0);
    game.play_slot();
    let view = GameView::of(&game);
    let truck = &view.trucks[0];
    assert_eq!(truck.holder, Some(3), "{truck:?}");
    assert!(truck.layers[..3].iter().all(|layer| layer.inhibited));
    assert!(truck.layers[3].plan[0].starts_with("phone"));
    assert!(!truck.layers[3].inhibited);
}
