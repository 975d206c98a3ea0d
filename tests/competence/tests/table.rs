//! The table in small: a few simulated minutes of some rows, and what is made of them.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use competence::{Measured, Order, ROWS, goals, measure, plot, row, table};

fn order(rows: &[&str], seeds: u64, hours: f64, threads: usize) -> Order {
    Order {
        rows: rows.iter().map(|name| row::find(name).expect("a row")).collect(),
        first: 1,
        seeds,
        hours,
        threads,
        layout: None,
    }
}

fn measured(order: &Order) -> Vec<Measured> {
    measure(order, &AtomicBool::new(false), &|| {})
}

fn sum(measured: &Measured, of: fn(&competence::Figures) -> f64) -> f64 {
    measured.figures.iter().map(of).sum()
}

#[test]
fn ten_minutes_of_two_offices_and_no_contact_of_its_own_making() {
    let small = measured(&order(&["0", "01", "012"], 2, 1.0 / 6.0, 2));
    for it in &small {
        assert_eq!(it.figures.len(), 2, "{}", it.row.name);
        assert_eq!(sum(it, |f| f.caused), 0.0, "{}: {:?}", it.row.name, it.figures);
        assert!(
            sum(it, |f| f.distance_m) > 1.0,
            "{}: {:?}",
            it.row.name,
            it.figures
        );
    }
    let (wandering, exploring) = (&small[1], &small[2]);
    assert_eq!(
        sum(wandering, |f| f.chosen),
        0.0,
        "only level 2 sets out for places"
    );
    assert!(sum(exploring, |f| f.reached) >= 1.0, "{:?}", exploring.figures);
    let text = table::text(&small);
    assert!(
        text.contains("levels 0+1+2") && text.contains("To reach:"),
        "{text}"
    );
    assert_eq!(
        table::markdown(&small)
            .lines()
            .filter(|l| l.starts_with('|'))
            .count(),
        2 + 3
    );
    let json = table::json(&small);
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(3));
    assert_eq!(json["rows"][2]["trials"].as_array().map(Vec::len), Some(2));
    let picture = plot::svg(&small);
    assert!(
        picture.starts_with("<svg") && picture.contains("rooms"),
        "{picture}"
    );
}

#[test]
fn figures_do_not_hang_on_the_number_of_threads() {
    let one = measured(&order(&["012", "two"], 2, 0.02, 1));
    let three = measured(&order(&["012", "two"], 2, 0.02, 3));
    for (a, b) in one.iter().zip(&three) {
        assert_eq!(
            format!("{:?}", a.figures),
            format!("{:?}", b.figures),
            "{}",
            a.row.name
        );
    }
    assert_eq!(one[1].figures.len(), 4, "two robots a seed");
}

#[test]
fn told_to_stop_it_keeps_what_is_done() {
    let (stop, done) = (AtomicBool::new(false), AtomicU64::new(0));
    let some = measure(&order(&["quiet"], 50, 0.01, 1), &stop, &|| {
        if done.fetch_add(1, Ordering::Relaxed) == 2 {
            stop.store(true, Ordering::Relaxed);
        }
    });
    assert_eq!(some[0].figures.len(), 3);
}

#[test]
fn every_row_runs_and_its_creature_is_sound() {
    let names: Vec<&str> = ROWS.iter().map(|row| row.name).collect();
    for it in measured(&order(&names, 1, 0.01, 2)) {
        assert_eq!(it.figures.len(), it.row.robots, "{}", it.row.name);
        assert!(
            it.figures.iter().all(|f| f.distance_m.is_finite()),
            "{}",
            it.row.name
        );
    }
}

#[test]
fn nonsense_is_refused_and_changes_nothing() {
    let both = measured(&order(&["0", "nonsense"], 1, 0.05, 2));
    let (alone, flooded) = (&both[0].figures[0], &both[1].figures[0]);
    assert!(
        flooded.refused > 100_000.0,
        "two layers, a thousand a second: {flooded:?}"
    );
    assert_eq!(alone.distance_m, flooded.distance_m);
    assert_eq!(alone.contacts, flooded.contacts);
}

#[test]
fn a_missed_goal_is_shown_as_missed() {
    let mut small = measured(&order(&["0"], 1, 0.01, 1));
    assert!(goals::all(&small).iter().all(|goal| goal.reached));
    small[0].figures[0].caused = 1.0;
    let text = goals::text(&small);
    assert!(text.contains("MISSED"), "{text}");
}
