//! Plants: faults put into a step on purpose, to see that the gate sees them.
//!
//! Must never be part of a measurement that is believed: a run with a plant says so in every report.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use clap::ValueEnum;
use ipc::clock::{self, Span};

/// What is planted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Plant {
    /// A heap allocation in every hundredth step.
    Allocation,
    /// A lock in every step, which an ordinary thread also takes.
    Lock,
    /// 200 µs of work in every step.
    Delay,
}

/// How long the delay is.
const DELAY: Span = Span::micros(200);

/// A planted fault.
pub struct Planted {
    what: Option<Plant>,
    steps: u64,
    lock: Arc<Mutex<u64>>,
    stop: Arc<AtomicBool>,
    rival: Option<JoinHandle<()>>,
}

impl Planted {
    /// Plants `what`, or nothing.
    pub fn new(what: Option<Plant>) -> Planted {
        let (lock, stop) = (Arc::new(Mutex::new(0)), Arc::new(AtomicBool::new(false)));
        let rival = (what == Some(Plant::Lock)).then(|| {
            let (lock, stop) = (lock.clone(), stop.clone());
            std::thread::spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    *lock.lock().expect("nobody panics holding it") += 1;
                    let held = lock.lock().expect("nobody panics holding it");
                    std::thread::sleep(Duration::from_micros(1500));
                    drop(held);
                    std::thread::sleep(Duration::from_micros(500));
                }
            })
        });
        Planted {
            what,
            steps: 0,
            lock,
            stop,
            rival,
        }
    }

    /// Does what was planted.
    pub fn step(&mut self) {
        self.steps += 1;
        match self.what {
            None => {}
            Some(Plant::Allocation) if self.steps.is_multiple_of(100) => {
                std::hint::black_box(Box::new(self.steps));
            }
            Some(Plant::Allocation) => {}
            Some(Plant::Lock) => *self.lock.lock().expect("nobody panics holding it") += 1,
            Some(Plant::Delay) => {
                let until = clock::monotonic() + DELAY;
                while clock::monotonic() < until {
                    std::hint::spin_loop();
                }
            }
        }
    }
}

impl Drop for Planted {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(rival) = self.rival.take() {
            let _ = rival.join();
        }
    }
}
