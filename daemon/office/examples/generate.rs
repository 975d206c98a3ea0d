//! Prints the office that belongs to a seed.
//!
//! `cargo run -p office --example generate -- SEED`
#![allow(missing_docs)]

fn main() {
    let seed = std::env::args().nth(1).and_then(|seed| seed.parse().ok());
    let Some(seed) = seed else {
        eprintln!("expected a seed, a whole number: cargo run -p office --example generate -- 11");
        std::process::exit(2);
    };
    print!("{}", office::generate(seed));
}
