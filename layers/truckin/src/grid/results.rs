//! Reads a results file and checks every block of it.

use std::path::Path;

use super::block::{BLOCK_END, COLUMNS, Row};
use super::fault::GridFault;

/// What a results file holds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Results {
    /// Its first line; empty when the file ends before the end of that line.
    pub settings: String,
    /// Rows of all whole blocks.
    pub rows: Vec<Row>,
    /// How many whole blocks.
    pub blocks: usize,
    /// Bytes after the last whole block: what a run had written of the next one when it was stopped.
    pub tail: Vec<u8>,
    /// Line of the first byte of the tail, counted from 1.
    pub tail_line: usize,
}

/// Reads a results file.
///
/// A block without its last line may only stand at the end; it is handed back as the tail. Anything
/// else that is not as it was written is damage.
///
/// # Errors
/// The file cannot be read, or the place of the first damage.
pub fn read_results(path: &Path) -> Result<Results, GridFault> {
    let bytes = std::fs::read(path).map_err(|error| GridFault::io(path, "reading", error))?;
    parse(path, &bytes)
}

pub(crate) fn parse(path: &Path, bytes: &[u8]) -> Result<Results, GridFault> {
    let mut results = Results {
        tail_line: 1,
        ..Results::default()
    };
    let mut whole = 0;
    let mut begun = 0;
    let mut rows = Vec::new();
    let mut at = 0;
    for (number, line) in bytes.split_inclusive(|byte| *byte == b'\n').enumerate() {
        let number = number + 1;
        at += line.len();
        let Some(line) = line.strip_suffix(b"\n") else {
            break;
        };
        let line = std::str::from_utf8(line).map_err(|_| GridFault::bad(path, number, "not text"))?;
        match number {
            1 if !line.starts_with("#truckin-grid ") => {
                return Err(GridFault::bad(
                    path,
                    number,
                    "expected a line beginning #truckin-grid",
                ));
            }
            1 => results.settings = line.to_owned(),
            2 if line != COLUMNS => {
                return Err(GridFault::bad(
                    path,
                    number,
                    format!("expected the columns {COLUMNS}"),
                ));
            }
            2 => begun = at,
            _ => match line.strip_prefix(BLOCK_END) {
                Some(end) => {
                    let text = &bytes[begun..at - line.len() - 1];
                    check_block(end, results.blocks, text)
                        .map_err(|what| GridFault::bad(path, number, what))?;
                    results.rows.append(&mut rows);
                    results.blocks += 1;
                    begun = at;
                }
                None => rows.push(Row::parse(line).map_err(|what| GridFault::bad(path, number, what))?),
            },
        }
        if begun == at {
            whole = at;
            results.tail_line = number + 1;
        }
    }
    if whole == 0 {
        // Killed within the first two lines: all of it is tail.
        results.settings.clear();
    }
    results.tail = bytes[whole..].to_vec();
    Ok(results)
}

fn check_block(end: &str, index: usize, text: &[u8]) -> Result<(), String> {
    let checksum = crc32fast::hash(text);
    let expected = format!("{index} crc32={checksum:08x}");
    if end == expected {
        Ok(())
    } else {
        Err(format!(
            "damaged block: its last line says \"{end}\", its rows say \"{expected}\""
        ))
    }
}
