//! The experiment of section 4.1: every number of trucks by every length of game, many games each.
//!
//! ```text
//!   Experiment ──► blocks of games ──► threads ──► writer, in order of blocks ──► CSV
//!                                                     ▲
//!   file from before ──► read, every block checked ───┘
//! ```
//!
//! The file only ever grows, block by block, each with a checksum. Blocks are written in their order
//! whatever thread finished first, so the bytes are the same for any number of threads, and a run that
//! was killed goes on after the last byte it wrote.

pub mod block;
pub mod experiment;
pub mod fault;
pub mod results;
pub mod run;

pub use block::{Row, play_block};
pub use experiment::{Cell, Experiment};
pub use fault::GridFault;
pub use results::{Results, read_results};
pub use run::{Progress, run};
