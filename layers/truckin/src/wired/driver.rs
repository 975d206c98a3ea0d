//! `truckin.driver`: a truck's four layers, deliberating step by step, one beat a phase.
//!
//! ```text
//!  idle ──a slot begins / genes──► hearing ──/ heard──► clearing ──/ cleared──► proposing ──/ the layers' plans──►
//!  selecting ──/ selected──► acting ──answer, plan goes on / next order──► acting
//!                              └──answer, plan is done──► hearing, or over when the slot is used up
//!  selecting ──nobody has a plan──► over ──the next slot begins / genes──► hearing
//! ```
//! The order is said again each beat, as a command to a body must be; between orders it is all zeros. The reset
//! line drops the turn and the short-term memory; what layers have learned in this game they keep. Must never
//! allocate in a beat, or act but by an order.

use afsm::{Beat, In, Module, ModuleKind, Out, Settings};
use backplane::{CommunicationBackplane, LayerId, Phase, SteppedTurn, TurnEnd};
use ipc::message::{Kind, Map};
use ipc::wiring::{Declaration, Parameter, Port};

use super::dials::{Dials, Reading};
use super::order::{Answer, Order, map_of, word_of, words_of};
use crate::ootland::truck::TruckLayer;
use crate::ootland::{Chance, TruckCreature, World};
use crate::strategies::{self, Allele, Chromosome, SLOTS, capital, gas, information, trading};

/// Words lie between this and its opposite: money in cents, and actions as one word.
pub const WORD_MAX: f64 = 1e15;

const DIALS: In<Map> = In::at(0);
const ANSWER: In<Map> = In::at(1);
const ORDER: Out<Map> = Out::at(0);
const GENES: Out<f64> = Out::at(1);
const HEARD: Out<Map> = Out::at(2);
const CLEARED: Out<f64> = Out::at(3);
const PLANS: [Out<Map>; 4] = [Out::at(4), Out::at(5), Out::at(6), Out::at(7)];
const SELECTED: Out<f64> = Out::at(8);

/// The kind `truckin.driver`.
pub static KIND: ModuleKind = ModuleKind {
    declaration: &DECLARATION,
    build: |s| Box::new(Driver::new(s)),
};

const fn words(name: &'static str, about: &'static str) -> Port {
    Port::new(name, Kind::Map, about).between(-WORD_MAX, WORD_MAX)
}

const fn names<const N: usize>(alleles: &'static [Allele]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut at = 0;
    while at < N {
        names[at] = alleles[at].name;
        at += 1;
    }
    names
}

static GAS: [&str; gas::ALLELES.len()] = names(gas::ALLELES);
static CAPITAL: [&str; capital::ALLELES.len()] = names(capital::ALLELES);
static TRADING: [&str; trading::ALLELES.len()] = names(trading::ALLELES);
static INFORMATION: [&str; information::ALLELES.len()] = names(information::ALLELES);

static DECLARATION: Declaration = Declaration {
    name: "truckin.driver",
    about: "drives a truck of Truckin': four layers in two phases around a backplane, one phase a beat",
    diagram: "idle --slot--> hearing -> clearing -> proposing -> selecting --plan--> acting --answers--> hearing; \
              selecting --no plan--> over --slot--> hearing; acting --slot used up--> over",
    inputs: &[
        words("dials", "what is free to know: see truckin::wired::dials"),
        words("answer", "what came of an order: see truckin::wired::order"),
    ],
    outputs: &[
        words(
            "order",
            "number, slot, action or end of turn; all zeros when there is none",
        ),
        Port::new("genes", Kind::Number, "the truck's name, once a turn"),
        words(
            "heard",
            "feedback: selections so far, layer held (-1: none), actions, code of each outcome",
        ),
        Port::new(
            "cleared",
            Kind::Number,
            "plans and inhibitions left in the short-term memory",
        ),
        words(
            "gas",
            "gas getting: whether inhibited, length of its plan, its actions",
        ),
        words("capital", "capital maintenance, likewise"),
        words("trading", "trading, likewise"),
        words("information", "information gathering, likewise"),
        Port::new(
            "selected",
            Kind::Number,
            "the layer that holds the truck, 0 is the lowest; -1: none",
        ),
    ],
    parameters: &[
        Parameter::word(
            "gas",
            &GAS,
            "cheapest_in_reach",
            "the micro-strategy for gas getting",
        ),
        Parameter::word(
            "capital",
            &CAPITAL,
            "only_at_a_profit",
            "the one for capital maintenance",
        ),
        Parameter::word("trading", &TRADING, "round_trip", "the one for trading"),
        Parameter::word(
            "information",
            &INFORMATION,
            "call_before_leaving",
            "the one for information gathering",
        ),
        Parameter::number(
            "seed",
            0.0,
            "draws as the first truck of this seed does in `truckin game`; 0: the module's own",
        )
        .between(0.0, 1e15)
        .unit("1"),
        Parameter::number("game", 0.0, "which of the games of the seed")
            .between(0.0, 1e15)
            .unit("1"),
    ],
};

struct Driver {
    genes: f64,
    layers: Vec<TruckLayer>,
    backplane: CommunicationBackplane<TruckCreature>,
    turn: SteppedTurn,
    dials: Dials,
    /// The slot that was begun last.
    slot: Option<u32>,
    /// The number of the order under way.
    asked: Option<u64>,
    selections: u32,
}

