//! From one generation to the next: the best two fifths go on and mate, a fifth is new.

use super::arena::Arena;
use super::crossover::crossover;
use super::genome::Genome;
use crate::ootland::Chance;

/// How a generation makes the next, in hundredths of the population (Gantchev 2001, 4.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Breeding {
    /// Members.
    pub population: usize,
    /// The best, who go on and are the mating pool.
    pub parents_hundredths: usize,
    /// Parents and offspring together; the rest is random.
    pub bred_hundredths: usize,
}

impl Breeding {
    /// The source's shares: top 40 %, 80 % bred, 20 % random.
    pub fn of(population: usize) -> Self {
        Self {
            population,
            parents_hundredths: 40,
            bred_hundredths: 80,
        }
    }

    /// How many go on; at least one.
    pub fn parents(&self) -> usize {
        (self.population * self.parents_hundredths / 100).max(1)
    }

    /// How many parents and offspring there are.
    pub fn bred(&self) -> usize {
        (self.population * self.bred_hundredths / 100).max(self.parents())
    }
}

/// A population and what its members were worth, best first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Generation {
    /// Its number, counted from 0.
    pub number: u32,
    /// Members and fitness, best first; equals in the order of their genes.
    pub ranked: Vec<(Genome, i64)>,
}

/// An evolution under way.
pub struct Evolution<'a, A: Arena> {
    arena: &'a A,
    breeding: Breeding,
    chance: Chance,
    population: Vec<Genome>,
    number: u32,
}

impl<'a, A: Arena> Evolution<'a, A> {
    /// Starts from a random population.
    pub fn new(arena: &'a A, breeding: Breeding, mut chance: Chance) -> Self {
        let population = (0..breeding.population)
            .map(|_| Genome::random(arena.kinds(), &mut chance))
            .collect();
        Self {
            arena,
            breeding,
            chance,
            population,
            number: 0,
        }
    }

    /// Puts the population to the test, ranks it, and breeds the next one from it.
    pub fn next_generation(&mut self) -> Generation {
        let fitness = self.arena.fitness(self.number, &self.population);
        assert_eq!(fitness.len(), self.population.len(), "a fitness for every member");
        let mut ranked: Vec<(Genome, i64)> = self.population.drain(..).zip(fitness).collect();
        ranked.sort_by(|(one, a), (other, b)| b.cmp(a).then_with(|| one.cmp(other)));
        let generation = Generation {
            number: self.number,
            ranked,
        };
        self.population = self.breed(&generation);
        self.number += 1;
        generation
    }

    fn breed(&mut self, generation: &Generation) -> Vec<Genome> {
        let parents: Vec<Genome> = generation
            .ranked
            .iter()
            .take(self.breeding.parents())
            .map(|(genome, _)| genome.clone())
            .collect();
        let genes = self.arena.kinds().len() as u32;
        let mut next = parents.clone();
        while next.len() < self.breeding.bred() {
            let (one, other) = self.mating_pair(parents.len());
            let point = 1 + self.chance.below(genes) as usize;
            let room = self.breeding.bred() - next.len();
            next.extend(
                crossover(&parents[one], &parents[other], point)
                    .into_iter()
                    .take(room),
            );
        }
        while next.len() < self.breeding.population {
            next.push(Genome::random(self.arena.kinds(), &mut self.chance));
        }
        next
    }

    /// Two of the pool, different ones if there are two.
    fn mating_pair(&mut self, pool: usize) -> (usize, usize) {
        let one = self.chance.below(pool as u32) as usize;
        if pool == 1 {
            return (one, one);
        }
        let other = self.chance.below(pool as u32 - 1) as usize;
        (one, if other >= one { other + 1 } else { other })
    }
}
