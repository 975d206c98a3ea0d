//! The rules of the game, to the cent, the minute and the millilitre.

use backplane::Action;

use super::action::{Outcome, Refusal, TruckAction};
use super::chance::Chance;
use super::clock::Clock;
use super::controller::{Controller, TruckBook};
use super::dealers::{Commodity, Kind};
use super::grid::{Corner, Direction};
use super::land::Land;
use super::world_file;

use Direction::{East, North, South, West};
use TruckAction::{Buy, Move, Phone, Sell};

/// Producer at (1,0), retailer at (2,0), consumer at (3,0), gas station at (0,1).
const COUNTRY: &str = r#"
scattered = {}

[[dealer]]
at = [1, 0]
kind = "producer"

[[dealer]]
at = [2, 0]
kind = "retailer"
buying_cents = 12000
selling_cents = 160

[[dealer]]
at = [3, 0]
kind = "consumer"

[[dealer]]
at = [0, 1]
kind = "gas_station"
selling_cents = 100
"#;

/// A truck at (0,0) that does as it is told, in the first slot of a game.
struct Bench {
    book: TruckBook,
    land: Land,
    clock: Clock,
}

fn corner(avenue: u16, street: u16) -> Corner {
    Corner(street * 10 + avenue)
}

impl Bench {
    fn new(slots: u32) -> Self {
        let land = world_file::read(COUNTRY)
            .expect("a good world")
            .open(&mut Chance::new(1, 1));
        let mut book = TruckBook::new(corner(0, 0));
        book.begin_slot();
        Self {
            book,
            land,
            clock: Clock { slot: 0, slots },
        }
    }

    fn act(&mut self, action: TruckAction) -> Outcome {
        let before = self.book;
        let outcome = action.do_action(&mut Controller::new(&mut self.book, &mut self.land, self.clock));
        if matches!(outcome, Outcome::Ignored(_)) {
            assert_eq!(self.book, before, "an ignored action spends nothing");
        }
        outcome
    }

    fn slot(&mut self) -> i32 {
        self.clock.slot += 1;
        self.land.play_dealers(&mut Chance::new(1, 1));
        self.book.begin_slot();
        self.book.left_minutes
    }
}

#[test]
fn a_truck_starts_with_500_dollars_and_a_full_tank() {
    let bench = Bench::new(1);
    assert_eq!(
        (bench.book.capital_cents, bench.book.tank_millilitres),
        (50_000, 50_000)
    );
    assert_eq!(
        (bench.book.crates, bench.book.items, bench.book.left_minutes),
        (0, 0, 10)
    );
}

#[test]
fn a_step_takes_6_minutes_and_1_litre() {
    let mut bench = Bench::new(1);
    assert_eq!(
        bench.act(Move(East, 1)),
        Outcome::Moved {
            corner: corner(1, 0),
            steps: 1
        }
    );
    assert_eq!(
        (bench.book.left_minutes, bench.book.tank_millilitres),
        (4, 49_000)
    );
}

#[test]
fn two_steps_take_this_slot_and_2_minutes_of_the_next() {
    let mut bench = Bench::new(5);
    bench.act(Move(East, 2));
    assert_eq!(
        (bench.book.left_minutes, bench.book.tank_millilitres),
        (-2, 48_000)
    );
    assert_eq!(bench.slot(), 8);
}

#[test]
fn a_long_journey_takes_whole_slots() {
    let mut bench = Bench::new(9);
    bench.act(Move(North, 5));
    assert_eq!(bench.book.left_minutes, -20);
    assert_eq!([bench.slot(), bench.slot(), bench.slot()], [-10, 0, 10]);
}

#[test]
fn minutes_not_used_are_lost() {
    let mut bench = Bench::new(9);
    bench.act(Move(East, 1));
    assert_eq!(bench.slot(), 10, "4 minutes left over are not carried forward");
}

#[test]
fn a_call_that_succeeds_takes_3_minutes_and_300_cents() {
    let mut bench = Bench::new(9);
    let Outcome::Told { card, .. } = bench.act(Phone(corner(1, 0))) else {
        panic!("no answer")
    };
    assert_eq!((bench.book.left_minutes, bench.book.capital_cents), (7, 49_700));
    assert_eq!(
        (card.kind, card.selling_cents, card.buying_cents),
        (Kind::Producer, 10_000, 0)
    );
}

