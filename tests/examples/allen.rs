//! What Allen comes to in the office, level by level: one simulated hour for each of some seeds.
//!
//! `cargo run --release -p tests --example allen [seeds]`
#![allow(missing_docs)]

use std::time::Instant;

use tests::{Allen, Trial};

const HOUR_S: u64 = 3600;

fn main() {
    let seeds = std::env::args()
        .nth(1)
        .map_or(10, |n| n.parse().expect("a number of seeds"));
    for (what, allen) in [("level 0", Allen::LEVEL_0), ("levels 0 and 1", Allen::LEVEL_1)] {
        let begun = Instant::now();
        println!("{what}\nseed  metres  headings  rooms  drift m  contacts  caused");
        for seed in 1..=seeds {
            let f = Trial::new(allen.seeded(seed)).figures(HOUR_S);
            println!(
                "{seed:4}  {:6.1}  {:8}  {:5}  {:7.2}  {:8}  {:6}",
                f.travelled_m,
                f.headings,
                f.rooms.len(),
                f.drift_m,
                f.contacts.all,
                f.contacts.caused
            );
            for contact in f.contacts.recent.iter().filter(|c| c.caused) {
                println!(
                    "      caused at {:.2} s: {} at {:.3} m/s",
                    contact.time_s, contact.other, contact.approach_m_s
                );
            }
        }
        let wall = begun.elapsed().as_secs_f64();
        println!(
            "{:.0} simulated seconds a second, on one core\n",
            (seeds * HOUR_S) as f64 / wall
        );
    }
}
