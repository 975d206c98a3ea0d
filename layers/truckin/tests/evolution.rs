//! Evolution: the source's example, its shares, and a creature that is no truck.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use tempfile::TempDir;
use truckin::arena::TruckArena;
use truckin::evolve::{Arena, Breeding, Evolution, Genome, crossover};
use truckin::ootland::{Chance, World};

#[test]
fn the_worked_example_of_the_source() {
    let parents = [Genome::new(&[0, 3, 1, 2]), Genome::new(&[1, 0, 2, 3])];
    let offspring = crossover(&parents[0], &parents[1], 3);
    assert_eq!(
        offspring,
        [Genome::new(&[0, 3, 1, 3]), Genome::new(&[1, 0, 2, 2])]
    );
    assert_eq!(offspring.map(|genome| genome.to_string()), ["0313", "1022"]);
    assert_eq!(
        crossover(&parents[0], &parents[1], 4),
        parents,
        "the last point copies"
    );
}

#[test]
#[should_panic(expected = "crossover point")]
fn there_is_no_point_before_the_first_gene() {
    crossover(&Genome::new(&[0, 1]), &Genome::new(&[1, 0]), 0);
}

/// A beetle with six slots of three alternatives; the more twos the better.
struct Beetles;

impl Arena for Beetles {
    fn kinds(&self) -> &[u8] {
        &[3; 6]
    }

    fn fitness(&self, _: u32, population: &[Genome]) -> Vec<i64> {
        population
            .iter()
            .map(|genome| genome.genes().iter().filter(|gene| **gene == 2).count() as i64)
            .collect()
    }
}

#[test]
fn any_creature_with_slots_evolves() {
    let mut evolution = Evolution::new(&Beetles, Breeding::of(60), Chance::new(1, 0));
    let best: Vec<i64> = (0..25).map(|_| evolution.next_generation().ranked[0].1).collect();
    assert!(
        best.windows(2).all(|pair| pair[0] <= pair[1]),
        "the best go on: {best:?}"
    );
    assert_eq!(best.last(), Some(&6));
}

#[test]
fn the_shares_are_those_of_the_source() {
    let breeding = Breeding::of(50);
    assert_eq!((breeding.parents(), breeding.bred()), (20, 40));
    let mut evolution = Evolution::new(&Beetles, breeding, Chance::new(2, 0));
    let first = evolution.next_generation();
    let second = evolution.next_generation();
    assert_eq!((first.ranked.len(), second.ranked.len()), (50, 50));
    let mut members: Vec<&Genome> = second.ranked.iter().map(|(genome, _)| genome).collect();
    for (parent, _) in &first.ranked[..20] {
        let at = members
            .iter()
            .position(|member| *member == parent)
            .expect("the top 40 % go on");
        members.swap_remove(at);
    }
    assert_eq!(members.len(), 30, "20 offspring and 10 at random");
}

#[test]
fn trucks_evolve_the_same_on_any_number_of_threads() {
    let evolve = |threads| {
        let arena = TruckArena::new(World::default(), 4, 200, 3, 9, threads);
        let mut evolution = Evolution::new(&arena, Breeding::of(20), Chance::new(9, 0));
        (0..3).map(|_| evolution.next_generation()).collect::<Vec<_>>()
    };
    assert_eq!(evolve(1), evolve(3));
}

#[test]
fn ctrl_c_reports_the_generations_so_far() {
    let place = TempDir::new().expect("a folder");
    let report = place.path().join("stopped.html");
    // It does not end by itself before it is told to.
    let mut child = Command::new(env!("CARGO_BIN_EXE_truckin"))
        .args([
            "evolve",
            "--generations",
            "100000",
            "--population",
            "5",
            "--games",
            "1",
        ])
        .args(["--slots", "50", "--threads", "1", "--report"])
        .arg(&report)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    let mut lines = BufReader::new(child.stdout.take().expect("piped")).lines();
    for _ in 0..3 {
        let line = lines.next().expect("a generation").expect("text");
        assert!(line.starts_with("generation"), "{line}");
    }
    let told = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(told.expect("kill starts").success());
    let rest: Vec<String> = lines.map(|line| line.expect("text")).collect();
    let done = child.wait_with_output().expect("its end");
    let said = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(130), "{said}");
    let generations = 3 + rest.iter().filter(|line| line.starts_with("generation")).count();
    let kept = format!("{generations} of 100000 generations, 0 of 1000 games of the trial");
    assert!(said.contains(&kept), "{said}");
    let page = std::fs::read_to_string(&report).expect("the report");
    assert!(page.contains(&kept), "the report says so too");
}
