//! Where people go, and where they never are.

use office::{Block, Config, Drive, Layout, Office, PersonKind};
use std::collections::BTreeSet;

/// m from the point to the block's surface; negative inside.
fn distance(block: &Block, x: f64, y: f64) -> f64 {
    let (dx, dy) = (x - block.x, y - block.y);
    let (cos, sin) = (block.angle.cos(), block.angle.sin());
    let (u, v) = (dx * cos + dy * sin, dy * cos - dx * sin);
    let (a, b) = (u.abs() - block.width / 2.0, v.abs() - block.depth / 2.0);
    if a <= 0.0 && b <= 0.0 {
        a.max(b)
    } else {
        (a.max(0.0).powi(2) + b.max(0.0).powi(2)).sqrt()
    }
}

/// A blind robot that drives about: whatever it meets, people must cope.
fn blunder(step: u32) -> Drive {
    Drive {
        forward: 0.3,
        turn: if step % 400 < 120 { 0.9 } else { 0.0 },
    }
}

#[test]
fn nobody_is_ever_inside_anything() {
    for seed in 1..=5 {
        let mut office = Office::new(&Config {
            seed,
            ..Config::default()
        });
        for step in 0..600 * 50 {
            office.step(0.02, blunder(step));
            if step % 10 != 0 {
                continue;
            }
            // Chairs are moved.
            let plan = office.floor_plan();
            let view = office.view();
            for (i, person) in view.people.iter().enumerate() {
                for block in &plan.blocks {
                    let gap = distance(block, person.x, person.y) - 0.22;
                    assert!(
                        gap > -0.001,
                        "seed {seed}, {} s: person {i} in {}",
                        view.time_s,
                        block.name
                    );
                }
                let within =
                    (0.0..=plan.width).contains(&person.x) && (0.0..=plan.height).contains(&person.y);
                assert!(within, "seed {seed}: person {i} left the office");
                let from_robot = (person.x - view.robot.x).hypot(person.y - view.robot.y) - 0.42;
                assert!(from_robot > -0.001, "seed {seed}: person {i} overlaps the robot");
                for other in &view.people[..i] {
                    let gap = (person.x - other.x).hypot(person.y - other.y) - 0.44;
                    assert!(gap > -0.001, "seed {seed}: person {i} overlaps another");
                }
            }
        }
    }
}

#[test]
fn walkers_get_about_the_office() {
    let config = Config {
        seed: 4,
        attackers: 0,
        ..Config::default()
    };
    let mut office = Office::new(&config);
    let plan = office.floor_plan();
    let goals: Vec<_> = plan.places.iter().filter(|place| place.goal).collect();
    let mut been: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); 6];
    for step in 0..1200 * 50_u32 {
        office.step(0.02, Drive::default());
        if step % 10 != 0 {
            continue;
        }
        for (i, person) in office.view().people.iter().enumerate() {
            let here = goals
                .iter()
                .position(|g| (g.x - person.x).hypot(g.y - person.y) < 0.4);
            been[i].extend(here);
        }
    }
    let all: BTreeSet<usize> = been.iter().flatten().copied().collect();
    assert!(
        all.len() * 10 >= goals.len() * 9,
        "only {} of {} goals were seen",
        all.len(),
        goals.len()
    );
    let counts: Vec<usize> = been.iter().map(BTreeSet::len).collect();
    assert!(
        counts.iter().all(|&n| n >= 6),
        "places seen by each walker in 20 minutes: {counts:?}"
    );
}

#[test]
fn attackers_reach_the_robot_go_away_and_come_back() {
    for seed in 1..=5 {
        let mut office = Office::new(&Config {
            seed,
            people: 0,
            attackers: 1,
            ..Config::default()
        });
        let (mut visits, mut near) = (0, false);
        for _ in 0..600 * 50 {
            office.step(0.02, Drive::default());
            let view = office.view();
            assert_eq!(view.people[0].kind, PersonKind::Attacker);
            let gap = (view.people[0].x - view.robot.x).hypot(view.people[0].y - view.robot.y) - 0.42;
            visits += u32::from(gap < 0.35 && !near);
            near = if near { gap < 1.5 } else { gap < 0.35 };
        }
        assert!(visits >= 3, "seed {seed}: {visits} visits in ten minutes");
        assert_eq!(office.contacts().caused, 0, "a robot at rest causes nothing");
    }
}

#[test]
fn attackers_touch_a_robot_that_stays() {
    let contacts: u64 = (1..=5)
        .map(|seed| {
            let mut office = Office::new(&Config {
                seed,
                people: 0,
                attackers: 2,
                ..Config::default()
            });
            (0..600 * 50).for_each(|_| office.step(0.02, Drive::default()));
            office.contacts().all
        })
        .sum();
    assert!(contacts >= 5, "{contacts} touches in fifty minutes");
}

#[test]
fn an_office_without_way_points_has_people_who_stand() {
    let layout = Layout::walled("bare", 5.0, 5.0);
    let mut office = Office::new(&Config {
        people: 0,
        attackers: 0,
        layout,
        ..Config::default()
    });
    office.place_person(1.0, 1.0, 0.3, 0.0);
    (0..500).for_each(|_| office.step(0.02, Drive::default()));
    let person = office.view().people[0];
    assert!((person.x - 4.0).abs() < 0.1, "walked straight: {}", person.x);
}

#[test]
fn a_view_is_json() {
    let mut office = Office::new(&Config::default());
    office.sonar();
    let view = serde_json::to_value(office.view()).expect("a view is plain data");
    assert_eq!(view["people"].as_array().map(Vec::len), Some(8));
    assert_eq!(view["people"][0]["kind"], "walker");
    let plan = serde_json::to_value(office.floor_plan()).expect("a floor plan is plain data");
    assert_eq!(plan["blocks"][0]["kind"], "wall");
    serde_json::to_value(office.contacts()).expect("contacts are plain data");
}
