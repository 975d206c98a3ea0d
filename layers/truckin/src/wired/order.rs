//! Orders and answers, word by word: what a truck wants done, and what came of it.
//!
//! Must never turn a word that no truck wrote into an action: what is not one reads as nothing.

use ipc::message::Map;

use crate::ootland::action::Refusal;
use crate::ootland::{Card, Commodity, Corner, Direction, Kind, Outcome, TruckAction};

/// An action is one word: what it is, times this, and its operand. Quantities are far smaller.
const VERB: f64 = 1e10;
/// A direction, times this, and the steps.
const DIRECTION: f64 = 1000.0;
const MOVE: f64 = 1.0;
const BUY: f64 = 2.0;
const SELL: f64 = 3.0;
const PHONE: f64 = 4.0;
/// The word that ends a turn.
const PASS: f64 = 5.0 * VERB;

const REFUSALS: [Refusal; 9] = [
    Refusal::NoTimeInSlot,
    Refusal::NoTimeInGame,
    Refusal::NoMoney,
    Refusal::NoGas,
    Refusal::TankFull,
    Refusal::NoStock,
    Refusal::NoRoad,
    Refusal::NotTradedHere,
    Refusal::NothingAsked,
];
const COMMODITIES: [Commodity; 3] = [Commodity::Crates, Commodity::Items, Commodity::Gas];

/// The element of `all` that stands where `word` says.
fn pick<T: Copy>(all: &[T], word: f64) -> Option<T> {
    let whole = word >= 0.0 && word.fract() == 0.0;
    all.get(word as usize).copied().filter(|_| whole)
}

/// Where `one` stands in `all`.
fn place<T: PartialEq>(all: &[T], one: &T) -> f64 {
    let place = all.iter().position(|other| other == one);
    place.expect("all of them are in the list") as f64
}

/// A whole number that fits, or nothing.
fn whole(word: f64, most: f64) -> Option<f64> {
    (word.fract() == 0.0 && (0.0..=most).contains(&word)).then_some(word)
}

/// An action as one word: 1 is move, 2 buy, 3 sell, 4 phone, each times 10^10; then the units, the corner, or
/// the direction (0 is north, clockwise) times 1000 and the steps.
pub fn word_of(action: TruckAction) -> f64 {
    match action {
        TruckAction::Move(direction, steps) => {
            MOVE * VERB + DIRECTION * place(&Direction::ALL, &direction) + f64::from(steps)
        }
        TruckAction::Buy(units) => BUY * VERB + f64::from(units.max(0)),
        TruckAction::Sell(units) => SELL * VERB + f64::from(units.max(0)),
        TruckAction::Phone(corner) => PHONE * VERB + f64::from(corner.0),
    }
}

/// The action of a word; nothing when it is none.
pub fn action_of(word: f64) -> Option<TruckAction> {
    let verb = (word / VERB).floor();
    let operand = word - verb * VERB;
    if verb == MOVE {
        let direction = (operand / DIRECTION).floor();
        let steps = whole(operand - direction * DIRECTION, f64::from(u8::MAX))?;
        return Some(TruckAction::Move(pick(&Direction::ALL, direction)?, steps as u8));
    }
    if verb == PHONE {
        return Some(TruckAction::Phone(Corner(
            whole(operand, f64::from(u16::MAX))? as u16
        )));
    }
    let units = whole(operand, f64::from(i32::MAX))? as i32;
    if verb == BUY {
        Some(TruckAction::Buy(units))
    } else if verb == SELL {
        Some(TruckAction::Sell(units))
    } else {
        None
    }
}

/// What a truck tells its body. On the wire: number, slot, word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// One more than the number that was answered last.
    pub number: u64,
    /// The slot it is meant for.
    pub slot: u32,
    /// What to do; nothing when the turn is over.
    pub action: Option<TruckAction>,
}

impl Order {
    /// As a message.
    pub fn pack(self) -> Map {
        let word = self.action.map_or(PASS, word_of);
        map_of(&[self.number as f64, f64::from(self.slot), word])
    }

    /// The order in a message; nothing when there is none, as while a gate is closed.
    pub fn of(map: &Map) -> Option<Self> {
        let [number, slot, word, ..] = map.ranges;
        let action = match word == PASS {
            true => None,
            false => Some(action_of(word)?),
        };
        Some(Self {
            number: whole(number, 9e15)? as u64,
            slot: whole(slot, f64::from(u32::MAX))? as u32,
            action,
        })
    }
}

/// What a body answers. On the wire: number, then what it came to (see [`words_of`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    /// The order's.
    pub number: u64,
    /// What came of it; nothing of the end of a turn.
    pub outcome: Option<Outcome>,
}

impl Answer {
    /// As a message.
    pub fn pack(self) -> Map {
        let [code, a, b, c, d] = self.outcome.map_or([0.0; 5], words_of);
        map_of(&[self.number as f64, code, a, b, c, d])
    }

