//! Measuring: every row over every seed, on all cores, until done or told to stop.
//!
//! Must never depend on how many cores there are: every trial stands for itself.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::figures::Figures;
use crate::row::Row;
use crate::trial;

/// What to measure.
#[derive(Clone, Debug)]
pub struct Order {
    /// The rows.
    pub rows: Vec<&'static Row>,
    /// The first seed.
    pub first: u64,
    /// So many seeds for each, the first and those that follow.
    pub seeds: u64,
    /// Simulated hours for each seed.
    pub hours: f64,
    /// Threads.
    pub threads: usize,
    /// A layout file to measure in, instead of the generated office that belongs to each seed.
    pub layout: Option<PathBuf>,
}

/// A row with the figures of its trials, as many as were done, by seed.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The row.
    pub row: &'static Row,
    /// One for each robot of each seed.
    pub figures: Vec<Figures>,
}

/// Runs the trials of `order`. `done` is called after each, from any thread; once `stop` is set, trials
/// that are under way are dropped and the rest is not begun. Seeds go round the rows, so that whatever is
/// done when it stops is about the same share of each row.
pub fn measure(order: &Order, stop: &AtomicBool, done: &(dyn Fn() + Sync)) -> Vec<Measured> {
    let tasks: Vec<(usize, u64)> = (order.first..order.first + order.seeds)
        .flat_map(|seed| (0..order.rows.len()).map(move |row| (row, seed)))
        .collect();
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<(usize, Vec<Figures>)>> = Mutex::new(Vec::new());
    // Relaxed: the flag is the message, and a trial more or less makes no difference.
    let stopped = || stop.load(Ordering::Relaxed);
    std::thread::scope(|scope| {
        for _ in 0..order.threads.max(1) {
            scope.spawn(|| {
                while !stopped() {
                    let Some(&(at, seed)) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) else {
                        return;
                    };
                    let (row, layout) = (order.rows[at], order.layout.as_deref());
                    let Some(figures) =
                        trial::run_text(row, &row.asked(seed, layout), seed, order.hours, &stopped)
                    else {
                        return;
                    };
                    results
                        .lock()
                        .expect("no trial panics holding it")
                        .push((at, figures));
                    done();
                }
            });
        }
    });
    let results = results.into_inner().expect("the threads are gone");
    let of_row = |(index, row): (usize, &&'static Row)| {
        let mut figures: Vec<Figures> = results
            .iter()
            .filter(|(of, _)| *of == index)
            .flat_map(|(_, figures)| figures.iter().cloned())
            .collect();
        figures.sort_by_key(|f| f.seed);
        Measured { row, figures }
    };
    order.rows.iter().enumerate().map(of_row).collect()
}