#[test]
fn a_call_that_fails_takes_1_minute_and_100_cents() {
    let mut bench = Bench::new(9);
    let Outcome::Told { card, .. } = bench.act(Phone(corner(5, 5))) else {
        panic!("no answer")
    };
    assert_eq!((bench.book.left_minutes, bench.book.capital_cents), (9, 49_900));
    assert_eq!(card.kind, Kind::Idle);
}

#[test]
fn calls_carry_over_like_journeys() {
    let mut bench = Bench::new(9);
    let left: Vec<i32> = (0..4)
        .map(|_| {
            bench.act(Phone(corner(1, 0)));
            bench.book.left_minutes
        })
        .collect();
    assert_eq!(left, [7, 4, 1, -2]);
    assert_eq!(bench.slot(), 8);
    assert_eq!(bench.book.capital_cents, 50_000 - 4 * 300);
}

#[test]
fn goods_go_from_producer_to_retailer_to_consumer() {
    let mut bench = Bench::new(99);
    bench.act(Move(East, 1));
    bench.act(Buy(4));
    assert_eq!((bench.book.crates, bench.book.capital_cents), (4, 10_000));
    bench.slot();
    bench.act(Move(East, 1));
    bench.act(Sell(4));
    bench.act(Buy(300));
    assert_eq!(
        (bench.book.crates, bench.book.items, bench.book.capital_cents),
        (0, 300, 10_000)
    );
    for _ in 0..4 {
        bench.slot();
    }
    bench.act(Move(East, 1));
    let sold = bench.act(Sell(300));
    let (offered, units, cents) = (300, 5 * 10, 5 * 10 * 200);
    assert_eq!(
        sold,
        Outcome::Sold {
            commodity: Commodity::Items,
            offered,
            units,
            cents
        },
        "never in excess"
    );
    assert_eq!((bench.book.items, bench.book.capital_cents), (250, 20_000));
    assert_eq!(bench.book.tank_millilitres, 47_000);
}

#[test]
fn gas_is_sold_by_the_litre_at_the_posted_price() {
    let mut bench = Bench::new(9);
    bench.act(Move(North, 1));
    bench.act(Buy(1));
    assert_eq!(
        (bench.book.capital_cents, bench.book.tank_millilitres),
        (49_900, 50_000)
    );
    assert_eq!(bench.act(Buy(1)), Outcome::Ignored(Refusal::TankFull));
}

#[test]
fn a_dealer_need_not_take_the_whole_quantity() {
    let mut bench = Bench::new(9);
    bench.book.capital_cents = 10_000_000;
    bench.act(Move(East, 1));
    let Outcome::Bought {
        asked, units, cents, ..
    } = bench.act(Buy(100))
    else {
        panic!("not bought")
    };
    assert_eq!(
        (asked, units, cents),
        (100, 50, 500_000),
        "what stood in the yard"
    );
}

#[test]
fn the_controller_ignores_what_the_truck_cannot_pay_for() {
    let cases: [(&[TruckAction], Refusal); 13] = [
        (&[Move(West, 1)], Refusal::NoRoad),
        (&[Move(South, 1)], Refusal::NoRoad),
        (&[Move(North, 10)], Refusal::NoRoad),
        (&[Move(North, 0)], Refusal::NothingAsked),
        (&[Phone(Corner(100))], Refusal::NoRoad),
        (&[Buy(1)], Refusal::NotTradedHere),
        (&[Sell(1)], Refusal::NotTradedHere),
        (&[Move(East, 1), Buy(6)], Refusal::NoMoney),
        (&[Move(East, 1), Buy(i32::MAX)], Refusal::NoMoney),
        (&[Move(East, 1), Buy(0)], Refusal::NothingAsked),
        (&[Move(East, 1), Buy(-1)], Refusal::NothingAsked),
        (&[Move(East, 1), Sell(1)], Refusal::NotTradedHere),
        (&[Move(North, 1), Buy(2)], Refusal::TankFull),
    ];
    for (actions, expected) in cases {
        let mut bench = Bench::new(9);
        let last = actions.iter().map(|action| bench.act(*action)).last();
        assert_eq!(last, Some(Outcome::Ignored(expected)), "{actions:?}");
    }
}

