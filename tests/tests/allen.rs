//! Allen on trial (Brooks 1991 §6.2): what level 0 promises, what level 1 adds, and that both repeat to the bit.

use tests::{Allen, Trial};

const HOUR_S: u64 = 3600;

#[test]
fn in_the_middle_of_an_empty_room_it_stays() {
    for seed in 1..=3 {
        let figures = Trial::new(Allen::ALONE.seeded(seed)).figures(HOUR_S);
        assert!(figures.drift_m < 0.5, "seed {seed}: {figures:?}");
    }
}

#[test]
fn approached_it_moves_away() {
    for seed in 1..=5 {
        let mut trial = Trial::new(Allen::ALONE.seeded(seed));
        trial.pass(2);
        let begin = trial.pose();
        // From the west, straight at the robot, slower than it can drive.
        trial.office().place_person(begin.x - 2.5, begin.y, 0.15, 0.0);
        trial.pass(20);
        let end = trial.pose();
        assert!(
            end.x > begin.x + 0.5,
            "seed {seed}: it went from {begin:?} to {end:?}"
        );
        assert_eq!(trial.office().contacts().caused, 0, "seed {seed}");
    }
}
