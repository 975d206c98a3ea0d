//! The pace of a world that goes by turns: slow, as its file says, fast, paused, one turn at a time.
//!
//! The operator sets it from an ordinary thread, the world reads it in its own. Must never be asked for by a
//! layer: behaviour keeps up with its world, not the other way round.

use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use ipc::clock::Span;

/// How long a turn lasts at the slow pace.
const SLOW: Span = Span::secs(2);

const FILED: u8 = 0;
const SLOWLY: u8 = 1;
const FAST: u8 = 2;
const PAUSED: u8 = 3;

/// The words of the operator, in the order of their numbers.
pub const WORDS: [&str; 4] = ["normal", "slow", "fast", "pause"];

/// How fast a world goes.
#[derive(Debug, Default)]
pub struct Pace {
    // Relaxed throughout: nothing else is read because of what stands here.
    word: AtomicU8,
    /// Turns that the operator asked for one by one and that have not begun.
    owed: AtomicU32,
}

impl Pace {
    /// Takes the operator's word: one of [`WORDS`], or `step`, which is one turn and then a pause.
    ///
    /// # Errors
    /// What there is to say instead.
    pub fn say(&self, word: &str) -> Result<(), String> {
        if word == "step" {
            self.word.store(PAUSED, Ordering::Relaxed);
            self.owed.fetch_add(1, Ordering::Relaxed);
            return Ok(());
        }
        let number = WORDS.iter().position(|known| *known == word);
        let number = number.ok_or_else(|| format!("no pace {word:?}: say {} or step", WORDS.join(", ")))?;
        self.word.store(number as u8, Ordering::Relaxed);
        self.owed.store(0, Ordering::Relaxed);
        Ok(())
    }

    /// The word that counts now.
    pub fn word(&self) -> &'static str {
        WORDS[usize::from(self.word.load(Ordering::Relaxed))]
    }

    /// Whether the next turn may begin, `since` the last one began; `filed` is how long one lasts by the
    /// creature's file. A turn that was asked for by itself is used up by this.
    pub fn next(&self, since: Span, filed: Span) -> bool {
        match self.word.load(Ordering::Relaxed) {
            FILED => since >= filed,
            SLOWLY => since >= SLOW.max(filed),
            FAST => true,
            _ => {
                let take = |owed: u32| owed.checked_sub(1);
                self.owed
                    .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take)
                    .is_ok()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_word_has_its_pace_and_a_step_is_one_turn() {
        let pace = Pace::default();
        let next = |ms| pace.next(Span::millis(ms), Span::millis(500));
        assert!(!next(499) && next(500), "by the file");
        pace.say("slow").expect("a word");
        assert!(!next(1_999) && next(2_000));
        pace.say("fast").expect("a word");
        assert!(next(0));
        pace.say("pause").expect("a word");
        assert!(!next(1_000_000));
        pace.say("step").expect("a word");
        pace.say("step").expect("a word");
        assert!(next(0) && next(0) && !next(1_000_000), "two turns were asked for");
        assert_eq!(pace.word(), "pause");
        pace.say("step").expect("a word");
        pace.say("normal").expect("a word");
        pace.say("pause").expect("a word");
        assert!(!next(0), "what was owed is forgotten with another pace");
        assert!(
            pace.say("quick")
                .expect_err("no word")
                .contains("slow, fast, pause or step")
        );
    }
}
