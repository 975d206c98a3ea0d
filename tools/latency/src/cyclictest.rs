//! Cyclictest, the reference: started beside us, its samples read from what it prints.
//!
//! Must never be trusted to end by itself: it is told a number of loops, and killed when it is dropped.
//!
//! It runs with `--laptop`: else it forbids the processor's idle states, which changes what we measure of
//! ourselves in the same moment.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;

use ipc::clock::Span;

/// How it is run.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The processor of its thread.
    pub cpu: usize,
    /// Where its main thread, which prints, runs.
    pub main_cpu: usize,
    /// Its SCHED_FIFO priority.
    pub priority: u8,
    /// Time between two wake-ups.
    pub period: Span,
    /// Where the wake-ups lie within a full second.
    pub phase: Span,
    /// How many.
    pub loops: u64,
}

/// A cyclictest that runs.
pub struct Cyclictest {
    child: Child,
    reader: Option<JoinHandle<Vec<u64>>>,
}

/// Whether it is installed.
pub fn available() -> bool {
    let mut asked = Command::new("cyclictest");
    asked.arg("--help").stdout(Stdio::null()).stderr(Stdio::null());
    asked.status().is_ok()
}

impl Cyclictest {
    /// Starts it.
    ///
    /// # Errors
    /// When it cannot be started.
    pub fn start(setting: &Setting) -> std::io::Result<Cyclictest> {
        let us = |span: Span| (span.0 / 1_000).to_string();
        let mut child = Command::new("cyclictest")
            .args([
                "--laptop",
                "--mlockall",
                "--nsecs",
                "--verbose",
                "--quiet",
                "--threads=1",
                "--policy=fifo",
            ])
            .arg(format!("--affinity={}", setting.cpu))
            .arg(format!("--mainaffinity={}", setting.main_cpu))
            .arg(format!("--priority={}", setting.priority))
            .arg(format!("--interval={}", us(setting.period)))
            .arg(format!("--secaligned={}", us(setting.phase)))
            .arg(format!("--loops={}", setting.loops))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let out = child.stdout.take().expect("piped");
        let reader = std::thread::spawn(move || {
            let lines = BufReader::new(out).lines().map_while(Result::ok);
            lines.filter_map(|line| sample(&line)).collect()
        });
        Ok(Cyclictest {
            child,
            reader: Some(reader),
        })
    }

    /// Whether it has ended.
    pub fn ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }

    /// Stops it if it still runs; its latencies in nanoseconds, in order.
    pub fn finish(mut self) -> Vec<u64> {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let reader = self.reader.take().expect("finished once");
        reader.join().unwrap_or_default()
    }
}

impl Drop for Cyclictest {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A line `thread: count: value`.
fn sample(line: &str) -> Option<u64> {
    let mut parts = line.split(':').map(str::trim);
    let (_thread, _count, value) = (
        parts.next()?.parse::<u32>().ok()?,
        parts.next()?.parse::<u64>().ok()?,
        parts.next()?.parse::<i64>().ok()?,
    );
    parts.next().is_none().then(|| value.max(0) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_told_from_the_rest() {
        assert_eq!(sample("       0:      17:   23951"), Some(23_951));
        assert_eq!(sample("       0:       1:     -51"), Some(0));
        for other in [
            "Max CPUs = 2",
            "Thread 0 Interval: 1500",
            "T: 0 (22950) P:80 I:1000 C: 20 Min: 1",
            "",
        ] {
            assert_eq!(sample(other), None, "{other}");
        }
    }
}
