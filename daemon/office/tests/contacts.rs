//! What stops the robot, and whose doing a contact is.

use office::{Config, Drive, Kind, Layout, Office};

const HALT: Drive = Drive {
    forward: 0.0,
    turn: 0.0,
};
const AHEAD: Drive = Drive {
    forward: 0.3,
    turn: 0.0,
};

fn empty(start: (f64, f64, f64)) -> Office {
    let layout = Layout::empty_room(6.0, 6.0);
    Office::new(&Config {
        people: 0,
        attackers: 0,
        layout,
        start: Some(start),
        ..Config::default()
    })
}

fn run(office: &mut Office, seconds: f64, drive: Drive) {
    for _ in 0..(seconds * 50.0).round() as u32 {
        office.step(0.02, drive);
    }
}

#[test]
fn driving_into_a_wall_is_one_contact_that_the_robot_caused() {
    let mut office = empty((4.0, 3.0, 0.0));
    run(&mut office, 20.0, AHEAD);
    let pose = office.true_pose();
    assert!(
        (pose.x - 5.8).abs() < 1e-3,
        "stopped at {} instead of 5.8",
        pose.x
    );
    assert!(office.clearance_m() < 1e-3);
    let contacts = office.contacts();
    assert_eq!((contacts.all, contacts.caused), (1, 1));
    let contact = &contacts.recent[0];
    assert_eq!(&*contact.other, "east wall");
    assert!(
        (contact.approach_m_s - 0.3).abs() < 0.01,
        "at {} m/s",
        contact.approach_m_s
    );
    assert!(
        office.odometry().x > 8.0,
        "the wheels slip, and odometry believes them"
    );
}

#[test]
fn a_robot_that_backs_away_and_returns_makes_a_second_contact() {
    let mut office = empty((5.5, 3.0, 0.0));
    run(&mut office, 3.0, AHEAD);
    run(
        &mut office,
        2.0,
        Drive {
            forward: -0.3,
            turn: 0.0,
        },
    );
    run(&mut office, 4.0, AHEAD);
    assert_eq!((office.contacts().all, office.contacts().caused), (2, 2));
}

#[test]
fn no_wall_or_chair_is_ever_passed_through() {
    for k in 0..24 {
        let heading = f64::from(k) * 15f64.to_radians();
        let mut layout = Layout::empty_room(6.0, 6.0);
        layout.block("chair", Kind::Chair, (4.0, 3.5), (0.45, 0.45), 0.4);
        layout.wall("inner wall", (1.0, 2.0), (5.0, 2.0), &[]);
        let mut office = Office::new(&Config {
            people: 0,
            attackers: 0,
            layout,
            start: Some((3.0, 3.0, heading)),
            ..Config::default()
        });
        for _ in 0..60 * 50 {
            office.step(0.02, AHEAD);
            let pose = office.true_pose();
            assert!(
                (0.199..=5.801).contains(&pose.x) && (0.199..=5.801).contains(&pose.y),
                "{pose:?}"
            );
            let through = (1.0..=5.0).contains(&pose.x) && (pose.y - 2.0).abs() < 0.2;
            assert!(!through, "inside the inner wall at {pose:?}");
        }
        assert!(office.contacts().caused >= 1);
    }
}

#[test]
fn a_person_who_walks_into_a_standing_robot_is_not_its_doing() {
    let mut office = empty((3.0, 3.0, 0.0));
    office.place_person(5.0, 3.0, -0.6, 0.0);
    run(&mut office, 6.0, HALT);
    let contacts = office.contacts();
    assert_eq!((contacts.all, contacts.caused), (1, 0), "{:?}", contacts.recent);
    assert_eq!(&*contacts.recent[0].other, "scripted 1");
    let (robot, person) = (office.true_pose(), office.view().people[0]);
    assert_eq!((robot.x, robot.y), (3.0, 3.0), "nobody pushes the robot");
    let gap = ((person.x - robot.x).powi(2) + (person.y - robot.y).powi(2)).sqrt() - 0.42;
    assert!(gap > -1e-3, "the person stands {gap} m inside the robot");
}

#[test]
fn driving_into_a_standing_person_is_its_doing() {
    let mut office = empty((2.0, 3.0, 0.0));
    office.place_person(4.0, 3.0, 0.0, 0.0);
    run(&mut office, 10.0, AHEAD);
    assert_eq!((office.contacts().all, office.contacts().caused), (1, 1));
    assert!(office.true_pose().x < 4.0 - 0.419);
}

#[test]
fn clearance_is_measured_from_the_rim() {
    let mut office = empty((3.0, 3.0, 0.0));
    assert!((office.clearance_m() - 2.8).abs() < 1e-4);
    office.place_person(3.0, 4.0, 0.0, 0.0);
    assert!((office.clearance_m() - (1.0 - 0.42)).abs() < 1e-9);
    run(
        &mut office,
        2.0,
        Drive {
            forward: 0.0,
            turn: 1.5,
        },
    );
    assert_eq!(office.distance_travelled_m(), 0.0);
}

#[test]
fn wheels_that_slip_against_a_wall_cause_no_contact_with_a_passer_by() {
    let mut office = empty((5.5, 3.0, 0.0));
    run(&mut office, 3.0, AHEAD);
    assert_eq!(office.contacts().caused, 1, "the wall");
    // Somebody comes along the wall from the north, into the side of the pushing robot's front.
    office.place_person(5.7, 5.0, 0.0, -0.5);
    run(&mut office, 6.0, AHEAD);
    assert_eq!(
        (office.contacts().all, office.contacts().caused),
        (2, 1),
        "{:?}",
        office.contacts().recent
    );
}
