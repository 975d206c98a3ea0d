//! What is to be played: the cells, the games of each, and how they are cut into blocks.

use crate::ootland::{Chance, World};
use crate::strategies::{Chromosome, all_chromosomes};

/// Games in a block: long enough to be worth a line in the file, short enough to lose little.
pub const BLOCK_GAMES: u32 = 10;
/// Games in a cell at most, so that a game's stream has room for its number.
pub const GAMES_MAX: u32 = 1 << 24;
/// Changes whenever the same settings would give other results.
pub const RULES_VERSION: u32 = 1;

/// One combination of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    /// Trucks in each game.
    pub trucks: u32,
    /// Slots of each game.
    pub slots: u32,
}

/// A whole experiment.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// What everything is drawn from.
    pub seed: u64,
    /// Games of each cell.
    pub games: u32,
    /// The cells, in the order they are played and written.
    pub cells: Vec<Cell>,
    /// Where they are played.
    pub world: World,
    /// Whether conservation is checked after every slot.
    pub check: bool,
}

/// Some games of one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Its place in the file.
    pub index: usize,
    /// The cell.
    pub cell: Cell,
    /// The first game.
    pub first_game: u32,
    /// How many games.
    pub games: u32,
}

impl Experiment {
    /// The source's numbers of trucks.
    pub const TRUCKS: [u32; 5] = [1, 5, 10, 15, 20];
    /// The source's lengths of games, in slots.
    pub const SLOTS: [u32; 4] = [1_000, 5_000, 10_000, 15_000];

    /// Every number of trucks by every number of slots.
    pub fn new(seed: u64, games: u32, trucks: &[u32], slots: &[u32], world: World) -> Self {
        let cells = trucks
            .iter()
            .flat_map(|&trucks| slots.iter().map(move |&slots| Cell { trucks, slots }));
        Self {
            seed,
            games,
            cells: cells.collect(),
            world,
            check: false,
        }
    }

    fn blocks_per_cell(&self) -> usize {
        self.games.div_ceil(BLOCK_GAMES) as usize
    }

    /// How many blocks there are.
    pub fn blocks(&self) -> usize {
        self.cells.len() * self.blocks_per_cell()
    }

    /// One of the blocks.
    pub fn block(&self, index: usize) -> Block {
        let cell = self.cells[index / self.blocks_per_cell()];
        let first_game = (index % self.blocks_per_cell()) as u32 * BLOCK_GAMES;
        Block {
            index,
            cell,
            first_game,
            games: BLOCK_GAMES.min(self.games - first_game),
        }
    }

    /// How much there is to play in the first so many blocks.
    pub fn truck_slots(&self, blocks: usize) -> u64 {
        (0..blocks).map(|index| self.block(index).truck_slots()).sum()
    }

    /// The stream of one game: its cell and its number, whatever else is in the experiment.
    pub fn stream(cell: Cell, game: u32) -> u64 {
        u64::from(cell.trucks) << 48 | u64::from(cell.slots) << 24 | u64::from(game)
    }

    /// The trucks of one game, drawn from all there are.
    pub fn seats(&self, cell: Cell, game: u32, all: &[Chromosome]) -> Vec<Chromosome> {
        let mut chance = Chance::new(self.seed.wrapping_add(1), Self::stream(cell, game));
        (0..cell.trucks)
            .map(|_| all[chance.below(all.len() as u32) as usize])
            .collect()
    }

    /// The first line of the results file: everything the results depend on.
    pub fn settings(&self) -> String {
        let cells: Vec<String> = self
            .cells
            .iter()
            .map(|cell| format!("{}x{}", cell.trucks, cell.slots))
            .collect();
        let world = crc32fast::hash(format!("{:?}", self.world).as_bytes());
        let all = all_chromosomes().len();
        format!(
            "#truckin-grid rules={RULES_VERSION} seed={} games={} block={BLOCK_GAMES} chromosomes={all} \
             world={world:08x} cells={}",
            self.seed,
            self.games,
            cells.join(";")
        )
    }
}

impl Block {
    /// How much there is to play in it.
    pub fn truck_slots(&self) -> u64 {
        u64::from(self.cell.trucks) * u64::from(self.cell.slots) * u64::from(self.games)
    }
}
