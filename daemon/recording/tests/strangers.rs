//! What layer processes say may be anything; a recording stays one that can be looked at.

use std::sync::Arc;

use ipc::clock::{Span, Time};
use ipc::message::{Kind, WORDS_MAX};
use ipc::wire::Reading;
use recording::manifest::{FORMAT, Manifest};
use recording::{Item, Plugged, Writer};
use serde_json::json;

const BEGAN: u64 = 5_000_000_000;

fn manifest() -> Manifest {
    Manifest {
        format: FORMAT,
        creature: "none".into(),
        program: "test".into(),
        seed: 0,
        began_ns: BEGAN,
        offset_ns: 1_000_000_000_000,
        causes: Vec::new(),
        sources: Vec::new(),
        taps: Vec::new(),
        wires: Vec::new(),
        plugs: Vec::new(),
        file: String::new(),
    }
}

fn stranger() -> Plugged {
    let plug = json!({
        "layer": "stranger", "level": 1, "period": 20_000_000, "pid": 1, "owner": "x",
        "outputs": [{"name": "m.out", "kind": "number", "unit": ""}],
        "modules": [], "wires": [], "taps": [],
    });
    Plugged {
        number: 7,
        plug: serde_json::from_value(plug).expect("a plug"),
        taps: Vec::new(),
    }
}

#[test]
fn stamps_that_cannot_be_do_not_stretch_the_time_line() {
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes, &Arc::new(manifest())).expect("memory can be written to");
    let mut write = |item: Item| writer.write(&item).expect("memory can be written to");
    write(Item::Plugged(Time(BEGAN), Arc::new(stranger())));
    let said = [0, BEGAN + 7, u64::MAX];
    for (number, stamp) in (1..).zip(said) {
        write(Item::Wire {
            plug: 7,
            index: 0,
            kind: Kind::Number,
            reading: Box::new(Reading {
                number,
                stamp: Time(stamp),
                words: [0.5; WORDS_MAX],
            }),
        });
    }
    assert_eq!(writer.finish().expect("memory can be written to"), 0);
    let all = mcap::MessageStream::new(&bytes).expect("a whole file");
    let logged: Vec<u64> = all
        .map(|m| m.expect("sound"))
        .filter(|m| m.channel.topic == "/wires/m.out")
        .map(|m| m.log_time - 1_000_000_000_000)
        .collect();
    assert_eq!(logged, [BEGAN, BEGAN + 7, BEGAN + Span::secs(10).0]);
    let read = recording::reader::parse(&bytes).expect("a recording");
    let stamps: Vec<u64> = read.wires[&(7, "m.out".into())]
        .iter()
        .map(|m| m.stamp.0)
        .collect();
    assert_eq!(stamps, said, "what was said is kept");
}
