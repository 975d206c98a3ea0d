//! Workers: this program started under another name, to be a load, a reader or a tapping layer.
//!
//! Must never be looked for elsewhere: what is measured and what loads it come out of one build.

use std::process::ExitCode;

use crate::{across, churn, load, neighbour};

/// Does a worker's work if this process was started as one.
pub fn dispatch() -> Option<ExitCode> {
    let mut arguments = std::env::args();
    let name = arguments.next()?;
    let rest: Vec<String> = arguments.collect();
    match name.as_str() {
        load::WORKER => Some(load::work(&rest)),
        churn::TAPPER => Some(churn::tap()),
        across::WORKER => Some(across::listen(&rest)),
        churn::READER => Some(churn::read(&rest)),
        neighbour::NEIGHBOUR => Some(neighbour::live(&rest)),
        _ => None,
    }
}
