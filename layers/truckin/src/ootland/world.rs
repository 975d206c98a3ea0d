//! A world: the description a game's country is drawn from. Immutable once checked.

use super::chance::Chance;
use super::dealer_manager::{Card, Manager, Opening};
use super::dealers::{Consumer, Dealer, GasStation, Idle, Kind, Producer, Retailer};
use super::grid::{Corner, Grid};
use super::land::{Land, Stand};

/// What dealers of each kind open with. Ranges are drawn from for each dealer and game.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Economy {
    /// Price of a crate at every producer, in cents.
    pub crate_cents: i32,
    /// Crates a producer makes in 100 slots.
    pub crates_per_100_slots: i32,
    /// Crates a producer's yard holds.
    pub yard_crates: i32,
    /// What every consumer pays for an item, in cents.
    pub item_cents: i32,
    /// Items a consumer wants in 100 slots.
    pub items_per_100_slots: i32,
    /// Items a consumer goes on wanting at most.
    pub wanted_items_max: i32,
    /// A retailer's opening price for crates, in cents, lowest and highest.
    pub retailer_buying_cents: (i32, i32),
    /// A retailer's opening price for items, in cents, lowest and highest.
    pub retailer_selling_cents: (i32, i32),
    /// A retailer's least margin on a crate, in cents.
    pub retailer_margin_cents: i32,
    /// A retailer's opening capital, in cents.
    pub retailer_capital_cents: i64,
    /// Crates a retailer has room for.
    pub retailer_crates: i32,
    /// Items a retailer has room for.
    pub retailer_items: i32,
    /// A gas station's price for a litre, in cents, lowest and highest.
    pub gas_cents: (i32, i32),
}

impl Default for Economy {
    /// Prices as in the source's examples. Quantities such that the trade of the whole country, about
    /// 80 items a slot at a dollar from producer to consumer, feeds 20 trucks that burn up to $1.70 of
    /// gas a slot each, but not 20 careless ones.
    fn default() -> Self {
        Self {
            crate_cents: 10_000,
            crates_per_100_slots: 16,
            yard_crates: 100,
            item_cents: 200,
            items_per_100_slots: 1_000,
            wanted_items_max: 2_000,
            retailer_buying_cents: (10_800, 13_500),
            retailer_selling_cents: (145, 185),
            retailer_margin_cents: 500,
            retailer_capital_cents: 300_000,
            retailer_crates: 40,
            retailer_items: 3_000,
            gas_cents: (80, 130),
        }
    }
}

/// A dealer whose corner is fixed in the world file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedDealer {
    /// Where.
    pub corner: Corner,
    /// What kind.
    pub kind: Kind,
    /// Its opening buying price in cents, if the world fixes that too.
    pub buying_cents: Option<i32>,
    /// Its opening selling price in cents, if the world fixes that too.
    pub selling_cents: Option<i32>,
}

/// Everything a country is drawn from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct World {
    /// The size of the country.
    pub grid: Grid,
    /// What dealers open with.
    pub economy: Economy,
    /// Dealers at corners of their own.
    pub dealers: Vec<FixedDealer>,
    /// Dealers of each kind at corners drawn for each game.
    pub scattered: Vec<(Kind, u16)>,
}

impl Default for World {
    /// Ten by ten, 6 producers, 8 retailers, 8 consumers and 6 gas stations at corners drawn for each
    /// game, prices as in the source's examples.
    fn default() -> Self {
        Self {
            grid: Grid {
                avenues: 10,
                streets: 10,
            },
            economy: Economy::default(),
            dealers: Vec::new(),
            scattered: vec![
                (Kind::Producer, 6),
                (Kind::Retailer, 8),
                (Kind::Consumer, 8),
                (Kind::GasStation, 6),
            ],
        }
    }
}

impl World {
    /// Draws a country.
    ///
    /// # Panics
    /// When there are more dealers than corners; a world from a file has been checked.
    pub fn open(&self, chance: &mut Chance) -> Land {
        let mut stands: Vec<Option<Stand>> = vec![None; self.grid.corners()];
        for fixed in &self.dealers {
            stands[usize::from(fixed.corner.0)] = Some(self.stand(fixed, chance));
        }
        let mut free: Vec<u16> = (0..stands.len() as u16)
            .filter(|corner| stands[usize::from(*corner)].is_none())
            .collect();
        chance.shuffle(&mut free);
        for &(kind, count) in &self.scattered {
            for _ in 0..count {
                let corner = free.pop().expect("a corner for every dealer");
                let fixed = FixedDealer {
                    corner: Corner(corner),
                    kind,
                    buying_cents: None,
                    selling_cents: None,
                };
                stands[usize::from(corner)] = Some(self.stand(&fixed, chance));
            }
        }
        let idle = |corner: usize| {
            let corner = Corner(corner as u16);
            FixedDealer {
                corner,
                kind: Kind::Idle,
                buying_cents: None,
                selling_cents: None,
            }
        };
        let stands = stands
            .into_iter()
            .enumerate()
            .map(|(corner, stand)| stand.unwrap_or_else(|| self.stand(&idle(corner), &mut chance.clone())))
            .collect();
        Land::new(self.grid, stands)
    }

    /// Draws one dealer and opens its books.
    fn stand(&self, fixed: &FixedDealer, chance: &mut Chance) -> Stand {
        let economy = &self.economy;
        let mut card = Card {
            kind: fixed.kind,
            buying_cents: 0,
            selling_cents: 0,
        };
        let mut opening = Opening::of(card);
        let dealer = match fixed.kind {
            Kind::Idle => Dealer::Idle(Idle),
            Kind::Producer => {
                card.selling_cents = economy.crate_cents;
                opening.crate_storage = economy.yard_crates;
                opening.crates = economy.yard_crates / 2;
                Dealer::Producer(Producer {
                    crates_per_100_slots: economy.crates_per_100_slots,
                    begun: 0,
                })
            }
            Kind::Retailer => {
                let (low, high) = economy.retailer_buying_cents;
                let buying = chance.between(low, high);
                card.buying_cents = fixed.buying_cents.unwrap_or(buying);
                let (low, high) = economy.retailer_selling_cents;
                let selling = chance.between(low, high);
                card.selling_cents = fixed.selling_cents.unwrap_or(selling);
                opening.capital_cents = economy.retailer_capital_cents;
                opening.crate_storage = economy.retailer_crates;
                opening.item_storage = economy.retailer_items;
                opening.items = economy.retailer_items / 4;
                Dealer::Retailer(Retailer {
                    until_prices: chance.below(12),
                    margin_cents: economy.retailer_margin_cents,
                    opening_cents: (card.buying_cents, card.selling_cents),
                    bought_then: 0,
                    sold_then: 0,
                })
            }
            Kind::Consumer => {
                card.buying_cents = economy.item_cents;
                opening.item_storage = economy.wanted_items_max;
                Dealer::Consumer(Consumer {
                    items_per_100_slots: economy.items_per_100_slots,
                    begun: 0,
                })
            }
            Kind::GasStation => {
                let (low, high) = economy.gas_cents;
                let selling = chance.between(low, high);
                card.selling_cents = fixed.selling_cents.unwrap_or(selling);
                Dealer::GasStation(GasStation)
            }
        };
        opening.card = card;
        Stand {
            manager: Manager::new(opening),
            dealer,
        }
    }
}