    /// The answer in a message.
    pub fn of(map: &Map) -> Self {
        let [number, code, a, b, c, d, ..] = map.ranges;
        Self {
            number: number as u64,
            outcome: outcome_of([code, a, b, c, d]),
        }
    }
}

/// An outcome as words: 1 moved (corner, steps), 2 bought and 3 sold (commodity, asked, units, cents), 4 told
/// (corner, kind, buying, selling), 5 ignored (why).
pub fn words_of(outcome: Outcome) -> [f64; 5] {
    match outcome {
        Outcome::Moved { corner, steps } => [1.0, f64::from(corner.0), f64::from(steps), 0.0, 0.0],
        Outcome::Bought {
            commodity,
            asked,
            units,
            cents,
        } => {
            let what = place(&COMMODITIES, &commodity);
            [2.0, what, f64::from(asked), f64::from(units), cents as f64]
        }
        Outcome::Sold {
            commodity,
            offered,
            units,
            cents,
        } => {
            let what = place(&COMMODITIES, &commodity);
            [3.0, what, f64::from(offered), f64::from(units), cents as f64]
        }
        Outcome::Told { corner, card } => {
            let (buying, selling) = (f64::from(card.buying_cents), f64::from(card.selling_cents));
            [
                4.0,
                f64::from(corner.0),
                f64::from(card.kind as u8),
                buying,
                selling,
            ]
        }
        Outcome::Ignored(refusal) => [5.0, place(&REFUSALS, &refusal), 0.0, 0.0, 0.0],
    }
}

fn outcome_of([code, a, b, c, d]: [f64; 5]) -> Option<Outcome> {
    match code as u8 {
        1 => Some(Outcome::Moved {
            corner: Corner(a as u16),
            steps: b as u8,
        }),
        2 => Some(Outcome::Bought {
            commodity: pick(&COMMODITIES, a)?,
            asked: b as i32,
            units: c as i32,
            cents: d as i64,
        }),
        3 => Some(Outcome::Sold {
            commodity: pick(&COMMODITIES, a)?,
            offered: b as i32,
            units: c as i32,
            cents: d as i64,
        }),
        4 => Some(Outcome::Told {
            corner: Corner(a as u16),
            card: card_of([b, c, d])?,
        }),
        5 => Some(Outcome::Ignored(pick(&REFUSALS, a)?)),
        _ => None,
    }
}

/// A dealer's card of its kind and two prices.
pub(super) fn card_of([kind, buying, selling]: [f64; 3]) -> Option<Card> {
    Some(Card {
        kind: pick(&Kind::ALL, kind)?,
        buying_cents: buying as i32,
        selling_cents: selling as i32,
    })
}

/// A message of these words; the rest is zero.
pub(super) fn map_of(words: &[f64]) -> Map {
    let mut ranges = [0.0; 12];
    ranges[..words.len()].copy_from_slice(words);
    Map { ranges }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_and_every_outcome_goes_round() {
        let mut actions = vec![
            TruckAction::Buy(0),
            TruckAction::Buy(i32::MAX),
            TruckAction::Sell(1_000_000_000),
            TruckAction::Phone(Corner(9_999)),
        ];
        actions.extend(Direction::ALL.map(|direction| TruckAction::Move(direction, 99)));
        for action in actions {
            assert_eq!(action_of(word_of(action)), Some(action));
            let order = Order {
                number: 1 << 50,
                slot: 9_999_999,
                action: Some(action),
            };
            assert_eq!(Order::of(&order.pack()), Some(order));
        }
        let card = Card {
            kind: Kind::Retailer,
            buying_cents: 10_800,
            selling_cents: 145,
        };
        let mut outcomes = vec![
            Outcome::Moved {
                corner: Corner(99),
                steps: 9,
            },
            Outcome::Told {
                corner: Corner(3),
                card,
            },
        ];
        outcomes.extend(REFUSALS.map(Outcome::Ignored));
        for commodity in COMMODITIES {
            let (asked, units, cents) = (1_000_000_000, 999, 10_000_000_000_000);
            outcomes.push(Outcome::Bought {
                commodity,
                asked,
                units,
                cents,
            });
            let offered = asked;
            outcomes.push(Outcome::Sold {
                commodity,
                offered,
                units,
                cents,
            });
        }
        for outcome in outcomes {
            let answer = Answer {
                number: 7,
                outcome: Some(outcome),
            };
            assert_eq!(Answer::of(&answer.pack()), answer);
        }
    }

    #[test]
    fn what_is_no_order_reads_as_none() {
        for word in [
            0.0,
            0.5,
            -VERB,
            VERB * 1.5,
            2.0 * VERB + 0.5,
            6.0 * VERB,
            VERB + 7_000.0,
        ] {
            assert_eq!(Order::of(&map_of(&[1.0, 1.0, word])), None, "{word}");
        }
        assert_eq!(Order::of(&map_of(&[0.5, 1.0, PASS])), None);
        assert_eq!(Order::of(&map_of(&[])), None, "a closed gate");
    }
}
