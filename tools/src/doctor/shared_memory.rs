//! Shared memory: whether wires fit into it, and what dead instances left there.
//!
//! Must never remove anything: the next daemon of that name does.

use std::collections::HashSet;
use std::os::unix::net::UnixStream;

use rustix::fs::{StatVfsMountFlags, statvfs};

use super::{Bearing, Finding};

/// Room that a creature of the largest size and a few plugged layers need: 2 MiB of wires for each process that
/// writes, and iceoryx2's own segments.
const ROOM_MIN: u64 = 32 << 20;

/// Looks at shared memory.
pub(super) fn look() -> Vec<Finding> {
    vec![room(), leftovers(), sockets()]
}

fn room() -> Finding {
    let Ok(stat) = statvfs("/dev/shm") else {
        return Finding::new("/dev/shm", "missing", Bearing::Bad, "wires are shared there")
            .change("mount -t tmpfs -o mode=1777 tmpfs /dev/shm");
    };
    let (size, free) = (stat.f_blocks * stat.f_frsize, stat.f_bavail * stat.f_frsize);
    let found = format!("{} MiB free of {} MiB", free >> 20, size >> 20);
    if stat.f_flag.contains(StatVfsMountFlags::RDONLY) {
        return Finding::new(
            "/dev/shm",
            format!("{found}, read-only"),
            Bearing::Bad,
            "wires cannot be shared",
        )
        .change("mount -o remount,rw /dev/shm");
    }
    if free < ROOM_MIN {
        return Finding::new(
            "/dev/shm",
            found,
            Bearing::Bad,
            "wires may not fit; touching one that doesn't ends a process (SIGBUS)",
        )
        .change("mount -o remount,size=256M /dev/shm (containers: --shm-size=256m)");
    }
    Finding::new("/dev/shm", found, Bearing::Good, "")
}

/// Files of iceoryx2 that no living process maps or holds open.
fn leftovers() -> Finding {
    let files: Vec<String> = std::fs::read_dir("/dev/shm")
        .into_iter()
        .flatten()
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with("iox2_"))
        .collect();
    let used = in_use();
    let dead = files.iter().filter(|name| !used.contains(*name)).count();
    let found = format!("{} files, {dead} of nobody alive that we can see", files.len());
    match dead {
        0 => Finding::new("shared segments", found, Bearing::Good, ""),
        _ => Finding::new(
            "shared segments",
            found,
            Bearing::Note,
            "left by processes that were killed; the next start of a daemon or layer cleans up after them",
        ),
    }
}

/// Names of files in /dev/shm that processes map or hold open, as far as we may look.
fn in_use() -> HashSet<String> {
    let mut used = HashSet::new();
    for process in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
        let path = process.path();
        let maps = std::fs::read_to_string(path.join("maps")).unwrap_or_default();
        let mapped = maps
            .lines()
            .filter_map(|l| l.split_once("/dev/shm/"))
            .map(|(_, name)| name.to_string());
        used.extend(mapped);
        for open in std::fs::read_dir(path.join("fd")).into_iter().flatten().flatten() {
            if let Ok(target) = std::fs::read_link(open.path())
                && let Some(name) = target.to_string_lossy().strip_prefix("/dev/shm/")
            {
                used.insert(name.to_string());
            }
        }
    }
    used
}

/// Control sockets that nobody answers.
fn sockets() -> Finding {
    let folder = ipc::control::run_dir();
    let (mut alive, mut dead) = (0, 0);
    for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
        if entry.path().extension().is_some_and(|e| e == "sock") {
            match UnixStream::connect(entry.path()) {
                Ok(_) => alive += 1,
                Err(_) => dead += 1,
            }
        }
    }
    let found = format!(
        "{alive} daemons alive, {dead} sockets of dead ones ({})",
        folder.display()
    );
    match dead {
        0 => Finding::new("control sockets", found, Bearing::Good, ""),
        _ => Finding::new(
            "control sockets",
            found,
            Bearing::Note,
            "a daemon of that name takes its socket over when it starts",
        ),
    }
}
