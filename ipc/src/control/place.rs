//! Where control sockets lie.
//!
//! Must never make a folder or a socket: whoever listens does.

use std::path::PathBuf;

/// The directory of control sockets: `SUBSUMED_RUN`, else `$XDG_RUNTIME_DIR/subsumed`, else
/// `/run/subsumed` if there is one, else one of the user's own below `/tmp`.
pub fn run_dir() -> PathBuf {
    if let Some(dir) = std::env::var_os("SUBSUMED_RUN") {
        return dir.into();
    }
    if let Some(dir) = std::env::var_os("XDG_RUNTIME_DIR") {
        return PathBuf::from(dir).join("subsumed");
    }
    let system = PathBuf::from("/run/subsumed");
    if system.is_dir() {
        return system;
    }
    PathBuf::from(format!("/tmp/subsumed-{}", rustix::process::getuid().as_raw()))
}

/// The control socket of the daemon that runs `creature`.
pub fn socket_path(creature: &str) -> PathBuf {
    socket_in_run_dir(creature, "sock")
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
