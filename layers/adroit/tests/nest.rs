//! The published behaviour of the nest-building robot, a scenario each.

use adroit::nest::{Layout, ONE_THRESHOLD, Point, Robot, Run, World, generate, picture};

/// An empty floor, the robot in its middle looking east, and a proper site behind it.
fn floor() -> World {
    let mut world = World::new(Robot::new(Point::new(8.0, 6.0), 0.0), 1);
    world.put_site(Point::new(7.3, 6.0), true);
    world
}

#[test]
fn the_site_is_found_in_a_single_sweep_and_the_nest_built_to_the_wanted_number() {
    let mut world = generate(
        3,
        Layout {
            persons: 0,
            ..Layout::default()
        },
    );
    world.wanted = 4;
    let mut run = Run::new(world);
    assert!(run.until(600.0, |run| run.world.nest_complete()));
    assert_eq!(
        run.world.lying_at(run.world.known_site().expect("found").place),
        4
    );
    run.until(30.0, |_| false);
    assert!(
        run.active("maintenance"),
        "when the goal state holds there is nothing left to build"
    );
    assert_eq!(
        run.world.lying_at(run.world.known_site().expect("found").place),
        4
    );
}

#[test]
fn without_a_site_the_search_fails_up_to_the_top_and_another_activity_is_taken() {
    let mut run = Run::new(generate(
        3,
        Layout {
            site: false,
            persons: 0,
            ..Layout::default()
        },
    ));
    assert!(run.until(5.0, |run| run.active("seek-site")));
    assert!(
        run.until(600.0, |run| run.active("refuel") || run.active("maintenance")),
        "one sweep, then something else"
    );
    assert!(!run.active("nest-building") && run.world.robot.site.is_none());
}

#[test]
fn an_object_put_in_front_of_it_on_its_way_is_taken_at_once() {
    let mut world = floor();
    let far = world.put_object(Point::new(12.0, 6.0));
    let mut run = Run::new(world);
    assert!(run.until(10.0, |run| run.world.robot.place.x_m > 9.0));
    assert_eq!(run.goal("fetch").expect("is fetching").thing, far);
    let x_m = run.world.robot.place.x_m + 0.6;
    let near = run.world.put_object(Point::new(x_m, 6.0));
    run.beat();
    run.beat();
    assert_eq!(
        run.goal("fetch").expect("is fetching").thing,
        near,
        "reviewed within two beats"
    );
    assert!(run.until(6.0, |run| run.world.robot.held == Some(near)));
}

#[test]
fn a_goal_that_already_holds_is_not_worked_for() {
    let mut world = floor();
    world.put_object(Point::new(8.5, 6.0));
    let mut run = Run::new(world);
    let mut drove = false;
    assert!(run.until(6.0, |run| {
        drove |= run.active("roll");
        run.world.robot.held.is_some()
    }));
    assert!(!drove, "within reach already: no motor action to get there");
}

#[test]
fn objects_brought_by_someone_else_count() {
    let mut world = floor();
    world.wanted = 3;
    let mut run = Run::new(world);
    run.until(3.0, |_| false);
    for y_m in [5.8, 6.0, 6.2] {
        run.world.put_object(Point::new(7.3, y_m));
    }
    assert!(
        run.until(300.0, |run| run.active("maintenance")),
        "building ends though the robot placed nothing"
    );
    assert_eq!(run.world.robot.counted, 3);
    assert!(run.world.robot.held.is_none());
}

#[test]
fn refuelling_interrupts_building_in_time_and_building_goes_on_after() {
    let mut world = floor();
    world.put_station(Point::new(10.0, 7.5));
    for x_m in [11.0, 11.5, 12.0, 12.5, 13.0, 11.2] {
        world.put_object(Point::new(x_m, 5.0));
    }
    world.robot.fuel = 0.9;
    let mut run = Run::new(world);
    assert!(run.until(600.0, |run| run.active("refuel")));
    let placed = run.world.robot.counted;
    assert!(run.world.robot.fuel > 0.5 && placed < 6);
    assert!(run.until(60.0, |run| run.world.robot.fuel > 0.98));
    assert!(run.until(600.0, |run| run.world.nest_complete()));
    assert!(!run.measures().stranded);
}

/// A robot with a part of its fuel, and a station in view or not.
fn thirsty(fuel: f64, in_view: bool) -> Run {
    let mut world = floor();
    world.put_object(Point::new(12.0, 6.0));
    world.put_station(if in_view {
        Point::new(10.0, 7.0)
    } else {
        Point::new(2.0, 2.0)
    });
    world.robot.fuel = fuel;
    Run::new(world)
}

#[test]
fn above_the_lower_of_two_thresholds_it_refuels_only_with_a_station_in_view() {
    let mut run = thirsty(0.7, true);
    assert!(run.until(1.0, |run| run.active("refuel")));
    let mut run = thirsty(0.7, false);
    assert!(
        !run.until(1.0, |run| !run.active("nest-building")),
        "strongly excited, but it yields"
    );
}

#[test]
fn above_the_higher_of_two_thresholds_it_goes_and_looks_for_a_station() {
    let mut run = thirsty(0.5, false);
    assert!(run.until(1.0, |run| run.active("seek-station")));
    assert!(run.until(200.0, |run| run.world.robot.filling));
}

