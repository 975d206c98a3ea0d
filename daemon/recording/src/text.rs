//! Beats and messages as the JSON texts that stand in a recording.
//!
//! Must never write a number that reads back as another: every finite number comes back to the bit.

use std::io::Write;

use ipc::clock::Time;
use ipc::message::Kind;
use ipc::wire::Fate;
use serde_json::{Value, json};

use crate::schema;

/// What a beat comes to on its topic.
#[derive(Default)]
pub(crate) struct BeatNote {
    pub(crate) saw: Vec<(usize, u64)>,
    pub(crate) rejected: Vec<(usize, u64)>,
    pub(crate) faults: Vec<(usize, u64)>,
    pub(crate) taps: Vec<(u16, u64, u64, u8)>,
    pub(crate) joined: Vec<Value>,
    pub(crate) released: Vec<u32>,
    pub(crate) dropped: Vec<usize>,
    pub(crate) causes: Option<u64>,
}

impl BeatNote {
    pub(crate) fn saw(&mut self, slot: usize, number: u64, fate: Fate) {
        match fate {
            Fate::Delivered => self.saw.push((slot, number)),
            Fate::Rejected => self.rejected.push((slot, number)),
            Fate::Fault => self.faults.push((slot, number)),
        }
    }

    pub(crate) fn text(self, (number, step, commit): (u64, Time, Time), base: bool) -> Value {
        let mut text = json!({"beat": number, "step_ns": step.0, "commit_ns": commit.0});
        let mut add = |name: &str, there: bool, value: Value| {
            if there {
                text[name] = value;
            }
        };
        add("base", base, json!(base));
        add("saw", !self.saw.is_empty(), json!(self.saw));
        add("rejected", !self.rejected.is_empty(), json!(self.rejected));
        add("faults", !self.faults.is_empty(), json!(self.faults));
        add("taps", !self.taps.is_empty(), json!(self.taps));
        add("joined", !self.joined.is_empty(), json!(self.joined));
        add("released", !self.released.is_empty(), json!(self.released));
        add("dropped", !self.dropped.is_empty(), json!(self.dropped));
        add("causes", self.causes.is_some(), json!(self.causes));
        text
    }
}

/// A message as JSON, into `text`.
pub(crate) fn message_text(text: &mut Vec<u8>, kind: Kind, number: u64, stamp: Time, words: &[f64]) {
    text.clear();
    // Writing into memory does not fail.
    let _ = write!(text, "{{\"number\":{number},\"stamp_ns\":{}", stamp.0);
    let put = |text: &mut Vec<u8>, word: f64| drop(serde_json::to_writer(text, &word));
    for (name, &word) in schema::fields(kind).iter().zip(words) {
        let _ = write!(text, ",\"{name}\":");
        put(text, word);
    }
    match kind {
        Kind::Bit => {
            let _ = write!(text, ",\"value\":{}", words[0] != 0.0);
        }
        Kind::Map => {
            text.extend(b",\"ranges\":[");
            for (k, &word) in words.iter().enumerate() {
                if k > 0 {
                    text.push(b',');
                }
                put(text, word);
            }
            text.push(b']');
        }
        _ => {}
    }
    text.push(b'}');
}
