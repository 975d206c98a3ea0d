//! The means themselves: both ends of wires, of a bare blackboard and of a bare sequence lock.
//!
//! Must never favour one: each carries a stamp and one number, and each is polled by its cheapest question.

use iceoryx2::port::reader::EntryHandle;
use iceoryx2::port::writer::EntryHandleMut;
use iceoryx2::service::ipc_threadsafe::Service;
use ipc::clock::{self, Time};
use ipc::message::{Kind, WORDS_MAX};
use ipc::wire::iceoryx::{Domain, OwnedPage};
use ipc::wire::{Reader, Writer};

use super::Means;
use super::seqlock::{SeqlockReader, SeqlockWriter};

/// The key of the blackboard's one entry.
const KEY: u64 = 0;

/// A stamp, nanoseconds, and a number.
type Stamped = [u64; 2];

/// What must live while the speaker speaks.
pub(super) struct Stage {
    page: OwnedPage,
    seqlock: String,
}

/// The writing ends.
pub(super) struct Speakers {
    wires: [Writer; 2],
    board: EntryHandleMut<Service, u64, Stamped>,
    seqlock: SeqlockWriter,
}

/// The reading ends.
pub(super) struct Ears {
    wires: [Reader; 2],
    board: EntryHandle<Service, u64, Stamped>,
    seqlock: SeqlockReader,
}

fn service(name: &str) -> Result<iceoryx2::prelude::ServiceName, String> {
    format!("subsumed/lab/{name}/board")
        .as_str()
        .try_into()
        .map_err(|e| format!("{e:?}"))
}

impl Stage {
    /// Everything in place; the writing ends go to the thread that speaks.
    pub(super) fn set(domain: &Domain, name: &str) -> Result<(Stage, Speakers), String> {
        let page = domain.own(name, 2).map_err(|e| e.to_string())?;
        let wire = |index| {
            page.page()
                .writer(index, Kind::Number)
                .ok_or("a wire has one writer")
        };
        let wires = [wire(0)?, wire(1)?];
        let board = domain
            .node()
            .service_builder(&service(name)?)
            .blackboard_creator::<u64>()
            .add::<Stamped>(KEY, [0, 0])
            .create()
            .map_err(|e| format!("the blackboard: {e:?}"))?;
        let writer = board.writer_builder().create().map_err(|e| format!("{e:?}"))?;
        let board = writer.entry::<Stamped>(&KEY).map_err(|e| format!("{e:?}"))?;
        let (seqlock, path) = SeqlockWriter::create().map_err(|e| format!("the sequence lock: {e}"))?;
        let stage = Stage { page, seqlock: path };
        Ok((
            stage,
            Speakers {
                wires,
                board,
                seqlock,
            },
        ))
    }

    /// Gives the wires to whoever asked for them.
    pub(super) fn serve(&self) {
        self.page.serve();
    }

    /// Where another process finds the sequence lock.
    pub(super) fn seqlock_path(&self) -> String {
        self.seqlock.clone()
    }
}

impl Speakers {
    /// Writes message `number`, stamped as late as can be.
    pub(super) fn speak(&mut self, means: Means, number: u64) {
        let mut words = [0.0; WORDS_MAX];
        words[0] = number as f64;
        let stamp = clock::monotonic();
        match means {
            Means::Wire => self.wires[0].write(stamp, &words),
            Means::WireAgain => self.wires[1].write(stamp, &words),
            Means::Blackboard => self.board.update_with_copy([stamp.0, number]),
            Means::Seqlock => self.seqlock.write([stamp.0, number]),
        }
    }
}

impl Ears {
    /// The reading ends of what the process called `name` speaks by.
    pub(super) fn open(domain: &Domain, name: &str, seqlock: &str) -> Result<Ears, String> {
        let page = domain.map(name).map_err(|e| e.to_string())?;
        let wire = |index| page.reader(index, Kind::Number).ok_or("the page has two wires");
        let board = domain
            .node()
            .service_builder(&service(name)?)
            .blackboard_opener::<u64>()
            .open()
            .map_err(|e| format!("the blackboard: {e:?}"))?;
        let reader = board.reader_builder().create().map_err(|e| format!("{e:?}"))?;
        Ok(Ears {
            wires: [wire(0)?, wire(1)?],
            board: reader.entry::<Stamped>(&KEY).map_err(|e| format!("{e:?}"))?,
            seqlock: SeqlockReader::open(seqlock).map_err(|e| format!("{seqlock}: {e}"))?,
        })
    }

    /// Polls until a message comes that is none of `seen`, or `over`: its number and stamp.
    pub(super) fn await_newer(
        &self,
        means: Means,
        seen: u64,
        over: impl Fn() -> bool,
    ) -> Option<(u64, Time)> {
        match means {
            Means::Wire => self.await_wire(0, seen, over),
            Means::WireAgain => self.await_wire(1, seen, over),
            Means::Blackboard => {
                let mut value = self.board.get();
                while value[1] <= seen {
                    while self.board.is_up_to_date(&value) {
                        if over() {
                            return None;
                        }
                    }
                    value = self.board.get();
                }
                Some((value[1], Time(value[0])))
            }
            Means::Seqlock => loop {
                if let Some([stamp, number]) = self.seqlock.read()
                    && number > seen
                {
                    return Some((number, Time(stamp)));
                }
                while !self.seqlock.changed() {
                    if over() {
                        return None;
                    }
                }
            },
        }
    }

    fn await_wire(&self, wire: usize, seen: u64, over: impl Fn() -> bool) -> Option<(u64, Time)> {
        let wire = &self.wires[wire];
        let mut known = 0;
        loop {
            if let Some(reading) = wire.newer_than(known) {
                known = reading.number;
                if reading.words[0] as u64 > seen {
                    return Some((reading.words[0] as u64, reading.stamp));
                }
            }
            if over() {
                return None;
            }
        }
    }
}
