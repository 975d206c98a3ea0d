//! Offices from seeds: what every one of them has, and what happens in them.

use office::{Config, Drive, KEPT, Kind, Layout, Office, PersonKind, Surface, generate};

fn config(seed: u64) -> Config {
    Config {
        seed,
        layout: Layout::generated(seed),
        people: 4,
        attackers: 1,
        cornerers: 1,
        talkers: 3,
        ..Config::default()
    }
}

#[test]
fn the_kept_offices_are_those_of_the_first_ten_seeds() {
    for (index, kept) in KEPT.iter().enumerate() {
        let seed = index as u64 + 1;
        assert_eq!(*kept, generate(seed), "seed {seed}");
        Layout::kept(index + 1);
    }
}

#[test]
fn every_office_has_rooms_a_ring_of_corridor_doors_and_furniture() {
    let (mut glass, mut polished) = (0, 0);
    for seed in 100..130 {
        let layout = Layout::generated(seed);
        let corridors = layout
            .rooms
            .iter()
            .filter(|r| r.name.starts_with("corridor"))
            .count();
        let rooms = layout.rooms.len() - corridors;
        assert!(rooms >= 8 && corridors == 4, "seed {seed}: {rooms} rooms");
        let count = |kind| layout.blocks.iter().filter(|b| b.kind == kind).count();
        assert!(count(Kind::Leaf) >= 2, "seed {seed}: {} doors", count(Kind::Leaf));
        assert!(count(Kind::Chair) >= 5 && count(Kind::Desk) >= 5, "seed {seed}");
        let faced = |surface| layout.blocks.iter().filter(|b| b.surface == surface).count();
        glass += faced(Surface::Glass);
        polished += faced(Surface::Polished);
        // Every room has a place, and all places can be walked to: the text was refused otherwise.
        for room in &layout.rooms {
            assert!(
                layout.places.iter().any(|p| room.holds(p.x, p.y)),
                "seed {seed}: {}",
                room.name
            );
        }
    }
    assert!(
        glass > 30 && polished > 30,
        "{glass} of glass, {polished} polished"
    );
}

#[test]
fn doors_open_and_close_and_chairs_are_moved() {
    let mut office = Office::new(&config(3));
    let leaves = |office: &Office| {
        let plan = office.floor_plan();
        plan.blocks.iter().filter(|b| b.kind == Kind::Leaf).count()
    };
    let chairs = |office: &Office| -> Vec<(f64, f64)> {
        let plan = office.floor_plan();
        let chairs = plan.blocks.iter().filter(|b| b.kind == Kind::Chair);
        chairs.map(|b| (b.x, b.y)).collect()
    };
    let (mut most, begin) = (0, chairs(&office));
    assert_eq!(leaves(&office), 0, "doors begin open");
    for _ in 0..900 * 50 {
        office.step(0.02, Drive::default());
        most = most.max(leaves(&office));
    }
    assert!(most >= 1, "no door ever closed");
    let moved = chairs(&office).iter().zip(&begin).filter(|(a, b)| a != b).count();
    assert!(moved >= 2, "{moved} chairs moved");
}

#[test]
fn a_cornerer_comes_and_talkers_meet() {
    let mut office = Office::new(&config(5));
    let (mut nearest, mut together) = (f64::INFINITY, f64::INFINITY);
    for step in 0..400 * 50 {
        office.step(0.02, Drive::default());
        if step % 50 != 0 {
            continue;
        }
        let view = office.view();
        let of = |kind| view.people.iter().filter(move |p| p.kind == kind);
        for person in of(PersonKind::Cornerer) {
            nearest = nearest.min((person.x - view.robot.x).hypot(person.y - view.robot.y));
        }
        let talkers: Vec<_> = of(PersonKind::Talker).collect();
        let apart = |a: usize, b: usize| (talkers[a].x - talkers[b].x).hypot(talkers[a].y - talkers[b].y);
        together = together.min(apart(0, 1).max(apart(1, 2)).max(apart(0, 2)));
    }
    assert!(nearest < 1.0, "the cornerer came no nearer than {nearest} m");
    assert!(
        together < 1.5,
        "the talkers were never closer together than {together} m"
    );
}

#[test]
fn two_robots_see_each_other_and_stand_apart() {
    let layout = Layout::empty_room(8.0, 6.0);
    let mut office = Office::new(&Config {
        layout,
        people: 0,
        attackers: 0,
        start: Some((3.0, 3.0, 0.0)),
        others: vec![(4.0, 3.0, std::f64::consts::PI)],
        ..Config::default()
    });
    let range = office.sonar_of(0)[0];
    assert!((range - 0.6).abs() < 0.1, "rim to rim 0.6 m, heard {range}");
    assert!(office.fan_of(1)[5] < 1.0, "{:?}", office.fan_of(1));
    let towards = Drive {
        forward: 0.3,
        turn: 0.0,
    };
    for _ in 0..200 {
        office.step_all(0.02, &[towards, towards]);
    }
    let (a, b) = (office.true_pose_of(0), office.true_pose_of(1));
    assert!((b.x - a.x) > 0.399, "they overlap: {a:?} {b:?}");
    assert_eq!(
        (office.contacts_of(0).caused, office.contacts_of(1).caused),
        (1, 1)
    );
}

#[test]
fn a_dead_sonar_hears_nothing_and_the_others_hear_as_before() {
    let mut whole = config(8);
    whole.sonar.cross_talk = 0.0;
    let mut half = whole.clone();
    half.sonar.dead = 0b0000_0000_1001;
    let (mut whole, mut half) = (Office::new(&whole), Office::new(&half));
    let (a, b) = (whole.sonar(), half.sonar());
    for i in 0..12 {
        if i == 0 || i == 3 {
            assert!((b[i] - 10.67).abs() < 1e-9, "sonar {i} reads {}", b[i]);
        } else {
            assert_eq!(a[i], b[i], "sonar {i}");
        }
    }
}
