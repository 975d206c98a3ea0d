//! The interval log: HdrHistogram's own format (V2, compressed), one line for each interval and track.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::time::SystemTime;

use hdrhistogram::serialization::V2DeflateSerializer;
use hdrhistogram::serialization::interval_log::{IntervalLogWriterBuilder, Tag};

use crate::track::Track;

/// Writes `tracks`, tagged with their names, values in nanoseconds, maxima shown in milliseconds.
///
/// # Errors
/// When the file cannot be written.
pub fn write(path: &Path, began: SystemTime, tracks: &[Track]) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    let mut serializer = V2DeflateSerializer::new();
    let mut log = IntervalLogWriterBuilder::new()
        .add_comment("[values in nanoseconds; interval maxima in milliseconds]")
        .with_start_time(began)
        .with_max_value_divisor(1e6)
        .begin_log_with(&mut file, &mut serializer)?;
    let mut lines: Vec<(&Track, &crate::track::Interval)> = tracks
        .iter()
        .flat_map(|t| t.intervals.iter().map(move |i| (t, i)))
        .collect();
    lines.sort_by_key(|(_, interval)| interval.began);
    for (track, interval) in lines {
        let name: String = track.name().replace([',', ' '], "_");
        let tag = Tag::new(&name);
        log.write_histogram(&interval.histogram, interval.began, interval.length, tag)
            .map_err(|e| io::Error::other(format!("{e:?}")))?;
    }
    file.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::histogram;
    use hdrhistogram::serialization::Deserializer;
    use hdrhistogram::serialization::interval_log::{IntervalLogIterator, LogEntry};
    use std::time::Duration;

    #[test]
    fn what_was_written_is_read_again() {
        let mut track = Track::new("avoid", "wake-up");
        for k in 1..=3_u64 {
            let mut h = histogram();
            (0..100 * k).for_each(|n| h.saturating_record(1_000 * (n + 1)));
            track.add(Duration::from_secs(k), Duration::from_secs(1), h);
        }
        let path = std::env::temp_dir().join(format!("lab-log-{}.hlog", std::process::id()));
        write(&path, SystemTime::UNIX_EPOCH, std::slice::from_ref(&track)).unwrap();
        let text = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let mut read = Vec::new();
        for entry in IntervalLogIterator::new(&text) {
            if let LogEntry::Interval(line) = entry.unwrap() {
                assert_eq!(line.tag().unwrap().as_str(), "avoid.wake-up");
                read.push(line.encoded_histogram().to_string());
            }
        }
        assert_eq!(read.len(), 3);
        let bytes = base64(&read[2]);
        let last: hdrhistogram::Histogram<u64> = Deserializer::new().deserialize(&mut &bytes[..]).unwrap();
        assert_eq!(last.len(), 300);
        assert_eq!(
            last.value_at_quantile(0.5),
            track.intervals[2].histogram.value_at_quantile(0.5)
        );
    }

    /// Standard base64.
    fn base64(text: &str) -> Vec<u8> {
        let value = |c: u8| match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            _ => 63,
        };
        let digits: Vec<u32> = text
            .bytes()
            .filter(|c| *c != b'=')
            .map(|c| u32::from(value(c)))
            .collect();
        let mut bytes = Vec::new();
        for four in digits.chunks(4) {
            let word = four.iter().fold(0, |w, d| w << 6 | d) << (6 * (4 - four.len()));
            bytes.extend_from_slice(&[(word >> 16) as u8, (word >> 8) as u8, word as u8][..four.len() - 1]);
        }
        bytes
    }
}