#[test]
fn with_a_single_threshold_the_same_one_decides_about_searching() {
    for (fuel, in_view, expected) in [
        (0.7, true, "nest-building"),
        (0.5, true, "use-station"),
        (0.5, false, "look-for-station"),
    ] {
        let mut run = thirsty(fuel, in_view);
        run.control
            .apply(ONE_THRESHOLD)
            .unwrap_or_else(|problems| panic!("{problems}"));
        run.until(0.2, |_| false);
        assert!(run.active(expected), "{expected} with {fuel}");
    }
}

#[test]
fn a_tie_of_two_drives_that_conflict_ends_in_displacement() {
    // Four times what is missing, less a half, is exactly the one that the cold gives nest building.
    let mut run = thirsty(0.625, false);
    run.beat();
    assert!(run.active("maintenance"), "neither builds nor seeks");
    assert!(!run.active("nest-building") && !run.active("seek-station"));
}

#[test]
fn one_two_and_more_obstacles_are_passed_by_the_three_rms() {
    // The eyes see past them, the body does not get past them.
    let single = vec![(10.5, 6.45, 0.4)];
    let double = vec![(10.5, 6.45, 0.4), (10.5, 5.55, 0.4)];
    let triple = vec![
        (10.5, 6.45, 0.4),
        (10.5, 5.55, 0.4),
        (10.5, 7.3, 0.4),
        (10.5, 4.7, 0.4),
    ];
    for (rm, obstacles) in [
        ("single-obstacle", single),
        ("two-obstacle", double),
        ("more-obstacle", triple),
    ] {
        let mut world = floor();
        world.planning = false;
        let object = world.put_object(Point::new(11.8, 6.0));
        for (x_m, y_m, radius_m) in obstacles {
            world.put_obstacle(Point::new(x_m, y_m), radius_m);
        }
        let mut run = Run::new(world);
        let mut used = false;
        let got = run.until(200.0, |run| {
            used |= run.active(rm);
            run.world.robot.held == Some(object)
        });
        assert!(got && used, "{rm}: reached {got}, used {used}");
        assert_eq!(run.measures().bumps, 0);
    }
}

#[test]
fn with_planning_the_way_is_known_before_it_is_gone() {
    let mut world = generate(5, Layout::default());
    world.planning = true;
    let mut run = Run::new(world);
    assert!(run.until(300.0, |run| run.active("planned-way")));
    assert!(run.until(900.0, |run| run.world.nest_complete()));
}

#[test]
fn a_run_is_repeatable_to_the_bit() {
    let run = || {
        let mut run = Run::new(generate(11, Layout::default()));
        run.until(400.0, |_| false);
        serde_json::to_string(&picture(&run)).expect("is plain data")
    };
    assert_eq!(run(), run());
}

#[test]
fn an_evaluation_in_the_world_does_not_allocate() {
    let mut run = Run::new(generate(5, Layout::default()));
    for _ in 0..400 {
        run.until(0.5, |_| false);
        let world = &run.world;
        let hierarchy = run.control.hierarchy_mut();
        let counted = allocation_counter::measure(|| {
            hierarchy.evaluate(world);
        });
        assert_eq!(counted.count_total, 0);
    }
}

#[test]
fn every_mcu_output_is_followed_by_an_evaluation_and_an_interrupt_does_not_wait_for_one() {
    let mut world = floor();
    world.planning = false;
    world.put_object(Point::new(12.0, 6.0));
    let mut run = Run::new(world);
    assert!(run.until(10.0, |run| run.active("roll") && run.world.robot.place.x_m > 8.3));
    while !run.beat() {}
    let beats = (1..).find(|_| run.beat()).expect("rolls end");
    assert_eq!(
        beats, 20,
        "half a metre at half a metre a second, in beats of 50 ms, and then at once"
    );
    assert!(!run.beat(), "the next roll is under way");
    run.world.order();
    assert!(run.beat(), "an order is a priority interrupt");
    assert!(!run.beat());
}

#[test]
fn the_picture_shows_the_lit_tree() {
    let mut run = Run::new(generate(3, Layout::default()));
    run.until(20.0, |_| false);
    let shown = picture(&run);
    let lit: Vec<&str> = shown
        .tree
        .iter()
        .filter(|lamp| lamp.active)
        .map(|lamp| lamp.name.as_str())
        .collect();
    assert!(lit.len() >= 2 && shown.working.len() == 1, "{lit:?}");
    assert!(
        shown
            .tree
            .iter()
            .filter(|lamp| lamp.level == "top")
            .all(|lamp| lamp.listens)
    );
    let json = serde_json::to_value(&shown).expect("is plain data");
    assert_eq!(
        json["objects"].as_array().map(Vec::len),
        Some(run.world.objects.len())
    );
    let drawn = adroit::draw::svg(run.control.hierarchy(), run.control.vocabulary());
    assert_eq!(drawn.matches("class=\"rm on\"").count(), lit.len());
    assert_eq!(
        drawn.matches("SRM of").count(),
        run.control.hierarchy().levels().len()
    );
}

#[test]
fn the_programs_are_in_their_standard_form() {
    for program in [adroit::nest::PROGRAM, ONE_THRESHOLD, adroit::drives::PROGRAM] {
        assert_eq!(adroit::language::format(program).as_deref(), Ok(program));
    }
}
