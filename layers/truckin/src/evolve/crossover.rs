//! Single-point crossover.

use super::genome::Genome;

/// Divides both parents after `point` genes and joins each left part with the other's right part
/// (Gantchev 2001, 4.1: 0312 and 1023 at 3 give 0313 and 1022). At the number of genes itself, which
/// the source allows, the offspring are copies of the parents.
///
/// # Panics
/// When the parents differ in length or `point` is not from 1 to the number of genes.
pub fn crossover(one: &Genome, other: &Genome, point: usize) -> [Genome; 2] {
    let genes = one.genes().len();
    assert_eq!(genes, other.genes().len(), "parents of one kind");
    assert!(
        (1..=genes).contains(&point),
        "a crossover point from 1 to {genes}, not {point}"
    );
    let join = |left: &Genome, right: &Genome| {
        Genome(
            left.genes()[..point]
                .iter()
                .chain(&right.genes()[point..])
                .copied()
                .collect(),
        )
    };
    [join(one, other), join(other, one)]
}
