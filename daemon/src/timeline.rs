//! The time line: when the body was halted, a layer attached, a tap held, a layer late; some minutes of it.
//!
//! Must never be written from a real-time thread, nor grow without end: of each kind the oldest goes first.
//!
//! Local word: a *stretch* is a time during which something stood. It is open while that stands, and a moment if it
//! began and ended at once. Each change of one has a number of its own, so that those who look ask for what is new.

use std::collections::{BTreeMap, HashMap};

use serde_json::{Value, json};

/// Most stretches kept of each kind: ten minutes of a tap that holds and lets go three times a second.
pub const STRETCHES_MAX: usize = 2000;

/// What a stretch is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum What {
    /// The body was halted; named by the cause.
    Halt,
    /// A reflex held the body back: everyday life, and no alarm.
    Reflex,
    /// A layer process was attached; named by the layer.
    Layer,
    /// A tap held; named `from>to`.
    Tap,
    /// Beats of a layer ended after the next was due; named by the layer.
    Overrun,
}

impl What {
    fn word(self) -> &'static str {
        match self {
            What::Halt => "halt",
            What::Reflex => "reflex",
            What::Layer => "layer",
            What::Tap => "tap",
            What::Overrun => "overrun",
        }
    }
}

#[derive(Debug)]
struct Stretch {
    what: What,
    name: String,
    text: String,
    /// Seconds since the daemon began.
    from_s: f64,
    /// The same; none while it is open.
    to_s: Option<f64>,
    changed: u64,
}

/// What stood when. Times are seconds since the daemon began.
#[derive(Debug, Default)]
pub struct TimeLine {
    stretches: BTreeMap<u64, Stretch>,
    newest: HashMap<(What, String), u64>,
    made: u64,
    changes: u64,
}

impl TimeLine {
    /// `name` stands, since `from_s` if it was not known to.
    pub fn stands(&mut self, what: What, name: &str, text: &str, from_s: f64) {
        if !self.is_open(what, name) {
            self.add(what, name, text, from_s, None);
        }
    }

    /// What stands of a kind is `names` and nothing else: all others ended at `now_s`, with the text that `why` has
    /// for them.
    pub fn only(&mut self, what: What, names: &[&str], now_s: f64, why: impl Fn(&str) -> Option<String>) {
        for stretch in self.stretches.values_mut() {
            let stands = stretch.to_s.is_some() || names.contains(&stretch.name.as_str());
            if stretch.what != what || stands {
                continue;
            }
            stretch.to_s = Some(now_s.max(stretch.from_s));
            if let Some(text) = why(&stretch.name) {
                stretch.text = text;
            }
            self.changes += 1;
            stretch.changed = self.changes;
        }
    }

    /// `name` holds from `from_s` to `until_s`: what it did until then goes on if there is no gap.
    pub fn holds(&mut self, what: What, name: &str, text: &str, from_s: f64, until_s: f64) {
        let number = self.newest.get(&(what, name.to_string()));
        let before = number.and_then(|number| self.stretches.get_mut(number));
        match before {
            Some(stretch) if stretch.to_s.is_some_and(|to_s| from_s <= to_s) => {
                if stretch.to_s.is_some_and(|to_s| until_s > to_s) {
                    stretch.to_s = Some(until_s);
                    self.changes += 1;
                    stretch.changed = self.changes;
                }
            }
            _ => self.add(what, name, text, from_s, Some(until_s)),
        }
    }

    /// Something happened at `at_s` and was over.
    pub fn moment(&mut self, what: What, name: &str, text: &str, at_s: f64) {
        self.add(what, name, text, at_s, Some(at_s));
    }

    /// What changed after the change numbered `after`, with the number of the last change.
    pub fn after(&self, after: u64) -> Value {
        let fresh = self.stretches.iter().filter(|(_, s)| s.changed > after);
        let stretches = fresh.map(|(number, s)| {
            json!({
                "number": number, "kind": s.what.word(), "name": s.name, "text": s.text,
                "from_s": s.from_s, "to_s": s.to_s,
            })
        });
        json!({"changes": self.changes, "stretches": stretches.collect::<Vec<_>>()})
    }

