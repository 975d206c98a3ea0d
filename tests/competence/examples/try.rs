//! One row in the offices that layers are built in: what one looks at while building.
//!
//! `cargo run --release -p competence --example try -- 012 [seeds] [hours] [old=>new]…`, which changes the creature's text
#![allow(missing_docs)]

use competence::row;
use competence::{Figures, Measured, table, trial};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let name = args.first().map_or("012", String::as_str);
    let row = row::find(name).unwrap_or_else(|| panic!("no row {name:?}"));
    let seeds: u64 = args.get(1).map_or(4, |n| n.parse().expect("a number of seeds"));
    let hours: f64 = args.get(2).map_or(1.0, |n| n.parse().expect("hours"));
    let begun = std::time::Instant::now();
    let next = AtomicU64::new(1);
    let all: Mutex<Vec<Figures>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..1 {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed > seeds {
                        return;
                    }
                    let mut text = row.text(seed, &format!("layout = \"kept\"\nnumber = {seed}"));
                    for change in args.iter().skip(3) {
                        let (from, to) = change.split_once("=>").expect("old=>new");
                        assert!(text.contains(from), "{from:?} stands in the text");
                        text = text.replace(from, to);
                    }
                    let figures = trial::run_text(row, &text, seed, hours, &|| false).expect("nobody stops it");
                    for f in &figures {
                        eprintln!(
                            "seed {:3} caused {} all {} halts {} dist {:.0} area {:.1} rooms {} chosen {} reached {} in {:.0} stuck {:.0} {:?}",
                            f.seed, f.caused, f.contacts, f.halts, f.distance_m, f.area_m2, f.rooms, f.chosen, f.reached,
                            f.reaching_s / f.reached, f.stuck_s, f.caused_with
                        );
                    }
                    all.lock().expect("whole").extend(figures);
                }
            });
        }
    });
    let figures = all.into_inner().expect("whole");
    println!("{}", table::text(&[Measured { row, figures }]));
    println!(
        "{:.0} simulated seconds a second",
        seeds as f64 * hours * 3600.0 / begun.elapsed().as_secs_f64()
    );
}