impl Driver {
    fn new(settings: &Settings<'_>) -> Self {
        let allele = |slot: usize, name: &str| {
            let word = settings.word(name);
            let place = SLOTS[slot].alleles.iter().position(|allele| allele.name == word);
            place.expect("the checker knows the words") as u8
        };
        let genes = [
            allele(0, "gas"),
            allele(1, "capital"),
            allele(2, "trading"),
            allele(3, "information"),
        ];
        let chromosome = Chromosome::new(genes).expect("genes by their names");
        let grid = World::default().grid;
        let mut cabins = match settings.number("seed") as u64 {
            0 => Chance::new(settings.seed(), 0),
            seed => Chance::new(seed, settings.number("game") as u64),
        };
        // As a game draws: the country first, then the trucks.
        let (_, mut cabin) = (cabins.fork(1), cabins.fork(2));
        let layers = strategies::build(&chromosome, grid, &mut cabin);
        Self {
            genes: genes
                .iter()
                .fold(0.0, |name, gene| name * 10.0 + f64::from(*gene)),
            backplane: CommunicationBackplane::new(layers.len()),
            layers,
            turn: SteppedTurn::default(),
            dials: Dials::new(grid),
            slot: None,
            asked: None,
            selections: 0,
        }
    }

    /// Takes in a new slot, or the answer that was waited for.
    fn take_in(&mut self, reading: &Reading, answer: Option<Answer>, beat: &mut Beat<'_>) {
        if self.slot != Some(reading.clock.slot) {
            self.slot = Some(reading.clock.slot);
            self.asked = None;
            self.dials.set(reading);
            self.turn.begin::<TruckCreature>(&self.dials.controller());
            beat.emit(GENES, self.genes);
        } else if let (Some(asked), Some(answer)) = (self.asked, answer)
            && (reading.answered, answer.number) == (asked, asked)
            && let Some(outcome) = answer.outcome
        {
            self.asked = None;
            self.dials.set(reading);
            let body = self.dials.controller();
            self.turn.answered(&mut self.backplane, outcome, &body);
        }
    }

    /// Does one phase and says what there is to be seen of it.
    fn deliberate(&mut self, beat: &mut Beat<'_>) {
        let phase = self.turn.phase();
        if phase == Phase::Hear {
            beat.emit(HEARD, self.heard());
        }
        let body = self.dials.controller();
        self.turn.step(&mut self.layers, &mut self.backplane, &body);
        match phase {
            Phase::Clear => beat.emit(CLEARED, self.remembered()),
            Phase::Propose => {
                for (rank, port) in PLANS.iter().enumerate() {
                    beat.emit(*port, self.proposed(LayerId(rank as u8)));
                }
            }
            Phase::Select => {
                self.selections += 1;
                let holder = self.backplane.selected().map(|selected| selected.layer.0);
                beat.emit(SELECTED, holder.map_or(-1.0, f64::from));
            }
            _ => {}
        }
    }

    /// What the layers are told in their feedback phase.
    fn heard(&self) -> Map {
        let mut words = [0.0; 12];
        words[0] = f64::from(self.selections);
        words[1] = -1.0;
        if let Some(selected) = self.backplane.selected() {
            words[1] = f64::from(selected.layer.0);
            words[2] = selected.plan.actions().len() as f64;
            for (word, outcome) in words[3..].iter_mut().zip(selected.outcomes) {
                *word = words_of(*outcome)[0];
            }
        }
        Map { ranges: words }
    }

    /// How many plans, inhibitions and selections the short-term memory holds.
    fn remembered(&self) -> f64 {
        let ranks = 0..self.backplane.layers() as u8;
        let control = ranks.map(|rank| self.backplane.control(LayerId(rank)));
        let held =
            control.map(|control| u32::from(!control.plan().is_empty()) + u32::from(control.is_inhibited()));
        f64::from(held.sum::<u32>() + u32::from(self.backplane.selected().is_some()))
    }

    /// What the backplane holds for one layer.
    fn proposed(&self, layer: LayerId) -> Map {
        let control = self.backplane.control(layer);
        let actions = control.plan().actions();
        let mut words = [0.0; 12];
        words[0] = f64::from(u8::from(control.is_inhibited()));
        words[1] = actions.len() as f64;
        for (word, action) in words[2..].iter_mut().zip(actions) {
            *word = word_of(*action);
        }
        Map { ranges: words }
    }

    /// The order that stands, if one does. `answered` is the last that was answered.
    fn order(&mut self, slot: u32, answered: u64) -> Map {
        let action = self.turn.wanted(&self.backplane);
        if action.is_none() && !matches!(self.turn.phase(), Phase::Over(_)) {
            return map_of(&[]);
        }
        let number = *self.asked.get_or_insert(answered + 1);
        Order { number, slot, action }.pack()
    }
}

impl Module for Driver {
    fn step(&mut self, beat: &mut Beat<'_>) {
        let grid = self.dials.controller().grid();
        let reading = beat.latest(DIALS).and_then(|words| Reading::of(&words, grid));
        let Some(reading) = reading.filter(|reading| reading.clock.slot < reading.clock.slots) else {
            beat.emit(ORDER, map_of(&[]));
            return;
        };
        let answer = beat.latest(ANSWER).map(|words| Answer::of(&words));
        self.take_in(&reading, answer, beat);
        self.deliberate(beat);
        beat.emit(ORDER, self.order(reading.clock.slot, reading.answered));
    }

    fn reset(&mut self) {
        self.turn = SteppedTurn::default();
        self.backplane.clear();
        self.slot = None;
        self.asked = None;
        self.selections = 0;
    }

    fn state(&self) -> &'static str {
        match self.turn.phase() {
            Phase::Idle => "idle",
            Phase::Hear => "hearing",
            Phase::Clear => "clearing",
            Phase::Propose => "proposing",
            Phase::Select => "selecting",
            Phase::Act => "acting",
            Phase::Over(TurnEnd::SlotUsedUp | TurnEnd::NothingToDo | TurnEnd::CutShort) => "over",
        }
    }
}
