//! Company: whom the creature that is measured has beside it, interval by interval.
//!
//! Must never put two intervals of one kind beside each other under churn: what the host does for seconds on end is in all.

use std::time::Duration;

use crate::churn;
use crate::load::CHURN_EVERY;

/// Whom an interval had for company.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Company {
    /// Nobody.
    Nobody,
    /// Those who came and went at a neighbour: what they cost the host.
    Elsewhere,
    /// Those who came and went at the creature measured.
    Here,
}

impl Company {
    /// What follows each other under churn.
    pub const TURNS: [Company; 3] = [Company::Nobody, Company::Elsewhere, Company::Here];
}

/// Turns that the time of a creature without company is cut into.
const TURNS: u32 = 7;

/// Most turns under churn: their ratios have a median that the host's worse seconds do not move.
const CHURN_TURNS_MAX: u32 = 20;

/// How many intervals a time is cut into: whole turns, and under churn none so short that nobody comes and goes in it.
pub(crate) fn intervals(length: Duration, churning: bool) -> u32 {
    let all = Company::TURNS.len() as u32;
    let least = Duration::from_nanos(CHURN_EVERY.0) * churn::EVENTS * all;
    let turns = match churning {
        true => ((length.as_secs_f64() / least.as_secs_f64()) as u32).clamp(1, CHURN_TURNS_MAX),
        false => TURNS,
    };
    turns * all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everybody_who_comes_in_an_interval_is_gone_at_its_end() {
        let seconds = Duration::from_secs;
        assert_eq!(intervals(seconds(12), true), 9);
        assert_eq!(intervals(seconds(60), true), 48);
        assert_eq!(intervals(seconds(300), true), 60);
        assert_eq!(intervals(seconds(1), true), 3);
        assert_eq!(intervals(seconds(1), false), 21);
    }
}
