//! Distances: places for lines that keep their order and stay far enough apart.
//!
//! Must never bring two things closer than a constraint says; what has room stands in its middle.

/// Lines with least distances between them.
#[derive(Debug, Default)]
pub(crate) struct Distances {
    /// Where each line stands in the order.
    rank: Vec<usize>,
    /// Which line it was joined to.
    joined: Vec<usize>,
    least: Vec<(usize, usize, f64)>,
}

impl Distances {
    /// A line of that rank.
    pub(crate) fn line(&mut self, rank: usize) -> usize {
        self.rank.push(rank);
        self.joined.push(self.rank.len() - 1);
        self.rank.len() - 1
    }

    /// The rank of a line.
    pub(crate) fn rank(&self, line: usize) -> usize {
        self.rank[line]
    }

    fn root(&self, mut line: usize) -> usize {
        while self.joined[line] != line {
            line = self.joined[line];
        }
        line
    }

    /// Makes two lines of one rank the same.
    pub(crate) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b && self.rank[a] == self.rank[b] {
            self.joined[a.max(b)] = a.min(b);
        }
    }

    /// Keeps two lines apart, in the order of their ranks.
    pub(crate) fn apart(&mut self, a: usize, b: usize, least: f64) {
        if self.rank[a] < self.rank[b] {
            self.least.push((a, b, least));
        } else if self.rank[b] < self.rank[a] {
            self.least.push((b, a, least));
        }
    }

    /// A place for every line, from 0 up. Both the solution in which everything lies as low as it can and the
    /// one in which it lies as high as it can keep all distances, and so does the middle between the two.
    pub(crate) fn solve(&self) -> Vec<f64> {
        let least: Vec<(usize, usize, f64)> = self
            .least
            .iter()
            .map(|&(a, b, d)| (self.root(a), self.root(b), d))
            .collect();
        let mut up = least.clone();
        up.sort_by_key(|&(a, b, _)| (self.rank[a], self.rank[b]));
        let mut low = vec![0.0_f64; self.rank.len()];
        for &(a, b, d) in &up {
            low[b] = low[b].max(low[a] + d);
        }
        let end = low.iter().copied().fold(0.0, f64::max);
        let mut down = least;
        down.sort_by_key(|&(a, b, _)| std::cmp::Reverse((self.rank[b], self.rank[a])));
        let mut high = vec![end; self.rank.len()];
        for &(a, b, d) in &down {
            high[a] = high[a].min(high[b] - d);
        }
        (0..self.rank.len())
            .map(|line| {
                let root = self.root(line);
                (low[root] + high[root]) / 2.0
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_kept_and_slack_is_shared() {
        let mut d = Distances::default();
        let lines: Vec<usize> = [0, 1, 2, 2].map(|rank| d.line(rank)).to_vec();
        d.apart(lines[0], lines[3], 40.0);
        d.apart(lines[1], lines[0], 5.0);
        d.apart(lines[1], lines[2], 5.0);
        d.join(lines[2], lines[3]);
        let at = d.solve();
        assert_eq!(at, [0.0, 20.0, 40.0, 40.0]);
    }
}
