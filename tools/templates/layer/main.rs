//! The layer @NAME@ of the creature @CREATURE@, as a process of its own.

mod @MODULE@;
#[cfg(test)]
mod scenarios;

fn main() -> std::process::ExitCode {
    let manifest = ipc::wiring::Source::new("@NAME@.toml", include_str!("../@NAME@.toml"));
    afsm::process::run(manifest, afsm::Kinds::default().with([&@MODULE@::KIND]))
}
