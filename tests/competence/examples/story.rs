//! A stretch of one trial in words, such as the seconds before a contact that `compete --contacts` lists.
//!
//! `cargo run --release -p competence --example story -- 012 7 1 1833 1836`: row, seed, robot, from and to in seconds
#![allow(missing_docs)]

use competence::{row, story};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [name, numbers @ ..] = &args[..] else {
        panic!("row, seed, robot, from, to");
    };
    let row = row::find(name).unwrap_or_else(|| panic!("no row {name:?}"));
    let numbers: Vec<f64> = numbers.iter().map(|n| n.parse().expect("a number")).collect();
    let [seed, robot, from, to] = numbers[..] else {
        panic!("row, seed, robot, from, to");
    };
    print!("{}", story::story(row, seed as u64, robot as usize, from, to));
}
