//! The trucks' arena: where genomes of four digits meet in games of Truckin'.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::evolve::{Arena, Genome};
use crate::ootland::{Chance, Game, World};
use crate::strategies::{Chromosome, all_chromosomes, kinds};

/// Where trucks are put to the test.
#[derive(Clone, Debug)]
pub struct TruckArena {
    world: World,
    kinds: Vec<u8>,
    /// Trucks in a game.
    pub trucks: usize,
    /// Slots in a game.
    pub slots: u32,
    /// Games every member plays in a generation.
    pub games: u32,
    /// What everything is drawn from.
    pub seed: u64,
    /// Threads to play on; the results do not depend on them.
    pub threads: usize,
}

/// Streams of the games of a generation begin at its number times this.
const GENERATION_STREAMS: u64 = 1 << 32;
/// What is added to the seed for games that evolution never sees.
const UNSEEN_SEED: u64 = 0x5EED_0F7E;

impl TruckArena {
    /// An arena.
    pub fn new(world: World, trucks: usize, slots: u32, games: u32, seed: u64, threads: usize) -> Self {
        Self {
            world,
            kinds: kinds().to_vec(),
            trucks,
            slots,
            games,
            seed,
            threads,
        }
    }

    /// One game of every member, in groups drawn anew: profit of each, in cents.
    fn round(&self, generation: u32, round: u32, members: &[Chromosome]) -> Vec<i64> {
        let stream = u64::from(generation) * GENERATION_STREAMS + (u64::from(round) << 12);
        let mut seats: Vec<usize> = (0..members.len()).collect();
        Chance::new(self.seed.wrapping_add(2), stream).shuffle(&mut seats);
        let mut profits = vec![0; members.len()];
        for (group, seats) in seats.chunks(self.trucks).enumerate() {
            let playing: Vec<Chromosome> = seats.iter().map(|seat| members[*seat]).collect();
            let mut game = Game::new(
                &self.world,
                &playing,
                self.slots,
                self.seed,
                stream + group as u64,
            );
            while !game.is_over() {
                game.play_slot();
            }
            for standing in game.standings() {
                profits[seats[standing.seat]] = standing.profit_cents;
            }
        }
        profits
    }

    /// Profit in cents of every truck there is in every game of a trial evolution never saw:
    /// `profits[truck][game]`, trucks in the order of [`all_chromosomes`].
    ///
    /// Each truck in turn takes the first seat of the same games against the same opponents, which
    /// are drawn for each game, so that differences between trucks are differences within games.
    ///
    /// Once `stop` is raised no further game begins: then there are only those up to then.
    pub fn trial(&self, games: u32, progress: &(dyn Fn(u64) + Sync), stop: &AtomicBool) -> Vec<Vec<i64>> {
        let all = all_chromosomes();
        let seed = self.seed ^ UNSEEN_SEED;
        // Relaxed: the flag guards nothing but itself.
        let go_on = || !stop.load(Ordering::Relaxed);
        let by_game = parallel(self.threads, games as usize, &go_on, |number| {
            let mut chance = Chance::new(seed.wrapping_add(1), number as u64);
            let mut playing: Vec<Chromosome> = (0..self.trucks)
                .map(|_| all[chance.below(all.len() as u32) as usize])
                .collect();
            let profits: Vec<i64> = all
                .iter()
                .map(|candidate| {
                    playing[0] = *candidate;
                    let mut game = Game::new(&self.world, &playing, self.slots, seed, number as u64);
                    while !game.is_over() {
                        game.play_slot();
                    }
                    game.standings()
                        .next()
                        .map_or(0, |standing| standing.profit_cents)
                })
                .collect();
            progress(1);
            profits
        });
        (0..all.len())
            .map(|truck| by_game.iter().map(|profits| profits[truck]).collect())
            .collect()
    }
}

impl Arena for TruckArena {
    fn kinds(&self) -> &[u8] {
        &self.kinds
    }

    fn fitness(&self, generation: u32, population: &[Genome]) -> Vec<i64> {
        let members: Vec<Chromosome> = population.iter().map(chromosome_of).collect();
        let rounds = parallel(self.threads, self.games as usize, &|| true, |round| {
            self.round(generation, round as u32, &members)
        });
        (0..members.len())
            .map(|member| rounds.iter().map(|profits| profits[member]).sum())
            .collect()
    }
}

/// The truck a genome names.
///
/// # Panics
/// When the genome is not one of a truck's.
pub fn chromosome_of(genome: &Genome) -> Chromosome {
    let genes = genome.genes().try_into().expect("four genes");
    Chromosome::new(genes).expect("genes drawn from the arena's kinds")
}

/// `of(0)`, `of(1)`, ... on several threads, as long as `go_on` says so; the order of the answers does not depend on them.
fn parallel<T: Send>(
    threads: usize,
    count: usize,
    go_on: &(dyn Fn() -> bool + Sync),
    of: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let mut answers: Vec<(usize, T)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.max(1))
            .map(|_| {
                scope.spawn(|| {
                    let mut mine = Vec::new();
                    loop {
                        // Relaxed: the counter only hands out numbers; joining carries the answers.
                        // Whoever takes a number answers it, so that there is no gap where it was stopped.
                        if !go_on() {
                            return mine;
                        }
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        if index >= count {
                            return mine;
                        }
                        mine.push((index, of(index)));
                    }
                })
            })
            .collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().expect("a worker"))
            .collect()
    });
    answers.sort_by_key(|(index, _)| *index);
    answers.into_iter().map(|(_, answer)| answer).collect()
}
