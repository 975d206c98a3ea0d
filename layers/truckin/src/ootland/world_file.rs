//! A world in TOML: read, checked as a whole, every fault with its line and column.
//!
//! ```toml
//! avenues = 10
//! streets = 10
//!
//! [economy]
//! crate_cents = 10000
//! gas_cents = [80, 130]
//!
//! [scattered]
//! producer = 6
//!
//! [[dealer]]
//! at = [3, 4]            # avenue, street, counted from 0
//! kind = "retailer"
//! buying_cents = 12000
//! selling_cents = 160
//! ```

use std::fmt;

use toml_span::value::{Table, Value, ValueInner};
use toml_span::{Span, parse};

use super::dealers::Kind;
use super::grid::{Grid, SIDE_MAX};
use super::rules::{ITEMS_PER_CRATE, UNIT_CENTS_MAX};
use super::world::{Economy, FixedDealer, World};

/// Prices and quantities in a world file at most, so that no product of two leaves 64 bits.
pub const AMOUNT_MAX: i64 = 10_000_000;
/// Capital in a world file at most, in cents.
pub const CAPITAL_CENTS_MAX: i64 = 1_000_000_000_000;

/// Something wrong in a world file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorldFault {
    /// Line, counted from 1.
    pub line: usize,
    /// Column, counted from 1.
    pub column: usize,
    /// What is wrong and what was expected.
    pub what: String,
}

impl fmt::Display for WorldFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}:{}: {}", self.line, self.column, self.what)
    }
}

/// Reads and checks the text of a world file.
///
/// # Errors
/// Every fault found, in the order of their places.
pub fn read(text: &str) -> Result<World, Vec<WorldFault>> {
    let mut reader = Reader {
        text,
        faults: Vec::new(),
    };
    let mut root = match parse(text) {
        Ok(root) => root,
        Err(wrong) => {
            reader.fault(wrong.span, format!("not TOML: {}", wrong.kind));
            return Err(reader.faults);
        }
    };
    let world = reader.world(&mut root);
    if reader.faults.is_empty() {
        return Ok(world);
    }
    reader.faults.sort_by_key(|fault| (fault.line, fault.column));
    Err(reader.faults)
}

struct Reader<'t> {
    text: &'t str,
    faults: Vec<WorldFault>,
}

