//! What evolution says: fitness over generations, frequency of alleles, and the trial.

use super::page::Page;
use super::statistics::{Mean, dollars, hundredth};
use super::svg::{COLOURS, Line, Plot};
use crate::evolve::Generation;
use crate::strategies::{Chromosome, SLOTS, all_chromosomes};

/// How the evolved truck did against every truck there is, on games evolution never saw.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The evolved truck.
    pub evolved: Chromosome,
    /// Games.
    pub games: usize,
    /// Every truck: its profit in cents, and by how much the evolved truck beat it in the same games.
    pub trucks: Vec<(Chromosome, Mean, Mean)>,
}

impl Trial {
    /// Compares; `profits[truck][game]` with trucks in the order of [`all_chromosomes`].
    ///
    /// # Panics
    /// When the evolved truck is not among them.
    pub fn new(evolved: Chromosome, profits: &[Vec<i64>]) -> Self {
        let all = all_chromosomes();
        let at = all
            .iter()
            .position(|truck| *truck == evolved)
            .expect("one of all trucks");
        let mut trucks: Vec<(Chromosome, Mean, Mean)> = all
            .into_iter()
            .zip(profits)
            .map(|(truck, own)| {
                let ahead = profits[at]
                    .iter()
                    .zip(own)
                    .map(|(evolved, other)| evolved - other);
                (truck, Mean::of(own.iter().copied()), Mean::of(ahead))
            })
            .collect();
        trucks.sort_by(|a, b| b.1.mean.total_cmp(&a.1.mean).then(a.0.cmp(&b.0)));
        Self {
            evolved,
            games: profits[at].len(),
            trucks,
        }
    }

    /// How many others it beats, loses to, and cannot be told from, at 95 %.
    pub fn score(&self) -> (usize, usize, usize) {
        let others = || self.trucks.iter().filter(|(truck, ..)| *truck != self.evolved);
        let beaten = others().filter(|(_, _, ahead)| ahead.is_above_zero()).count();
        let lost = others().filter(|(_, _, ahead)| ahead.is_below_zero()).count();
        (beaten, lost, others().count() - beaten - lost)
    }

    /// Its rank by mean profit, counted from 1.
    pub fn rank(&self) -> usize {
        1 + self
            .trucks
            .iter()
            .take_while(|(truck, ..)| *truck != self.evolved)
            .count()
    }

    /// The outcome in words.
    pub fn summary(&self) -> String {
        let (beaten, lost, open) = self.score();
        format!(
            "The evolved truck {} is number {} of {} by mean profit over {} unseen games. At 95 % it beats \
             {beaten}, loses to {lost}, and cannot be told from {open}. Each comparison stands for itself: \
             among {} of them about {} would come out wrong by chance.",
            self.evolved,
            self.rank(),
            self.trucks.len(),
            self.games,
            self.trucks.len() - 1,
            self.trucks.len() / 20,
        )
    }
}