#[test]
fn nothing_can_be_sold_that_is_not_on_board() {
    let mut bench = Bench::new(9);
    bench.book.corner = corner(2, 0);
    assert_eq!(bench.act(Sell(1)), Outcome::Ignored(Refusal::NoStock));
    assert_eq!(bench.act(Sell(-5)), Outcome::Ignored(Refusal::NothingAsked));
}

#[test]
fn no_call_without_the_money_for_it() {
    let mut bench = Bench::new(9);
    bench.book.capital_cents = 299;
    assert_eq!(bench.act(Phone(corner(1, 0))), Outcome::Ignored(Refusal::NoMoney));
    assert!(
        matches!(bench.act(Phone(corner(5, 5))), Outcome::Told { .. }),
        "a failed call is cheaper"
    );
}

#[test]
fn a_used_up_slot_has_no_time_and_the_road_is_no_market() {
    let mut bench = Bench::new(9);
    bench.act(Move(East, 1));
    bench.act(Move(East, 1));
    assert_eq!(bench.book.left_minutes, -2);
    for action in [Move(East, 1), Phone(corner(5, 5)), Buy(1), Sell(1)] {
        assert_eq!(
            bench.act(action),
            Outcome::Ignored(Refusal::NoTimeInSlot),
            "{action}"
        );
    }
}

#[test]
fn nothing_goes_on_after_the_end_of_the_game() {
    let mut bench = Bench::new(1);
    assert_eq!(bench.act(Move(East, 2)), Outcome::Ignored(Refusal::NoTimeInGame));
    assert!(matches!(bench.act(Move(East, 1)), Outcome::Moved { .. }));
    assert!(matches!(bench.act(Phone(corner(1, 0))), Outcome::Told { .. }));
    assert_eq!(
        bench.act(Phone(corner(1, 0))),
        Outcome::Ignored(Refusal::NoTimeInGame),
        "1 minute is left"
    );
}

#[test]
fn an_empty_tank_goes_nowhere() {
    let mut bench = Bench::new(99);
    for step in 0..50 {
        bench.act(Move(if step % 2 == 0 { East } else { West }, 1));
        bench.slot();
    }
    assert_eq!(bench.book.tank_millilitres, 0);
    while bench.book.left_minutes <= 0 {
        bench.slot();
    }
    assert_eq!(bench.act(Move(East, 1)), Outcome::Ignored(Refusal::NoGas));
}

#[test]
fn a_manager_keeps_its_dealer_honest() {
    let mut bench = Bench::new(9);
    let (retailer, _) = bench.land.trade(corner(2, 0));
    retailer.set_prices(-5, 0);
    assert_eq!(
        (retailer.buying_cents(), retailer.selling_cents()),
        (1, 1),
        "no price below a cent"
    );
    retailer.set_prices(200_000, 160);
    assert_eq!(
        retailer.buy(40),
        (1, 200_000),
        "no more than its capital of 300,000 pays for"
    );
    assert_eq!(retailer.capital_cents(), 100_000);
    assert_eq!(retailer.sell(1_000_000).0, 750, "no more than its stock");
    let (producer, _) = bench.land.trade(corner(1, 0));
    producer.set_prices(1, 1);
    assert_eq!(producer.selling_cents(), 10_000, "one price for all producers");
    assert_eq!(producer.take_in_crates(1_000), 50, "no more than the yard holds");
}

#[test]
fn a_retailer_moves_its_prices_with_what_is_taken() {
    let mut bench = Bench::new(999);
    for _ in 0..48 {
        bench.slot();
    }
    let retailer = bench.land.manager(corner(2, 0));
    assert!(
        retailer.buying_cents() > 12_000,
        "nobody brings crates: it pays more"
    );
    assert!(retailer.selling_cents() < 160, "nobody buys items: it asks less");
    let (crates, items) = (retailer.buying_cents(), retailer.selling_cents());
    assert!(crates <= items * 100 - 500, "never without its margin");
    for _ in 0..24 {
        bench.land.trade(corner(2, 0)).0.sell(10);
        bench.slot();
    }
    let retailer = bench.land.manager(corner(2, 0));
    assert!(
        retailer.selling_cents() > items,
        "scarce and sought: it asks more"
    );
}
