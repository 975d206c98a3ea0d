//! Equal seeds give equal runs, to the bit, in every build.

use office::{Config, Drive, Office};

/// FNV-1a over the bits of all that can be seen in a run of `seconds` in the standard office.
fn fingerprint(seed: u64, seconds: u32, sonar_every: u32) -> (u64, u64) {
    let mut office = Office::new(&Config {
        seed,
        ..Config::default()
    });
    let (mut world, mut sensed) = (0xcbf2_9ce4_8422_2325_u64, 0xcbf2_9ce4_8422_2325_u64);
    let mix = |hash: &mut u64, value: f64| *hash = (*hash ^ value.to_bits()).wrapping_mul(0x0100_0000_01b3);
    for step in 0..seconds * 50 {
        let turn = if step % 700 < 100 { 1.0 } else { 0.0 };
        office.step(0.02, Drive { forward: 0.3, turn });
        if step % sonar_every == 0 {
            office.sonar().iter().for_each(|&range| mix(&mut sensed, range));
        }
        let view = office.view();
        for pose in [view.robot, view.odometry] {
            [pose.x, pose.y, pose.heading]
                .iter()
                .for_each(|&value| mix(&mut world, value));
        }
        for person in &view.people {
            [person.x, person.y, person.heading]
                .iter()
                .for_each(|&value| mix(&mut world, value));
        }
        mix(&mut world, office.clearance_m());
        mix(&mut world, view.contacts as f64);
    }
    (world, sensed)
}

#[test]
fn a_run_repeats_to_the_bit() {
    assert_eq!(fingerprint(7, 60, 50), fingerprint(7, 60, 50));
    assert_ne!(fingerprint(7, 60, 50), fingerprint(8, 60, 50));
}

/// One number for debug and release, and for every machine. It changes with the office's layout
/// or anyone's habits: then take the new one, after running both builds.
#[test]
fn a_run_is_the_same_in_every_build() {
    let (world, sensed) = fingerprint(1, 60, 50);
    assert_eq!(
        (world, sensed),
        (0x92a5_d04f_6e42_1681, 0xc37e_4412_f38e_bef2),
        "({world:#x}, {sensed:#x})"
    );
}

#[test]
fn listening_more_often_changes_nothing_in_the_world() {
    assert_eq!(fingerprint(7, 20, 50).0, fingerprint(7, 20, 5).0);
}