impl Reader<'_> {
    fn fault(&mut self, span: Span, what: impl Into<String>) {
        let (line, column) = place(self.text, span.start);
        self.faults.push(WorldFault {
            line,
            column,
            what: what.into(),
        });
    }

    fn world(&mut self, root: &mut Value<'_>) -> World {
        let mut world = World::default();
        let whole = root.span;
        let Some(mut table) = self.table(root) else {
            return world;
        };
        let side = (1, i64::from(SIDE_MAX));
        let avenues = self
            .number(&mut table, "avenues", side)
            .map_or(world.grid.avenues, |n| n as u16);
        let streets = self
            .number(&mut table, "streets", side)
            .map_or(world.grid.streets, |n| n as u16);
        world.grid = Grid { avenues, streets };
        if let Some(mut economy) = table.remove("economy") {
            self.economy(&mut economy, &mut world.economy);
        }
        if let Some(mut scattered) = table.remove("scattered") {
            world.scattered = self.scattered(&mut scattered);
        }
        if let Some(mut dealers) = table.remove("dealer") {
            world.dealers = self.dealers(&mut dealers, world.grid);
        }
        self.no_more(&table, "a world");
        let scattered: usize = world.scattered.iter().map(|(_, count)| usize::from(*count)).sum();
        let (count, corners) = (scattered + world.dealers.len(), world.grid.corners());
        if count > corners {
            self.fault(whole, format!("{count} dealers do not fit on {corners} corners"));
        }
        world
    }

    fn economy(&mut self, value: &mut Value<'_>, economy: &mut Economy) {
        let Some(mut table) = self.table(value) else {
            return;
        };
        let some = (1, AMOUNT_MAX);
        let any = (0, AMOUNT_MAX);
        let fields: [(&'static str, &mut i32, (i64, i64)); 9] = [
            ("crate_cents", &mut economy.crate_cents, some),
            ("crates_per_100_slots", &mut economy.crates_per_100_slots, any),
            ("yard_crates", &mut economy.yard_crates, any),
            ("item_cents", &mut economy.item_cents, some),
            ("items_per_100_slots", &mut economy.items_per_100_slots, any),
            ("wanted_items_max", &mut economy.wanted_items_max, any),
            ("retailer_margin_cents", &mut economy.retailer_margin_cents, any),
            ("retailer_crates", &mut economy.retailer_crates, (1, 1_000_000)),
            (
                "retailer_items",
                &mut economy.retailer_items,
                (i64::from(ITEMS_PER_CRATE), AMOUNT_MAX),
            ),
        ];
        for (key, field, limits) in fields {
            if let Some(number) = self.number(&mut table, key, limits) {
                *field = number as i32;
            }
        }
        if let Some(cents) = self.number(&mut table, "retailer_capital_cents", (0, CAPITAL_CENTS_MAX)) {
            economy.retailer_capital_cents = cents;
        }
        let ranges = [
            (
                "retailer_buying_cents",
                &mut economy.retailer_buying_cents,
                AMOUNT_MAX,
            ),
            (
                "retailer_selling_cents",
                &mut economy.retailer_selling_cents,
                i64::from(UNIT_CENTS_MAX),
            ),
            ("gas_cents", &mut economy.gas_cents, i64::from(UNIT_CENTS_MAX)),
        ];
        for (key, field, limit) in ranges {
            if let Some((low, high)) = self.range(&mut table, key, limit) {
                *field = (low as i32, high as i32);
            }
        }
        self.no_more(&table, "the economy");
    }

    fn scattered(&mut self, value: &mut Value<'_>) -> Vec<(Kind, u16)> {
        let Some(mut table) = self.table(value) else {
            return Vec::new();
        };
        let limits = (0, i64::from(SIDE_MAX) * i64::from(SIDE_MAX));
        let mut scattered = Vec::new();
        for kind in &Kind::ALL[1..] {
            if let Some(count) = self.number(&mut table, kind.name(), limits) {
                scattered.push((*kind, count as u16));
            }
        }
        self.no_more(&table, "scattered dealers");
        scattered
    }

    fn dealers(&mut self, value: &mut Value<'_>, grid: Grid) -> Vec<FixedDealer> {
        let span = value.span;
        let ValueInner::Array(list) = value.take() else {
            self.fault(span, "expected [[dealer]] tables");
            return Vec::new();
        };
        let mut dealers: Vec<FixedDealer> = Vec::new();
        for mut value in list {
            let span = value.span;
            let Some(mut table) = self.table(&mut value) else {
                continue;
            };
            let at = table.get("at").map_or(span, |at| at.span);
            let Some(dealer) = self.dealer(&mut table, span, grid) else {
                continue;
            };
            let place = grid.place(dealer.corner);
            if dealers.iter().any(|other| other.corner == dealer.corner) {
                let (avenue, street) = place;
                self.fault(at, format!("a second dealer at avenue {avenue}, street {street}"));
                continue;
            }
            dealers.push(dealer);
        }
        dealers
    }

    fn dealer(&mut self, table: &mut Table<'_>, span: Span, grid: Grid) -> Option<FixedDealer> {
        let corner = self.place(table, span, grid);
        let kind = self.kind(table, span);
        let mut prices = [None, None];
        for (price, key) in prices.iter_mut().zip(["buying_cents", "selling_cents"]) {
            let place = table.get(key).map_or(span, |value| value.span);
            let limit = if key == "buying_cents" {
                AMOUNT_MAX
            } else {
                i64::from(UNIT_CENTS_MAX)
            };
            *price = self.number(table, key, (1, limit)).map(|cents| cents as i32);
            let own = match kind {
                Some(Kind::Retailer) => true,
                Some(Kind::GasStation) => key == "selling_cents",
                _ => false,
            };
            if let (Some(_), false, Some(kind)) = (*price, own, kind) {
                self.fault(place, format!("a {} sets no {key} of its own", kind.name()));
            }
        }
        self.no_more(table, "a dealer");
        let [buying_cents, selling_cents] = prices;
        Some(FixedDealer {
            corner: corner?,
            kind: kind?,
            buying_cents,
            selling_cents,
        })
    }

    fn place(&mut self, table: &mut Table<'_>, span: Span, grid: Grid) -> Option<super::Corner> {
        let Some(mut at) = table.remove("at") else {
            self.fault(span, "a dealer needs at = [avenue, street]");
            return None;
        };
        let span = at.span;
        let numbers = match at.take() {
            ValueInner::Array(list) => list.iter().map(|value| value.as_integer()).collect::<Vec<_>>(),
            _ => Vec::new(),
        };
        let [Some(avenue), Some(street)] = numbers[..] else {
            self.fault(span, "expected at = [avenue, street]");
            return None;
        };
        let corner = u16::try_from(avenue)
            .ok()
            .zip(u16::try_from(street).ok())
            .and_then(|(avenue, street)| grid.corner(avenue, street));
        if corner.is_none() {
            let (avenues, streets) = (grid.avenues - 1, grid.streets - 1);
            self.fault(
                span,
                format!("no such corner: avenues go from 0 to {avenues}, streets to {streets}"),
            );
        }
        corner
    }

    fn kind(&mut self, table: &mut Table<'_>, span: Span) -> Option<Kind> {
        let Some(value) = table.remove("kind") else {
            self.fault(span, "a dealer needs a kind");
            return None;
        };
        let kind = Kind::ALL
            .into_iter()
            .find(|kind| value.as_str() == Some(kind.name()));
        if kind.is_none() {
            let found = &self.text[value.span.start..value.span.end];
            let what =
                format!("expected one of none, producer, retailer, consumer, gas_station, found {found}");
            self.fault(value.span, what);
        }
        kind
    }

    fn table<'a>(&mut self, value: &mut Value<'a>) -> Option<Table<'a>> {
        let span = value.span;
        match value.take() {
            ValueInner::Table(table) => Some(table),
            other => {
                self.fault(span, format!("expected a table, found {}", other.type_str()));
                None
            }
        }
    }

    fn number(&mut self, table: &mut Table<'_>, key: &'static str, limits: (i64, i64)) -> Option<i64> {
        let value = table.remove(key)?;
        self.limited(key, &value, limits)
    }

    fn limited(&mut self, key: &str, value: &Value<'_>, (least, most): (i64, i64)) -> Option<i64> {
        let number = value
            .as_integer()
            .filter(|number| (least..=most).contains(number));
        if number.is_none() {
            let found = &self.text[value.span.start..value.span.end];
            let what = format!("{key}: expected a whole number from {least} to {most}, found {found}");
            self.fault(value.span, what);
        }
        number
    }

    fn range(&mut self, table: &mut Table<'_>, key: &'static str, most: i64) -> Option<(i64, i64)> {
        let mut value = table.remove(key)?;
        let span = value.span;
        let ends = match value.take() {
            ValueInner::Array(list) if list.len() == 2 => list,
            _ => {
                self.fault(span, format!("{key}: expected [lowest, highest]"));
                return None;
            }
        };
        let low = self.limited(key, &ends[0], (1, most))?;
        let high = self.limited(key, &ends[1], (1, most))?;
        if low > high {
            self.fault(span, format!("{key}: lowest {low} is above highest {high}"));
            return None;
        }
        Some((low, high))
    }

    fn no_more(&mut self, table: &Table<'_>, of_what: &str) {
        for key in table.keys() {
            self.fault(key.span, format!("{of_what} has no \"{}\"", key.name));
        }
    }
}

/// Line and column, counted from 1, of a byte of the text.
fn place(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (
        before.matches('\n').count() + 1,
        before[line_start..].chars().count() + 1,
    )
}
