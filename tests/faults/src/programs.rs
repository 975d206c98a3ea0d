//! Programs: where the daemon, the body process and the layer process under trial lie.
//!
//! Must never try programs of another build than this one: they are built anew when cargo runs us.

use std::path::PathBuf;
use std::process::Command;

/// The programs under trial.
#[derive(Clone, Debug)]
pub(crate) struct Programs {
    /// The daemon.
    pub(crate) subsumed: PathBuf,
    /// A body in a process of its own.
    pub(crate) body: PathBuf,
    /// Level 1 of Allen.
    pub(crate) wander: PathBuf,
    /// This program, for the parts that only trials have.
    pub(crate) ourselves: PathBuf,
}

impl Programs {
    /// Those that lie beside this program.
    ///
    /// # Errors
    /// When one is missing, with what builds it.
    pub(crate) fn beside_us() -> Result<Programs, String> {
        let ourselves = std::env::current_exe().map_err(|e| format!("where this program lies: {e}"))?;
        let folder = ourselves.parent().ok_or("this program lies in no directory")?;
        let find = |name: &str| {
            let path = folder.join(name);
            match path.exists() {
                true => Ok(path),
                false => Err(format!(
                    "{} is missing; build it: cargo build{} --workspace --bins",
                    path.display(),
                    if cfg!(debug_assertions) { "" } else { " --release" },
                )),
            }
        };
        Ok(Programs {
            subsumed: find("subsumed")?,
            body: find("subsumed-body")?,
            // Where tests run us, the daemon's example of the same layer is built, and the layer's own package is not.
            wander: newest(["allen-wander", "examples/wander"].map(|name| folder.join(name)))
                .map_or_else(|| find("allen-wander"), Ok)?,
            ourselves,
        })
    }
}

/// The one of these files that was written last.
fn newest(paths: [PathBuf; 2]) -> Option<PathBuf> {
    let written = |path: &PathBuf| path.metadata().and_then(|m| m.modified()).ok();
    paths.into_iter().filter(|p| p.exists()).max_by_key(written)
}

/// Builds them where cargo runs us: `cargo run -p faults` alone builds only this program. Together with it, or cargo
/// would choose other features of what they share, and build all of that again.
///
/// # Errors
/// When they do not build.
pub(crate) fn build() -> Result<(), String> {
    let Some(cargo) = std::env::var_os("CARGO") else {
        return Ok(());
    };
    let mut command = Command::new(cargo);
    // All of it: with some packages alone cargo would build their dependencies once more, for fewer features.
    command.args(["build", "--quiet", "--workspace", "--bins"]);
    command.arg("--manifest-path");
    command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../../Cargo.toml"));
    if !cfg!(debug_assertions) {
        command.arg("--release");
    }
    let status = command.status().map_err(|e| format!("cargo: {e}"))?;
    match status.success() {
        true => Ok(()),
        false => Err(format!("the programs under trial do not build: {status}")),
    }
}
