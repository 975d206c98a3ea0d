//! Every interleaving of a writer and a reader of one cell, under the memory model that loom explores.
//!
//! Must never grow beyond a few messages: what loom explores grows with every load and store.
//!
//! ```text
//! RUSTFLAGS="--cfg loom" cargo test -p ipc --test cell_loom --release
//! ```
#![cfg(loom)]

use ipc::clock::Time;
use ipc::message::{Kind, WORDS_MAX};
use ipc::wire::{Limits, Page, Reader, Reading, Register, Writer};
use loom::thread;

/// Most times that loom takes the processor away from a thread at any moment but the thread's own choice.
/// The faults of sequence locks need one or two (a write within a read, a read within a write).
const PREEMPTIONS_MAX: usize = 3;

fn explore(model: impl Fn() + Sync + Send + 'static) {
    let mut builder = loom::model::Builder::new();
    builder.preemption_bound = Some(PREEMPTIONS_MAX);
    builder.check(model);
}

fn wire(kind: Kind) -> (Writer, Reader) {
    let page = Page::in_memory(1);
    (page.writer(0, kind).unwrap(), page.reader(0, kind).unwrap())
}

/// Writes message number `n`, which says so in its stamp and every word.
fn write(writer: &mut Writer, n: u64) {
    writer.write(Time(n), &[n as f64; WORDS_MAX]);
}

/// Whether what was read is one message as it was written.
fn whole(reading: &Reading, kind: Kind) -> bool {
    let n = reading.number;
    reading.stamp == Time(n) && reading.words[..kind.words()].iter().all(|&w| w == n as f64)
}

#[test]
fn a_reading_is_never_torn() {
    explore(|| {
        let (mut writer, reader) = wire(Kind::Number);
        let reading = thread::spawn(move || reader.read());
        write(&mut writer, 1);
        write(&mut writer, 2);
        if let Some(reading) = reading.join().unwrap() {
            assert!(whole(&reading, Kind::Number), "{reading:?}");
        }
    });
}

#[test]
fn the_words_of_a_vector_belong_together() {
    explore(|| {
        let (mut writer, reader) = wire(Kind::Vector);
        write(&mut writer, 1);
        let reading = thread::spawn(move || reader.read());
        write(&mut writer, 2);
        if let Some(reading) = reading.join().unwrap() {
            assert!(whole(&reading, Kind::Vector), "{reading:?}");
        }
    });
}

#[test]
fn a_reader_never_goes_back() {
    explore(|| {
        let (mut writer, reader) = wire(Kind::Number);
        write(&mut writer, 1);
        let readings = thread::spawn(move || [reader.read(), reader.read()]);
        write(&mut writer, 2);
        if let [Some(first), Some(second)] = readings.join().unwrap() {
            assert!(first.number <= second.number, "{first:?} {second:?}");
            assert!(whole(&first, Kind::Number) && whole(&second, Kind::Number));
        }
    });
}

#[test]
fn what_was_seen_is_not_news() {
    explore(|| {
        let (mut writer, reader) = wire(Kind::Bit);
        write(&mut writer, 1);
        let news = thread::spawn(move || {
            let seen = reader.read().map_or(0, |r| r.number);
            (seen, reader.newer_than(seen))
        });
        write(&mut writer, 2);
        let (seen, news) = news.join().unwrap();
        assert!(news.is_none_or(|r| r.number > seen && whole(&r, Kind::Bit)));
    });
}

#[test]
fn a_writer_that_is_done_is_heard() {
    explore(|| {
        let (mut writer, reader) = wire(Kind::Number);
        let writing = thread::spawn(move || {
            write(&mut writer, 1);
            write(&mut writer, 2);
        });
        let _ = reader.read();
        writing.join().unwrap();
        let reading = reader.read().unwrap();
        assert_eq!((reading.number, reading.stamp), (2, Time(2)));
    });
}

#[test]
fn a_register_takes_in_whole_messages_each_once() {
    explore(|| {
        let (mut writer, reader) = wire(Kind::Number);
        let limits = Limits {
            kind: Kind::Number,
            low: 0.0,
            high: 9.0,
        };
        let mut register = Register::new(limits, Some(reader));
        let reading = thread::spawn(move || {
            let mut last = 0;
            for _ in 0..2 {
                register.gather(Time(9), |_| {});
                let seen = register.seen();
                assert_eq!(register.arrived(), seen > last, "news, and news only, arrives");
                if let Some((stamp, words)) = register.held() {
                    assert_eq!((stamp, words[0]), (Time(seen), seen as f64), "torn");
                }
                last = seen;
            }
        });
        write(&mut writer, 1);
        write(&mut writer, 2);
        reading.join().unwrap();
    });
}
