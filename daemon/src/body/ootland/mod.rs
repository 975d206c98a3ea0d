//! `ootland`: a truck's body in the country of Truckin' (Gantchev 2001), a world that goes by turns.
//!
//! ```text
//!  in:  order (one action of the truck, or the end of its turn)     out: dials, answer
//!
//!  closed ──the pace lets the next slot begin──► open ──order: carried out, answered──► open
//!    ▲                                             └──end of turn, or patience is over──► closed
//!    └── a slot in which the truck is still on the road
//! ```
//! Dealers and the other trucks play when a slot opens and when it closes. While the gate is closed no order
//! comes through, and the country goes on without the truck when its patience is over. Must never do for the
//! truck what its controller would not.

use std::sync::Arc;

use ipc::clock::{Span, Time};
use ipc::message::{Map, Payload};
use ipc::wiring::Setting;
use serde_json::{Value, json};
use truckin::ootland::{Chance, Game, GameView, Seat, World as Country};
use truckin::strategies::{Chromosome, SLOTS, all_chromosomes};
use truckin::wired::dials::Reading;
use truckin::wired::{Answer, Order};

use super::pace::Pace;
use super::{BodyKind, Place, World, WorldEnd};

mod curve;
mod declaration;

use curve::Curve;
use declaration::{ANSWER, DECLARATION, DIALS, ORDER};

/// The kind `ootland`.
pub static KIND: BodyKind = BodyKind {
    declaration: &DECLARATION,
    motion: &[ORDER],
    forward: None,
    stale: Span::millis(200),
    build,
};

/// Least time between two pictures for those who watch.
const PICTURE: Span = Span::millis(50);

/// The truck's seat in the game: the first.
const SEAT: usize = 0;

/// A truck and its country.
pub struct OotlandWorld {
    seat: Seat,
    pace: Arc<Pace>,
    slot: Span,
    patience: Span,
    /// When the last slot was opened.
    opened: Option<Time>,
    last: Answer,
    curve: Curve,
    picture: Value,
    pictured: Option<Time>,
}

fn build(settings: &[Setting], seed: u64, _: Option<Place>) -> Box<dyn World> {
    let [
        Setting::Number(others),
        Setting::Number(slots),
        Setting::Span(slot),
        Setting::Span(patience),
        Setting::Number(own_seed),
        Setting::Number(game),
    ] = settings
    else {
        panic!("settings of OOTland are checked");
    };
    let seed = match *own_seed as u64 {
        0 => seed,
        own => own,
    };
    let trucks = trucks(*others as usize, seed, *game as u64);
    let game = Game::new(&Country::default(), &trucks, *slots as u32, seed, *game as u64);
    Box::new(OotlandWorld::new(game, *slot, *patience))
}

/// The trucks of a game: in the first seat one that is never asked, then others drawn from all there are.
pub fn trucks(others: usize, seed: u64, game: u64) -> Vec<Chromosome> {
    let all = all_chromosomes();
    let mut chance = Chance::new(seed.wrapping_add(1), game);
    let mut draw = || all[chance.below(all.len() as u32) as usize];
    let mut trucks = vec![all[0]];
    trucks.extend((0..others).map(|_| draw()));
    trucks
}

impl OotlandWorld {
    /// The first seat of `game`; a slot lasts at least `slot`, a turn `patience` at most.
    pub fn new(game: Game, slot: Span, patience: Span) -> OotlandWorld {
        let mut world = OotlandWorld {
            seat: Seat::new(game, SEAT),
            pace: Arc::default(),
            slot,
            patience,
            opened: None,
            last: Answer {
                number: 0,
                outcome: None,
            },
            curve: Curve::default(),
            picture: Value::Null,
            pictured: None,
        };
        world.curve.note(world.seat.game());
        world
    }

    /// The game as it stands.
    pub fn game(&self) -> &Game {
        self.seat.game()
    }

    /// Opens the next slot if it is time.
    fn open(&mut self, now: Time) {
        let since = self.opened.map_or(Span(u64::MAX), |opened| now.since(opened));
        if self.seat.game().is_over() || self.seat.is_open() || !self.pace.next(since, self.slot) {
            return;
        }
        self.seat.open();
        self.opened = Some(now);
        if self.seat.book().left_minutes() <= 0 {
            self.close();
        }
    }

    /// Carries out `order` if it is the next one of this slot.
    fn obey(&mut self, order: Order) {
        let this = order.slot == self.seat.game().clock().slot && order.number == self.last.number + 1;
        if !this || !self.seat.is_open() {
            return;
        }
        let outcome = order.action.map(|action| self.seat.act(action));
        self.last = Answer {
            number: order.number,
            outcome,
        };
        if order.action.is_none() {
            self.close();
        }
    }

    fn close(&mut self) {
        self.seat.close();
        self.curve.note(self.seat.game());
    }

    fn reading(&self) -> Reading {
        Reading {
            clock: self.seat.game().clock(),
            answered: self.last.number,
            book: *self.seat.book(),
            here: self.seat.dealer_here(),
        }
    }

    fn draw(&self) -> Value {
        let view = GameView::of(self.seat.game());
        let mut drawn = serde_json::to_value(view).expect("numbers and words make JSON");
        if let Some(truck) = drawn.pointer_mut(&format!("/trucks/{SEAT}")) {
            // Its layers are not here: the page finds them on wires.
            truck["wired"] = json!(true);
            truck["chromosome"] = json!(null);
            truck["layers"] = json!([]);
        }
        drawn["open"] = json!(self.seat.is_open());
        drawn["pace"] = json!(self.pace.word());
        drawn["curve"] = self.curve.drawn();
        drawn
    }
}

impl World for OotlandWorld {
    fn tick(&mut self, now: Time, link: &mut WorldEnd) {
        let words = link.motion(ORDER);
        if let Some(order) = Order::of(&Map::unpack(&words)) {
            self.obey(order);
        }
        if self.seat.is_open()
            && self
                .opened
                .is_some_and(|opened| now.since(opened) >= self.patience)
        {
            self.close();
        }
        self.open(now);
        if self.seat.is_open() {
            link.tell(DIALS, now, &self.reading().pack().pack());
        }
        link.tell(ANSWER, now, &self.last.pack().pack());
        if self.pictured.is_none_or(|last| now.since(last) >= PICTURE) {
            self.pictured = Some(now);
            self.picture = self.draw();
        }
    }

    fn view(&self) -> Value {
        json!({ "ootland": self.picture })
    }

    fn floor(&self) -> Value {
        let slots = SLOTS.iter().map(|slot| {
            let alleles = slot.alleles.iter();
            let alleles: Vec<Value> = alleles
                .map(|a| json!({"name": a.name, "idea": a.idea()}))
                .collect();
            json!({"name": slot.name, "alleles": alleles})
        });
        let slots: Vec<Value> = slots.collect();
        json!({ "ootland": { "slots": slots } })
    }

    fn pace(&self) -> Option<Arc<Pace>> {
        Some(self.pace.clone())
    }
}
