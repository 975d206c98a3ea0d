//! The figures keep what is asked of the robot, on fewer worlds than the command runs.

use adroit::figures::{chance, nests};

#[test]
fn nests_are_built_and_the_tank_never_runs_dry() {
    let figures = nests(20, 40, || {});
    assert!(figures.planned.complete * 100 >= figures.planned.worlds * 95);
    assert!(figures.sequential.complete * 100 >= figures.sequential.worlds * 95);
    // Among these worlds is one, 51, in which a station goes in and out of view behind obstacles.
    assert_eq!(figures.planned.out_of_fuel + figures.sequential.out_of_fuel, 0);
    assert!(figures.planned.path_to_bound >= 1.0, "nothing beats the bound");
    assert_eq!(
        figures,
        nests(20, 40, || {}),
        "the same on any number of cores, to the bit"
    );
}

#[test]
fn chance_is_never_applied() {
    for seed in 0..3 {
        let chance = chance(3_000, seed);
        assert_eq!(chance.applied, 0);
        assert!((3..=12).contains(&chance.experiences_to_apply), "{chance:?}");
    }
}
