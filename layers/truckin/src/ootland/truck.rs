//! A truck: four layers named by a chromosome, and the backplane between them.

use backplane::{BehaviourLayer, CommunicationBackplane, TurnEnd, take_turn};

use super::action::TruckCreature;
use super::chance::Chance;
use super::controller::Controller;
use super::grid::Grid;
use crate::strategies::{self, Chromosome};

/// Any layer of a truck.
pub type TruckLayer = Box<dyn BehaviourLayer<TruckCreature> + Send>;

/// One truck in one game.
pub struct Truck {
    chromosome: Chromosome,
    layers: Vec<TruckLayer>,
    backplane: CommunicationBackplane<TruckCreature>,
    last_turn: Option<TurnEnd>,
}

impl Truck {
    /// Plugs the micro-strategies the chromosome names into their slots. Everything a truck ever
    /// allocates is allocated here.
    pub fn new(chromosome: Chromosome, grid: Grid, chance: &mut Chance) -> Self {
        let layers = strategies::build(&chromosome, grid, chance);
        Self::of_layers(chromosome, layers)
    }

    /// A truck of layers that are in no registry, for trying them out; `chromosome` is only its name.
    pub fn of_layers(chromosome: Chromosome, layers: Vec<TruckLayer>) -> Self {
        let backplane = CommunicationBackplane::new(layers.len());
        Self {
            chromosome,
            layers,
            backplane,
            last_turn: None,
        }
    }

    /// The truck's name.
    pub fn chromosome(&self) -> &Chromosome {
        &self.chromosome
    }

    /// Proposals, inhibitions and selection as the last selection left them.
    pub fn backplane(&self) -> &CommunicationBackplane<TruckCreature> {
        &self.backplane
    }

    /// How its last turn ended; nothing before the first.
    pub fn last_turn(&self) -> Option<TurnEnd> {
        self.last_turn
    }

    /// Plays one slot through its controller and nothing else (the source's `play`).
    pub fn play(&mut self, controller: &mut Controller<'_>) {
        self.last_turn = Some(take_turn(&mut self.layers, &mut self.backplane, controller));
    }
}