/// Adds fitness and frequency of alleles to a page. `games` is what each member played.
pub fn add_to(page: &mut Page, generations: &[Generation], games: u32) {
    page.heading("Evolution: fitness over generations");
    page.paragraph("Profit a game: best, mean, and the band from the lowest to the highest tenth.");
    let profit = |cents: i64| cents as f64 / f64::from(games.max(1));
    let across = |generation: &Generation| f64::from(generation.number);
    let mean = |generation: &Generation| {
        Mean::of(generation.ranked.iter().map(|(_, fitness)| *fitness)).mean / f64::from(games.max(1))
    };
    let tenth = |generation: &Generation, hundredths: usize| {
        let sorted: Vec<i64> = generation
            .ranked
            .iter()
            .rev()
            .map(|(_, fitness)| *fitness)
            .collect();
        profit(hundredth(&sorted, hundredths))
    };
    let best = |generation: &Generation| profit(generation.ranked.first().map_or(0, |(_, fitness)| *fitness));
    let plot = Plot {
        title: "profit a game".to_owned(),
        size: (880.0, 300.0),
        across: "generation",
        lines: vec![
            Line {
                name: "best".to_owned(),
                colour: COLOURS[5],
                points: generations.iter().map(|one| (across(one), best(one))).collect(),
            },
            Line {
                name: "mean".to_owned(),
                colour: COLOURS[0],
                points: generations.iter().map(|one| (across(one), mean(one))).collect(),
            },
        ],
        band: generations
            .iter()
            .map(|one| (across(one), tenth(one, 10), tenth(one, 90)))
            .collect(),
        dots: false,
        label: dollars,
    };
    page.html(&plot.render());
    if let (Some(first), Some(last)) = (generations.first(), generations.last()) {
        let nearly = mean(first) + 0.9 * (mean(last) - mean(first));
        let there = generations
            .iter()
            .find(|one| mean(one) >= nearly)
            .map_or(0, |one| one.number);
        page.paragraph(&format!(
            "The mean went from {} to {} a game; nine tenths of the way were made by generation {there}.",
            dollars(mean(first)),
            dollars(mean(last)),
        ));
    }
    frequencies(page, generations);
}

fn frequencies(page: &mut Page, generations: &[Generation]) {
    page.heading("Evolution: frequency of each allele");
    page.key_to_alleles();
    for (slot, gene_slot) in SLOTS.iter().enumerate() {
        let share = |generation: &Generation, gene: usize| {
            let carriers = generation
                .ranked
                .iter()
                .filter(|(genome, _)| usize::from(genome.genes()[slot]) == gene);
            100.0 * carriers.count() as f64 / generation.ranked.len().max(1) as f64
        };
        let lines = gene_slot.alleles.iter().enumerate().map(|(gene, allele)| Line {
            name: format!("{gene} {}", allele.name),
            colour: COLOURS[gene % COLOURS.len()],
            points: generations
                .iter()
                .map(|one| (f64::from(one.number), share(one, gene)))
                .collect(),
        });
        let plot = Plot {
            title: gene_slot.name.to_owned(),
            size: (440.0, 200.0),
            across: "generation",
            lines: lines.collect(),
            band: Vec::new(),
            dots: false,
            label: |share| format!("{share:.0} %"),
        };
        page.html(&plot.render());
    }
}

/// Adds the trial to a page.
pub fn add_trial(page: &mut Page, trial: &Trial) {
    page.heading("Trial: the evolved truck against every truck, on games it never saw");
    page.paragraph(&trial.summary());
    let dots = |evolved: bool| {
        let ranked = trial.trucks.iter().enumerate();
        ranked
            .filter(move |(_, (truck, ..))| (*truck == trial.evolved) == evolved)
            .map(|(rank, (_, profit, _))| (rank as f64 + 1.0, profit.mean))
            .collect()
    };
    let plot = Plot {
        title: "mean profit a game of every truck, best first; the evolved one in orange".to_owned(),
        size: (880.0, 260.0),
        across: "rank",
        lines: vec![
            Line {
                name: "a truck".to_owned(),
                colour: COLOURS[0],
                points: dots(false),
            },
            Line {
                name: format!("evolved {}", trial.evolved),
                colour: COLOURS[5],
                points: dots(true),
            },
        ],
        band: Vec::new(),
        dots: true,
        label: dollars,
    };
    page.html(&plot.render());
    let rows: Vec<Vec<String>> = trial
        .trucks
        .iter()
        .enumerate()
        .filter(|(rank, (truck, ..))| *rank < 20 || *truck == trial.evolved)
        .map(|(rank, (truck, profit, ahead))| {
            let interval = |mean: &Mean| format!("{} ± {}", dollars(mean.mean), dollars(mean.half_width()));
            vec![
                truck.to_string(),
                (rank + 1).to_string(),
                interval(profit),
                interval(ahead),
            ]
        })
        .collect();
    page.table(
        &[
            "truck",
            "rank",
            "profit a game, 95 %",
            "evolved truck ahead by, 95 %",
        ],
        &rows,
    );
}
