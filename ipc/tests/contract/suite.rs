//! What a page, its writers and its readers promise on any transport.
//!
//! Must never know which transport it runs on.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ipc::clock::Time;
use ipc::message::{KINDS, Kind, WORDS_MAX, Words};
use ipc::wire::{Reader, Writer};

use crate::transport::{Transport, WIRES};

type Case = fn(&dyn Transport);

/// Every promise by name.
pub(crate) const SUITE: &[(&str, Case)] = &[
    ("a_page_has_the_wires_it_was_made_with", has_its_wires),
    ("nothing_comes_before_the_first_write", nothing_at_first),
    ("the_newest_message_wins", newest_wins),
    ("the_number_counts_messages", number_counts),
    ("a_wire_has_one_writer", one_writer),
    ("a_message_has_its_kinds_length", lengths),
    ("every_bit_pattern_arrives_as_it_was", bit_patterns),
    ("a_late_reader_sees_the_newest", late_reader),
    ("wires_do_not_touch_each_other", wires_apart),
    ("ends_outlive_the_page_they_came_from", ends_keep_the_page),
    ("a_flood_neither_tears_nor_detains_a_read", flood),
];

fn all(word: f64) -> Words {
    [word; WORDS_MAX]
}

fn has_its_wires(t: &dyn Transport) {
    for page in [t.owner(), t.attach()] {
        assert_eq!(page.len(), WIRES);
        assert!(!page.is_empty());
        assert!(page.reader(WIRES - 1, Kind::Number).is_some());
        assert!(page.reader(WIRES, Kind::Number).is_none());
        assert!(page.reader(usize::MAX, Kind::Number).is_none());
        assert!(page.writer(WIRES, Kind::Number).is_none());
    }
}

fn nothing_at_first(t: &dyn Transport) {
    let page = t.attach();
    for wire in 0..WIRES {
        let reader = page.reader(wire, Kind::Map).unwrap();
        assert_eq!(reader.read(), None);
        assert_eq!(reader.newer_than(0), None);
        assert_eq!(reader.number(), Some(0));
    }
}

fn newest_wins(t: &dyn Transport) {
    let mut writer = t.owner().writer(3, Kind::Number).unwrap();
    let readers = [t.owner(), t.attach(), t.attach()].map(|p| p.reader(3, Kind::Number).unwrap());
    for (stamp, word) in [(7, 1.0), (8, -2.5), (9, 3e300)] {
        writer.write(Time(stamp), &all(word));
        for reader in &readers {
            for _ in 0..2 {
                let reading = reader.read().unwrap();
                assert_eq!(reading.words[0], word, "reading takes nothing away");
                assert_eq!(reading.stamp, Time(stamp));
            }
        }
    }
    writer.write(Time(1), &all(4.0));
    writer.write(Time(2), &all(5.0));
    for reader in &readers {
        assert_eq!(reader.read().unwrap().words[0], 5.0, "nothing is queued");
    }
}

fn number_counts(t: &dyn Transport) {
    let mut writer = t.owner().writer(0, Kind::Bit).unwrap();
    let reader = t.attach().reader(0, Kind::Bit).unwrap();
    for number in 1..=1000 {
        writer.write(Time(5), &all(1.0));
        assert_eq!(reader.number(), Some(number), "equal messages count as well");
        assert_eq!(reader.read().unwrap().number, number);
        assert_eq!(reader.newer_than(number - 1).unwrap().number, number);
        assert_eq!(reader.newer_than(number), None);
    }
}

fn one_writer(t: &dyn Transport) {
    let first = t.owner().writer(2, Kind::Number);
    assert!(first.is_some());
    assert!(t.owner().writer(2, Kind::Number).is_none());
    assert!(t.owner().writer(2, Kind::Map).is_none(), "of whatever kind");
    assert!(t.attach().writer(2, Kind::Number).is_none());
    drop(first);
    assert!(t.owner().writer(2, Kind::Number).is_none(), "nor afterwards");
    assert!(t.owner().writer(1, Kind::Number).is_some());
}

fn lengths(t: &dyn Transport) {
    let page = t.attach();
    for (wire, kind) in KINDS.into_iter().enumerate() {
        let mut writer = t.owner().writer(wire, kind).unwrap();
        let reader = page.reader(wire, kind).unwrap();
        assert_eq!((writer.kind(), reader.kind()), (kind, kind));
        writer.write(Time(9), &all(1.0));
        let reading = reader.read().unwrap();
        let used = kind.words();
        assert!(reading.words[..used].iter().all(|&w| w == 1.0), "{kind}");
        assert!(reading.words[used..].iter().all(|&w| w == 0.0), "{kind}");
        let whole = page.reader(wire, Kind::Map).unwrap().read().unwrap();
        assert!(
            whole.words[used..].iter().all(|&w| w == 0.0),
            "{kind}: what lies past a message is not written either"
        );
    }
}

