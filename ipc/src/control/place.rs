//! Where control sockets lie.
//!
//! Must never make a folder or a socket: whoever listens does.

use std::path::{Path, PathBuf};

/// Where the daemons of the whole host have theirs: the unit's RuntimeDirectory=.
const SYSTEM: &str = "/run/subsumed";

/// The directory of control sockets: `SUBSUMED_RUN`, else `$XDG_RUNTIME_DIR/subsumed`, else
/// `/run/subsumed` if this user may write there, else one of the user's own below `/tmp`.
pub fn run_dir() -> PathBuf {
    if let Some(dir) = std::env::var_os("SUBSUMED_RUN") {
        return dir.into();
    }
    if let Some(dir) = std::env::var_os("XDG_RUNTIME_DIR") {
        return PathBuf::from(dir).join("subsumed");
    }
    if rustix::fs::access(SYSTEM, rustix::fs::Access::WRITE_OK).is_ok() {
        return SYSTEM.into();
    }
    PathBuf::from(format!("/tmp/subsumed-{}", rustix::process::getuid().as_raw()))
}

/// The control socket of the daemon that runs `creature`.
pub fn socket_path(creature: &str) -> PathBuf {
    socket_in_run_dir(creature, "sock")
}

/// Where a caller looks for daemons: in the directory of this user, and in that of the host unless `SUBSUMED_RUN`
/// chose one. So a login session reaches the daemons that systemd runs.
pub(super) fn run_dirs() -> Vec<PathBuf> {
    let mut dirs = vec![run_dir()];
    if std::env::var_os("SUBSUMED_RUN").is_none() && dirs[0] != Path::new(SYSTEM) {
        dirs.push(SYSTEM.into());
    }
    dirs
}

/// The control socket at which `creature` is called: the first there is.
pub(super) fn called(creature: &str) -> PathBuf {
    let own = socket_path(creature);
    let name = own.file_name().unwrap_or_default();
    let there = run_dirs()
        .iter()
        .map(|dir| dir.join(name))
        .find(|path| path.exists());
    there.unwrap_or(own)
}

/// A socket of this shared-memory domain, `name.suffix`.
pub(crate) fn socket_in_run_dir(name: &str, suffix: &str) -> PathBuf {
    run_dir().join(format!("{}{name}.{suffix}", domain_prefix()))
}

pub(super) fn domain_prefix() -> String {
    std::env::var("SUBSUMED_DOMAIN")
        .map(|d| format!("{d}."))
        .unwrap_or_default()
}
