//! Files that a creature file names: read and checked with it, their faults told at their own places.
//!
//! Must never read more than a parameter takes, nor anything for a text that came without a folder.

use std::io::Read;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use super::Checker;
use crate::wiring::catalog::{Attached, Fault, Parameter, Takes};
use crate::wiring::diagnostic::{Files, Source};
use crate::wiring::document::{self as doc, Keys};
use crate::wiring::rule::Rule;

/// Why a file cannot be had.
enum Refused {
    Unreadable(String),
    TooLong(u64),
}

impl Checker<'_> {
    /// The file that `parameter` names in `keys`, if it names one and that is sound.
    pub(super) fn attached(
        &mut self,
        keys: &mut Keys<'_, '_>,
        parameter: &'static Parameter,
    ) -> Option<Attached> {
        let Takes::File {
            bytes_max,
            check,
            instead_of,
        } = parameter.takes
        else {
            return None;
        };
        let value = keys.take(parameter.name)?;
        for other in instead_of.iter().filter_map(|name| Some((name, keys.get(name)?))) {
            let message = format!("{:?} is given beside {:?}", parameter.name, other.0);
            let help = format!("expected one of the two: leave out {:?} to use the file", other.0);
            let also = (other.1.span(), "and here".into());
            self.findings
                .refuse_both(Rule::ExclusiveKeys, value.span(), message, help, also);
        }
        let named = doc::text(value, "the path of a file", &mut self.findings)?;
        let folder = match self.files {
            Files::In(folder) => folder,
            Files::Unread => {
                return Some(Attached {
                    path: named.value.into(),
                    text: String::new(),
                });
            }
            Files::Nowhere => {
                let message = format!("{:?} cannot be looked for", named.value);
                let help = "a text that is not a file itself has no folder to find other files from";
                self.findings.refuse(Rule::MissingFile, named.at, message, help);
                return None;
            }
        };
        let path = folder.join(&named.value);
        let bytes = match read(&path, bytes_max) {
            Ok(bytes) => bytes,
            Err(refused) => {
                self.refuse_file(&path, refused, bytes_max, named.at);
                return None;
            }
        };
        let name = path.display().to_string();
        let (source, faults) = match Source::from_bytes(name, bytes) {
            Ok(source) => {
                let faults = check(&source.text).into_iter();
                (source, faults.map(|fault| (Rule::BadFile, fault)).collect())
            }
            Err(rejected) => {
                let not_text = rejected.diagnostics.into_iter().map(|d| {
                    let fault = Fault {
                        at: d.at,
                        message: d.message,
                        help: d.help,
                    };
                    (Rule::NotText, fault)
                });
                (rejected.source, not_text.collect::<Vec<_>>())
            }
        };
        let source = Arc::new(source);
        let sound = faults.is_empty();
        for (rule, fault) in faults {
            self.findings
                .refuse_within(rule, &source, fault, named.at.clone());
        }
        let text = source.text.clone();
        sound.then_some(Attached { path, text })
    }

    fn refuse_file(&mut self, path: &Path, refused: Refused, bytes_max: usize, at: Range<usize>) {
        let file = path.display();
        let (rule, message, help) = match refused {
            Refused::Unreadable(why) => (
                Rule::MissingFile,
                format!("{file}: {why}"),
                "expected the path of a text file, from the folder of this file".into(),
            ),
            Refused::TooLong(bytes) => (
                Rule::FileTooLong,
                format!("{file} has {bytes} bytes"),
                format!("expected at most {bytes_max} bytes"),
            ),
        };
        self.findings.refuse(rule, at, message, help);
    }
}

/// The bytes of the file at `path`, at most `bytes_max`.
fn read(path: &Path, bytes_max: usize) -> Result<Vec<u8>, Refused> {
    let unreadable = |e: std::io::Error| Refused::Unreadable(format!("cannot be read: {e}"));
    // Asked before it is opened: to open a pipe would wait for whoever writes to it.
    let found = std::fs::metadata(path).map_err(unreadable)?;
    if !found.is_file() {
        return Err(Refused::Unreadable("is not a file".into()));
    }
    let long = |bytes: u64| bytes > bytes_max as u64;
    if long(found.len()) {
        return Err(Refused::TooLong(found.len()));
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(unreadable)?;
    file.take(bytes_max as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if long(bytes.len() as u64) {
        return Err(Refused::TooLong(bytes.len() as u64));
    }
    Ok(bytes)
}