fn bit_patterns(t: &dyn Transport) {
    let mut writer = t.owner().writer(0, Kind::Number).unwrap();
    let reader = t.attach().reader(0, Kind::Number).unwrap();
    for bits in [0, 1, 1 << 63, 0x7ff0 << 48, 0x7ff8_0000_dead_beef, u64::MAX] {
        writer.write(Time(u64::MAX), &all(f64::from_bits(bits)));
        let reading = reader.read().unwrap();
        assert_eq!(reading.words[0].to_bits(), bits);
        assert_eq!(reading.stamp, Time(u64::MAX));
    }
}

fn late_reader(t: &dyn Transport) {
    let mut writer = t.owner().writer(7, Kind::Pose).unwrap();
    for n in 1..=5 {
        writer.write(Time(n), &all(n as f64));
    }
    let reader = t.attach().reader(7, Kind::Pose).unwrap();
    let reading = reader.read().unwrap();
    assert_eq!(
        (reading.number, reading.stamp, reading.words[2]),
        (5, Time(5), 5.0)
    );
    writer.write(Time(6), &all(6.0));
    assert_eq!(reader.newer_than(5).unwrap().number, 6);
}

fn wires_apart(t: &dyn Transport) {
    let owner = t.owner();
    let mut writers = (0..WIRES)
        .map(|wire| owner.writer(wire, Kind::Map).unwrap())
        .collect::<Vec<_>>();
    for (wire, writer) in writers.iter_mut().enumerate() {
        writer.write(Time(wire as u64), &all(wire as f64));
    }
    let page = t.attach();
    for wire in 0..WIRES {
        let reading = page.reader(wire, Kind::Map).unwrap().read().unwrap();
        assert_eq!((reading.number, reading.words), (1, all(wire as f64)));
    }
}

fn ends_keep_the_page(t: &dyn Transport) {
    let page = t.attach();
    let reader = page.reader(4, Kind::Number).unwrap();
    let another = reader.clone();
    drop((page, reader));
    let mut writer = t.owner().writer(4, Kind::Number).unwrap();
    writer.write(Time(1), &all(8.0));
    assert_eq!(another.read().unwrap().words[0], 8.0);
}

/// Writes messages as fast as it can until told to stop: word and stamp are the message's number.
pub(crate) fn pour(writer: &mut Writer, stop: &AtomicBool) {
    let mut number = 0;
    // Relaxed: the flag guards nothing.
    while !stop.load(Ordering::Relaxed) {
        number += 1;
        writer.write(Time(number), &all(number as f64));
    }
}

/// Longest that a read beside a flood may take in the mean.
const MEAN_READ_MAX: Duration = Duration::from_micros(20);

/// Reads for a while beside [`pour`]: no reading is torn, none goes back, and every read comes to an end.
pub(crate) fn wade(reader: &Reader, length: Duration) {
    let begun = Instant::now();
    let (mut reads, mut whole, mut newest) = (0_u64, 0_u64, 0);
    while begun.elapsed() < length {
        for _ in 0..1000 {
            reads += 1;
            let Some(reading) = reader.read() else { continue };
            whole += 1;
            let number = reading.number;
            assert_eq!(reading.words, all(number as f64), "torn");
            assert_eq!(reading.stamp, Time(number), "torn");
            assert!(number >= newest, "went back from {newest} to {number}");
            newest = number;
        }
    }
    assert!(whole > 0, "none of {reads} reads came out whole");
    // A read is four tries of about 10 ns. This bound leaves room for a machine that does much else, and still
    // tells a read from one that waits for the writer to pause: this one never does.
    let mean = begun.elapsed() / u32::try_from(reads).unwrap();
    // An interpreter takes milliseconds for it.
    assert!(
        cfg!(miri) || mean < MEAN_READ_MAX,
        "a read took {mean:?} in the mean"
    );
}

fn flood(t: &dyn Transport) {
    let stop = AtomicBool::new(false);
    let mut writer = t.owner().writer(0, Kind::Map).unwrap();
    let readers = [t.attach(), t.attach()].map(|p| p.reader(0, Kind::Map).unwrap());
    std::thread::scope(|threads| {
        threads.spawn(|| pour(&mut writer, &stop));
        while readers[0].number() == Some(0) {
            std::thread::yield_now();
        }
        let waders = readers
            .each_ref()
            .map(|reader| threads.spawn(|| wade(reader, Duration::from_millis(500))));
        let ended = waders.map(|wader| wader.join());
        stop.store(true, Ordering::Relaxed);
        ended.into_iter().for_each(|ended| ended.unwrap());
    });
}
