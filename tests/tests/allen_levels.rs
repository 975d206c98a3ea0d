//! Allen's levels pasted on one by one: every manifest fits the creature below it, and level 2 comes, sets out
//! for places and goes without a trace.

use std::sync::Arc;

use daemon::body::office::OfficeWorld;
use daemon::machine::kinds;
use daemon::virtual_run::{BEGIN, Manifest, Options, Stimulus, VirtualRun};
use ipc::clock::Span;
use ipc::wiring::creature::Creature;
use ipc::wiring::{Source, check, directory::Directory};

fn creature(name: &str, text: &str) -> Creature {
    let checked = check::creature(&Source::new(name, text), &kinds());
    checked.unwrap_or_else(|rejected| panic!("{rejected}"))
}

fn layer(manifest: &str) -> &str {
    let at = manifest.find("[[layer]]").expect("a manifest has a layer");
    manifest[at..].trim_end()
}

#[test]
fn creature_files_with_several_levels_hold_the_manifests_as_they_are() {
    let level_0 = layer(allen::CREATURE);
    let level_0 = &level_0[..level_0.find("[halt]").expect("a creature has a halt channel")];
    for text in [allen::CREATURE_01, allen::CREATURE_012] {
        assert!(text.contains(level_0), "level 0 is another one");
        assert!(text.contains(layer(allen::WANDER)), "level 1 is another one");
    }
    assert!(allen::CREATURE_012.contains(layer(allen::EXPLORE)));
}

#[test]
fn every_level_finds_what_it_taps_in_the_creature_below_it() {
    let fits = |host: &str, name: &str, text: &str| {
        let host = Directory::of(&creature("host.toml", host), "allen/host");
        let checked = check::manifest(&Source::new(name, text), &kinds(), &host);
        checked.map(|c| c.layers[0].level)
    };
    let below = [
        (allen::CREATURE, "wander.toml", allen::WANDER, 1),
        (allen::CREATURE_01, "explore.toml", allen::EXPLORE, 2),
        (allen::CREATURE_012, "corridor.toml", allen::CORRIDOR, 3),
        (allen::CREATURE_012, "company.toml", allen::COMPANY, 4),
        (allen::CREATURE_012, "home.toml", allen::HOME, 5),
    ];
    for (host, name, text, level) in below {
        match fits(host, name, text) {
            Ok(found) => assert_eq!(found, level, "{name}"),
            Err(rejected) => panic!("{rejected}"),
        }
    }
    assert!(
        fits(allen::CREATURE, "explore.toml", allen::EXPLORE).is_err(),
        "level 2 taps level 1, and without it has nothing to tap"
    );
}

fn travelled(run: &mut VirtualRun) -> f64 {
    let body = run.machine.body.as_mut().expect("the creature has a body");
    let world = body.world.as_any().downcast_mut::<OfficeWorld>();
    world.expect("it is in an office").office().distance_travelled_m()
}

#[test]
fn level_2_comes_sets_out_for_places_and_goes_without_a_trace() {
    let creature = creature("allen-01.toml", allen::CREATURE_01);
    let mut run = VirtualRun::with(creature, &kinds(), &Options::default());
    run.advance(Span::secs(5));
    let explore = Manifest {
        source: allen::explore_manifest(),
        table: None,
    };
    let refused = run.moment(BEGIN + run.elapsed(), &[Stimulus::Plug(Arc::new(explore))]);
    assert!(refused.is_empty(), "{:?}", refused[0].1);
    run.advance(Span::secs(600));
    let delivered = |run: &VirtualRun, from: &str, to: &str| {
        let tap = run
            .tap(from, to)
            .unwrap_or_else(|| panic!("there is a tap from {from} to {to}"));
        tap.counts.delivered
    };
    let headings = delivered(&run, "pathplan.heading", "avoid.goal");
    assert!(headings > 40, "level 2 set out for nowhere: {headings} headings");
    assert!(delivered(&run, "whenlook.hold", "wander.heading") > 10);
    run.moment(BEGIN + run.elapsed(), &[Stimulus::Leave("explore".into())]);
    run.advance(Span::secs(2));
    let (said, gone) = (
        delivered(&run, "pathplan.heading", "avoid.goal"),
        travelled(&mut run),
    );
    run.advance(Span::secs(300));
    assert_eq!(delivered(&run, "pathplan.heading", "avoid.goal"), said);
    assert!(travelled(&mut run) > gone + 2.0, "levels 0 and 1 do not go on");
}