    fn is_open(&self, what: What, name: &str) -> bool {
        let number = self.newest.get(&(what, name.to_string()));
        let stretch = number.and_then(|number| self.stretches.get(number));
        stretch.is_some_and(|s| s.to_s.is_none())
    }

    fn add(&mut self, what: What, name: &str, text: &str, from_s: f64, to_s: Option<f64>) {
        self.made += 1;
        self.changes += 1;
        let stretch = Stretch {
            what,
            name: name.into(),
            text: text.into(),
            from_s,
            to_s,
            changed: self.changes,
        };
        self.stretches.insert(self.made, stretch);
        self.newest.insert((what, name.into()), self.made);
        let mut kept = self.stretches.iter().filter(|(_, s)| s.what == what);
        if kept.clone().count() <= STRETCHES_MAX {
            return;
        }
        // What is open stays: its end would not be seen otherwise.
        let oldest = kept.find(|(_, s)| s.to_s.is_some());
        let Some((number, name)) = oldest.map(|(number, s)| (*number, s.name.clone())) else {
            return;
        };
        self.stretches.remove(&number);
        let key = (what, name);
        if self.newest.get(&key) == Some(&number) {
            self.newest.remove(&key);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(line: &TimeLine, after: u64) -> Vec<(String, f64, Option<f64>)> {
        let all = line.after(after)["stretches"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        let one = |s: &Value| {
            let name = s["name"].as_str().unwrap_or_default().to_string();
            (name, s["from_s"].as_f64().expect("a time"), s["to_s"].as_f64())
        };
        all.iter().map(one).collect()
    }

    #[test]
    fn a_layer_comes_goes_and_comes_again() {
        let mut line = TimeLine::default();
        line.stands(What::Layer, "wander", "pid 7", 1.0);
        line.stands(What::Layer, "wander", "pid 7", 1.1);
        line.only(What::Layer, &["wander"], 1.1, |_| None);
        assert_eq!(shown(&line, 0), [("wander".into(), 1.0, None)]);
        line.only(What::Layer, &[], 2.0, |_| Some("died".into()));
        line.stands(What::Layer, "wander", "pid 8", 3.0);
        let both = [("wander".into(), 1.0, Some(2.0)), ("wander".into(), 3.0, None)];
        assert_eq!(shown(&line, 0), both);
        assert_eq!(line.after(0)["stretches"][0]["text"], "died");
    }

    #[test]
    fn windows_that_meet_are_one_stretch_and_a_gap_begins_another() {
        let mut line = TimeLine::default();
        line.holds(What::Tap, "a>b", "suppress", 1.0, 2.0);
        let seen = line.after(0)["changes"].as_u64().expect("a number");
        line.holds(What::Tap, "a>b", "suppress", 1.0, 2.0);
        assert!(shown(&line, seen).is_empty(), "nothing is new");
        line.holds(What::Tap, "a>b", "suppress", 1.9, 2.9);
        assert_eq!(shown(&line, seen), [("a>b".into(), 1.0, Some(2.9))]);
        line.holds(What::Tap, "a>b", "suppress", 3.0, 4.0);
        assert_eq!(shown(&line, 0).len(), 2);
    }

    #[test]
    fn it_keeps_what_is_open_and_does_not_grow() {
        let mut line = TimeLine::default();
        line.stands(What::Tap, "open", "", 0.0);
        line.stands(What::Layer, "wander", "", 0.0);
        for k in 0..3 * STRETCHES_MAX {
            line.moment(What::Tap, &format!("t{}", k % 7), "", k as f64);
        }
        assert_eq!(line.stretches.len(), STRETCHES_MAX + 1);
        assert!(line.is_open(What::Tap, "open") && line.is_open(What::Layer, "wander"));
        for k in 0..3 * STRETCHES_MAX {
            line.moment(What::Overrun, &format!("layer{k}"), "", k as f64);
        }
        assert!(line.newest.len() <= STRETCHES_MAX + 9, "{}", line.newest.len());
    }
}
