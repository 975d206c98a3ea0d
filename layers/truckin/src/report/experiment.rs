//! What the grid says: which alleles win in which cell.

use std::collections::BTreeMap;

use super::page::Page;
use super::statistics::{Mean, dollars, hundredth};
use super::svg::{COLOURS, Line, Plot};
use crate::grid::{Cell, Row};
use crate::ootland::rules::STEP_MILLILITRES;
use crate::strategies::SLOTS;

/// The rows of each cell.
fn by_cell(rows: &[Row]) -> BTreeMap<Cell, Vec<&Row>> {
    let mut cells: BTreeMap<Cell, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        cells.entry(row.cell).or_default().push(row);
    }
    cells
}

/// Mean profit of each allele of a slot.
fn alleles(rows: &[&Row], slot: usize) -> Vec<Mean> {
    (0..SLOTS[slot].alleles.len())
        .map(|gene| {
            let with = rows
                .iter()
                .filter(|row| usize::from(row.chromosome.genes()[slot]) == gene);
            Mean::of_clusters(with.map(|row| (row.game, row.profit_cents)))
        })
        .collect()
}

/// The winner of a slot and whether it is clear of the runner-up.
fn winner(means: &[Mean]) -> Option<(usize, bool)> {
    let mut order: Vec<usize> = (0..means.len()).filter(|gene| means[*gene].count > 0).collect();
    order.sort_by(|a, b| means[*b].mean.total_cmp(&means[*a].mean));
    let &first = order.first()?;
    let clear = order.get(1).is_none_or(|&second| {
        let apart = means[first].mean - means[second].mean;
        apart > means[first].half_width().hypot(means[second].half_width())
    });
    Some((first, clear))
}

/// Adds everything the grid says to a page.
pub fn add_to(page: &mut Page, rows: &[Row]) {
    let cells = by_cell(rows);
    page.heading("The grid: how trucks fared");
    page.paragraph(
        "Profit of all trucks of a cell, each drawn at random from all chromosomes. \
         Intervals take each game as one observation.",
    );
    page.table(
        &[
            "trucks × slots",
            "trucks played",
            "mean",
            "95 % ±",
            "median",
            "best",
            "made a profit",
            "dry tank",
        ],
        &cells
            .iter()
            .map(|(cell, rows)| overview(*cell, rows))
            .collect::<Vec<_>>(),
    );
    page.heading("The grid: which alleles win in which cell");
    page.paragraph(
        "The allele with the highest mean profit over all trucks that carry it, whatever their other \
         genes; in brackets when the runner-up is not clearly below (95 %).",
    );
    let head: Vec<&str> = std::iter::once("trucks × slots")
        .chain(SLOTS.map(|slot| slot.name))
        .collect();
    let winners: Vec<Vec<String>> = cells
        .iter()
        .map(|(cell, rows)| {
            let slots = (0..SLOTS.len()).map(|slot| {
                let means = alleles(rows, slot);
                winner(&means).map_or_else(String::new, |(gene, clear)| {
                    let text = format!("{gene} {}", SLOTS[slot].alleles[gene].name);
                    if clear { text } else { format!("({text})") }
                })
            });
            std::iter::once(name(*cell)).chain(slots).collect()
        })
        .collect();
    page.table(&head, &winners);
    panels(page, &cells);
}

fn name(cell: Cell) -> String {
    format!("{} × {}", cell.trucks, cell.slots)
}

fn overview(cell: Cell, rows: &[&Row]) -> Vec<String> {
    let mean = Mean::of_clusters(rows.iter().map(|row| (row.game, row.profit_cents)));
    let mut sorted: Vec<i64> = rows.iter().map(|row| row.profit_cents).collect();
    sorted.sort_unstable();
    let share = |count: usize| format!("{} %", count * 100 / rows.len().max(1));
    vec![
        name(cell),
        rows.len().to_string(),
        dollars(mean.mean),
        dollars(mean.half_width()),
        dollars(hundredth(&sorted, 50) as f64),
        dollars(sorted.last().copied().unwrap_or(0) as f64),
        share(rows.iter().filter(|row| row.profit_cents > 0).count()),
        share(
            rows.iter()
                .filter(|row| row.tank_millilitres < STEP_MILLILITRES)
                .count(),
        ),
    ]
}

/// A small plot for each slot and number of trucks: profit of each allele over the length of the game.
fn panels(page: &mut Page, cells: &BTreeMap<Cell, Vec<&Row>>) {
    page.key_to_alleles();
    let mut truck_counts: Vec<u32> = cells.keys().map(|cell| cell.trucks).collect();
    truck_counts.dedup();
    for (slot, gene_slot) in SLOTS.iter().enumerate() {
        page.html("<div>");
        for &trucks in &truck_counts {
            let of_trucks: Vec<_> = cells.iter().filter(|(cell, _)| cell.trucks == trucks).collect();
            let means: Vec<(f64, Vec<Mean>)> = of_trucks
                .iter()
                .map(|(cell, rows)| (f64::from(cell.slots), alleles(rows, slot)))
                .collect();
            let lines = gene_slot.alleles.iter().enumerate().map(|(gene, allele)| Line {
                name: format!("{gene} {}", allele.name),
                colour: COLOURS[gene % COLOURS.len()],
                points: means
                    .iter()
                    .map(|(slots, means)| (*slots, means[gene].mean))
                    .collect(),
            });
            let plot = Plot {
                title: format!("{}, {trucks} trucks", gene_slot.name),
                size: (212.0, 150.0),
                across: "slots",
                lines: lines.collect(),
                band: Vec::new(),
                dots: false,
                label: dollars,
            };
            page.html(&plot.render());
        }
        page.html("</div>\n");
    }
}
