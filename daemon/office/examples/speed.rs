//! How fast the standard office runs: steps of 20 ms for each second of the wall clock.
//!
//! `cargo run --release -p office --example speed`

use office::{Config, Drive, Office};
use std::time::Instant;

fn main() {
    const STEPS: u32 = 500_000;
    let begun = Instant::now();
    let mut office = Office::new(&Config::default());
    println!(
        "built in {:.1} ms, {} blocks",
        begun.elapsed().as_secs_f64() * 1e3,
        office.floor_plan().blocks.len()
    );
    for (what, sonar_every) in [("without sonar", 0), ("sonar once a second", 50)] {
        let begun = Instant::now();
        for step in 0..STEPS {
            let turn = if step % 700 < 100 { 1.0 } else { 0.0 };
            office.step(0.02, Drive { forward: 0.3, turn });
            if sonar_every > 0 && step % sonar_every == 0 {
                office.sonar();
            }
        }
        let wall = begun.elapsed().as_secs_f64();
        println!(
            "{what}: {:.0} steps/s, {:.2} microseconds a step, {:.0} simulated seconds a second",
            f64::from(STEPS) / wall,
            wall / f64::from(STEPS) * 1e6,
            f64::from(STEPS) * 0.02 / wall
        );
    }
    println!(
        "{} contacts, {} caused",
        office.contacts().all,
        office.contacts().caused
    );
}
