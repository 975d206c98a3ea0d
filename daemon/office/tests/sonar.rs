//! What the ring hears: walls straight on, walls at a slant, corners, people.

use office::{Config, Layout, Office, SonarModel};

fn room(sonar: SonarModel, start: (f64, f64, f64)) -> Office {
    let layout = Layout::empty_room(8.0, 8.0);
    Office::new(&Config {
        people: 0,
        attackers: 0,
        sonar,
        layout,
        start: Some(start),
        ..Config::default()
    })
}

#[test]
fn a_wall_straight_ahead_reads_its_distance() {
    // The east wall at x = 8; the rim at 5.2.
    let mut office = room(SonarModel::perfect(), (5.0, 4.0, 0.0));
    let ranges = office.sonar();
    assert!((ranges[0] - 2.8).abs() < 1e-4, "ahead {}", ranges[0]);
    assert!((ranges[3] - 3.8).abs() < 1e-4, "left {}", ranges[3]);
    assert!((ranges[6] - 4.8).abs() < 1e-4, "behind {}", ranges[6]);
    assert!((ranges[9] - 3.8).abs() < 1e-4, "right {}", ranges[9]);
}

#[test]
fn readings_scatter_by_the_noise_and_drop_out_at_their_rate() {
    let model = SonarModel {
        noise_m: 0.02,
        dropout: 0.1,
        ..SonarModel::perfect()
    };
    let mut office = room(model, (5.0, 4.0, 0.0));
    let readings: Vec<f64> = (0..4000).map(|_| office.sonar()[0]).collect();
    let heard: Vec<f64> = readings
        .iter()
        .copied()
        .filter(|&r| r < model.range_max_m)
        .collect();
    let lost = 1.0 - heard.len() as f64 / 4000.0;
    let mean = heard.iter().sum::<f64>() / heard.len() as f64;
    let sigma = (heard.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / heard.len() as f64).sqrt();
    assert!((lost - 0.1).abs() < 0.02, "lost {lost}");
    assert!((mean - 2.8).abs() < 0.002, "mean {mean}");
    assert!((sigma - 0.02).abs() < 0.002, "sigma {sigma}");
}

#[test]
fn a_wall_met_at_a_slant_is_lost() {
    // A long wall ahead, met by the cone's rays at 5 to 35 degrees: all but the steepest two are
    // reflected away, with a narrow cone all of them. Nothing else is within reach.
    let model = SonarModel {
        range_max_m: 2.5,
        cone_deg: 10.0,
        ..SonarModel::perfect()
    };
    let mut slanting = room(model, (4.0, 1.0, -20f64.to_radians()));
    assert_eq!(slanting.sonar()[0], 2.5, "20 degrees is under the 30 that return");
    let mut steep = room(model, (4.0, 1.0, -45f64.to_radians()));
    assert!(steep.sonar()[0] < 1.3, "45 degrees returns: {}", steep.sonar()[0]);
}

#[test]
fn a_ghost_reads_longer_than_the_wall_it_bounced_off() {
    // South wall at a slant of 25 degrees, then on to the east wall at 65: the way is the sum.
    let model = SonarModel {
        cone_deg: 2.0,
        ghosts: 1.0,
        ..SonarModel::perfect()
    };
    let mut office = room(model, (4.0, 1.0, -25f64.to_radians()));
    let reading = office.sonar()[0];
    let way = (8.0 - 4.0) / 25f64.to_radians().cos() - 0.2;
    assert!(
        (reading - way).abs() < 0.1,
        "{reading} m against {way} m by way of the wall"
    );
    let mut silent = room(
        SonarModel { ghosts: 0.0, ..model },
        (4.0, 1.0, -25f64.to_radians()),
    );
    assert_eq!(silent.sonar()[0], model.range_max_m);
}

#[test]
fn the_corner_of_a_box_answers_though_its_faces_do_not() {
    let mut layout = Layout::empty_room(8.0, 8.0);
    // A square on its point: both faces are met at 45 degrees and less toward the cone's sides.
    layout.block(
        "crate",
        office::Kind::Box,
        (5.0, 4.0),
        (1.0, 1.0),
        45f64.to_radians(),
    );
    let config = Config {
        people: 0,
        attackers: 0,
        layout,
        start: Some((3.0, 4.0, 0.0)),
        ..Config::default()
    };
    let model = SonarModel {
        specular_deg: 80.0,
        ..SonarModel::perfect()
    };
    let mut office = Office::new(&Config {
        sonar: model,
        ..config
    });
    let corner = 5.0 - 0.5f64.sqrt() - 3.2;
    assert!(
        (office.sonar()[0] - corner).abs() < 1e-4,
        "{} against {corner}",
        office.sonar()[0]
    );
}

#[test]
fn people_answer_from_every_side() {
    let mut office = room(SonarModel::perfect(), (4.0, 4.0, 0.3));
    for k in 0..12 {
        let bearing = 0.3 + f64::from(k) * 30f64.to_radians();
        office.place_person(4.0 + 1.5 * bearing.cos(), 4.0 + 1.5 * bearing.sin(), 0.0, 0.0);
    }
    for (k, range) in office.sonar().iter().enumerate() {
        assert!((range - (1.5 - 0.22 - 0.2)).abs() < 1e-4, "sonar {k}: {range}");
    }
}
