//! Watching a wire: straight from shared memory, without the daemon taking part.

use std::time::{Duration, Instant};

use daemon::status::value;
use ipc::control::{Reply, Request};
use ipc::wire::iceoryx::Domain;
use ipc::wiring::diagnostic::one_of;
use serde_json::json;

use crate::live::{call, short};

/// How often the wire is looked at: messages that come faster overwrite each other, as they do for modules.
const LOOK: Duration = Duration::from_millis(1);

pub(crate) fn watch(
    creature: &str,
    wire: &str,
    as_json: bool,
    count: Option<u64>,
    seconds: Option<f64>,
) -> Result<(), String> {
    let reply = call(creature)?
        .ask(&Request::Directory)
        .map_err(|e| format!("the daemon does not answer: {e}"))?;
    let Reply::Directory(directory) = reply else {
        return Err("the daemon answered something else".into());
    };
    let Some(listed) = directory.outputs.iter().find(|o| o.name == wire) else {
        let help = one_of("wire", wire, directory.outputs.iter().map(|o| o.name.as_str()));
        return Err(format!("there is no wire {wire:?}; {help}"));
    };
    let domain = Domain::join("subsumectl").map_err(|e| e.to_string())?;
    let page = domain.map(&listed.owner).map_err(|e| e.to_string())?;
    let reader = page
        .reader(listed.index, listed.kind)
        .ok_or("the wire is not in its owner's page")?;
    let began = Instant::now();
    let limit = seconds
        .map(Duration::try_from_secs_f64)
        .transpose()
        .map_err(|e| format!("--seconds: {e}"))?;
    let (mut seen, mut shown, mut missed) = (0, 0, 0);
    while limit.is_none_or(|limit| began.elapsed() < limit) && count.is_none_or(|count| shown < count) {
        if let Some(reading) = reader.newer_than(seen) {
            if shown > 0 {
                missed += reading.number - seen - 1;
            }
            seen = reading.number;
            shown += 1;
            let value = value(listed.kind, &reading.words);
            if as_json {
                let stamp = reading.stamp.seconds();
                println!(
                    "{}",
                    json!({"wire": wire, "number": reading.number, "stamp_s": stamp, "value": value})
                );
            } else {
                println!(
                    "{:12.6}  #{:<8} {}",
                    reading.stamp.seconds(),
                    reading.number,
                    short(&value)
                );
            }
        }
        std::thread::sleep(LOOK);
        if call(creature).is_err() && shown % 64 == 0 {
            return Err("the daemon is gone".into());
        }
    }
    if missed > 0 && !as_json {
        eprintln!("{missed} messages were overwritten before they could be shown");
    }
    Ok(())
}
