//! A stretch of one trial in words: where everybody was, what the sonars heard, who drove.
//!
//! Must never be another trial than the one that the table measured: it repeats it, and looks.

use std::fmt::Write as _;

use ipc::clock::Span;
use ipc::message::{Map, Payload};
use ipc::wire::Reader;
use office::Pose;

use crate::row::Row;
use crate::trial::{Killer, Robot, advance, office_of, robots, warehouse_of};

/// People and robots nearer than this are told of, m from middle to middle.
const NEAR_M: f64 = 2.5;

/// What happened to `robot` (from 1) in the trial of `row` with `seed` between `from_s` and `to_s`: a line for
/// every tenth of a second, one more for every sonar map.
///
/// # Panics
/// With the checker's findings, when the row's creature is not one.
pub fn story(row: &Row, seed: u64, robot: usize, from_s: f64, to_s: f64) -> String {
    let mut robots = robots(row, &row.measured(seed), seed);
    let mut killer = Killer::new(row, seed);
    let index = robot.clamp(1, robots.len()) - 1;
    let map = robots[index].wire("sonar.map");
    let mut heard = 0;
    let mut out = String::new();
    let seconds = |span: Span| span.seconds();
    while seconds(robots[0].run.elapsed()) < to_s {
        if let Some(killer) = &mut killer {
            robots.iter_mut().for_each(|robot| killer.act(&mut robot.run));
        }
        advance(&mut robots);
        let now = seconds(robots[0].run.elapsed());
        if now >= from_s {
            tell(&mut robots[index], index, now, &mut out);
            ranges(&map, &mut heard, &mut out);
        }
    }
    out
}

fn ranges(map: &Option<Reader>, heard: &mut u64, out: &mut String) {
    let Some(reading) = map.as_ref().and_then(|r| r.newer_than(*heard)) else {
        return;
    };
    *heard = reading.number;
    let ranges = Map::unpack(&reading.words).ranges;
    let _ = writeln!(out, "          map {ranges:.2?}");
}

/// Where a robot is and thinks it is, how far it has gone in m, and everybody else with their place.
fn scene(robot: &mut Robot, index: usize) -> (Pose, Pose, f64, Vec<(String, f64, f64)>) {
    if let Some(world) = warehouse_of(&mut robot.run.machine) {
        let pose = |(x, y, heading)| Pose { x, y, heading };
        let (floor, report) = (&world.warehouse, world.warehouse.report());
        let people = floor.people().enumerate();
        let people = people.map(|(n, (x, y, _))| (format!("person {}", n + 1), x, y));
        return (
            pose(report.pose),
            pose(floor.believed()),
            report.travelled_m,
            people.collect(),
        );
    }
    let office = office_of(&mut robot.run.machine);
    let others = office
        .others_of(index)
        .map(|(name, x, y)| (name.to_string(), x, y));
    (
        office.true_pose_of(index),
        office.odometry_of(index),
        office.distance_travelled_of_m(index),
        others.collect(),
    )
}

fn tell(robot: &mut Robot, index: usize, now: f64, out: &mut String) {
    let stations = robot.run.machine.stations.iter();
    let states = ["turn", "forward", "avoid", "pathplan"];
    let states = states.map(|module| {
        let state = stations.clone().find_map(|s| s.running.state_of(module));
        state.unwrap_or("-").to_string()
    });
    let (pose, believed, gone, others) = scene(robot, index);
    let _ = write!(
        out,
        "{now:8.1}  at {:.3} {:.3} {:.2}, believes {:.3} {:.3} {:.2}, gone {gone:.3}, {}; ",
        pose.x,
        pose.y,
        pose.heading,
        believed.x,
        believed.y,
        believed.heading,
        states.join(" ")
    );
    let (sin, cos) = pose.heading.sin_cos();
    let others = others.into_iter().filter_map(|(name, x, y)| {
        let (dx, dy) = (x - pose.x, y - pose.y);
        let near = dx.hypot(dy) < NEAR_M;
        near.then(|| {
            format!(
                "{name} {:.2} ahead {:.2} left, ",
                dx * cos + dy * sin,
                dy * cos - dx * sin
            )
        })
    });
    let _ = writeln!(out, "{}", others.collect::<String>());
}
