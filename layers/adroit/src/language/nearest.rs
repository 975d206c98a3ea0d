//! The known name nearest to one that is not known.

/// A suggestion may differ in a third of its letters, and in two at least.
fn reach(written: &str) -> usize {
    (written.chars().count() / 3).max(2)
}

/// The nearest known name within reach; of equally near ones the first in the alphabet.
pub(crate) fn nearest<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|name| (distance(written, name), name))
        .filter(|&(distance, _)| distance <= reach(written))
        .min()
        .map(|(_, name)| name)
}

/// Least number of letters to insert, remove or replace, or of neighbours to swap.
fn distance(from: &str, to: &str) -> usize {
    let from: Vec<char> = from.chars().collect();
    let to: Vec<char> = to.chars().collect();
    let mut before = vec![0; to.len() + 1];
    let mut above: Vec<usize> = (0..=to.len()).collect();
    for row in 1..=from.len() {
        let mut here = vec![row; to.len() + 1];
        for column in 1..=to.len() {
            let differs = usize::from(from[row - 1] != to[column - 1]);
            let mut least = (above[column - 1] + differs)
                .min(above[column] + 1)
                .min(here[column - 1] + 1);
            let swapped =
                row > 1 && column > 1 && from[row - 1] == to[column - 2] && from[row - 2] == to[column - 1];
            if swapped {
                least = least.min(before[column - 2] + 1);
            }
            here[column] = least;
        }
        before = std::mem::replace(&mut above, here);
    }
    above[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let known = ["closest-object", "leftmost-object", "station"];
        assert_eq!(nearest("closet-object", known), Some("closest-object"));
        assert_eq!(nearest("sattion", known), Some("station"));
        assert_eq!(nearest("temperature", known), None);
    }
}
