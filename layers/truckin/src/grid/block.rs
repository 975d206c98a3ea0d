//! Plays the games of one block and writes them down as rows with a checksum.

use std::fmt::Write;

use super::experiment::{Block, Cell, Experiment};
use super::fault::GridFault;
use crate::ootland::Game;
use crate::strategies::{Chromosome, all_chromosomes};

/// Names of the columns.
pub const COLUMNS: &str = "trucks,slots,game,seat,chromosome,profit_cents,tank_millilitres";
/// What the line at the end of a block begins with.
pub const BLOCK_END: &str = "#block ";

/// How one truck came out of one game.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// The cell of the grid.
    pub cell: Cell,
    /// The game's number in the cell.
    pub game: u32,
    /// The truck's place in the game.
    pub seat: u32,
    /// The truck's name.
    pub chromosome: Chromosome,
    /// Capital at the end less capital at the start, in cents.
    pub profit_cents: i64,
    /// Gas left.
    pub tank_millilitres: i32,
}

impl Row {
    /// Reads one line; says which column is wrong.
    ///
    /// # Errors
    /// The name of the column and what was found in it.
    pub fn parse(line: &str) -> Result<Self, String> {
        let mut fields = line.split(',');
        let mut next = |name: &'static str| fields.next().ok_or(format!("the row ends before {name}"));
        fn number<N: std::str::FromStr>(text: &str, name: &str) -> Result<N, String> {
            text.parse()
                .map_err(|_| format!("{name}: expected a whole number, found \"{text}\""))
        }
        let row = Self {
            cell: Cell {
                trucks: number(next("trucks")?, "trucks")?,
                slots: number(next("slots")?, "slots")?,
            },
            game: number(next("game")?, "game")?,
            seat: number(next("seat")?, "seat")?,
            chromosome: next("chromosome")?.parse().map_err(|wrong| format!("{wrong}"))?,
            profit_cents: number(next("profit_cents")?, "profit_cents")?,
            tank_millilitres: number(next("tank_millilitres")?, "tank_millilitres")?,
        };
        match fields.next() {
            Some(more) => Err(format!("the row goes on after tank_millilitres: \"{more}\"")),
            None => Ok(row),
        }
    }
}

/// Plays a block; returns its rows and its last line as they stand in the file.
///
/// # Errors
/// With checking switched on, the first game that broke the rules.
pub fn play_block(experiment: &Experiment, block: Block) -> Result<String, GridFault> {
    let all = all_chromosomes();
    let Cell { trucks, slots } = block.cell;
    let mut text = String::new();
    for number in block.first_game..block.first_game + block.games {
        let seats = experiment.seats(block.cell, number, &all);
        let stream = Experiment::stream(block.cell, number);
        let mut game = Game::new(&experiment.world, &seats, slots, experiment.seed, stream);
        game.play(experiment.check).map_err(|fault| GridFault::Rules {
            what: format!("game {number} of {trucks} trucks and {slots} slots, {fault}"),
        })?;
        for standing in game.standings() {
            let (seat, chromosome) = (standing.seat, seats[standing.seat]);
            let (profit, tank) = (standing.profit_cents, standing.tank_millilitres);
            writeln!(
                text,
                "{trucks},{slots},{number},{seat},{chromosome},{profit},{tank}"
            )
            .expect("writing to memory");
        }
    }
    let checksum = crc32fast::hash(text.as_bytes());
    writeln!(text, "{BLOCK_END}{} crc32={checksum:08x}", block.index).expect("writing to memory");
    Ok(text)
}
