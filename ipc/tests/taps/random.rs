//! Longer histories, drawn at random.
//!
//! Must never be the only place where a rule is checked: the short histories are checked exhaustively.

use proptest::prelude::*;

use crate::across::{inhibit_and_suppress, tap_on_tap};
use crate::changes::seen_late;
use crate::model::Suppressor;
use crate::series::{LOOKS, holder_agrees, register_agrees};

/// A longer history with few messages in it, and the taps it runs past.
fn long() -> impl Strategy<Value = (Vec<Suppressor>, Vec<u32>)> {
    let tap = (0_u8..4, 1_u64..40).prop_map(|(level, tau)| Suppressor { level, tau });
    proptest::collection::vec(tap, 1..=5).prop_flat_map(|taps| {
        let sources = taps.len() + 1;
        let row = prop_oneof![3 => Just(0), 1 => 0_u32..1 << sources];
        (Just(taps), proptest::collection::vec(row, 1..200))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn long_histories_agree((taps, history) in long()) {
        holder_agrees(&taps, &history);
        LOOKS.iter().for_each(|&look| register_agrees(&taps, &history, look));
    }

    #[test]
    fn long_histories_agree_when_seen_late((taps, history) in long(), late in proptest::collection::vec(0_u64..5, 6)) {
        seen_late(&history, &taps, &late);
    }

    #[test]
    fn long_inhibitions_agree((taps, history) in long(), tau in 1_u64..40, stride in 1_u64..5) {
        inhibit_and_suppress(&history, tau, taps[0].tau, stride);
        tap_on_tap(&history, tau, taps[0].tau, 1 + stride);
    }
}
