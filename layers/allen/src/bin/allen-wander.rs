//! Level 1 of Allen, wander, as a process of its own.

fn main() -> std::process::ExitCode {
    afsm::process::run(allen::wander_manifest(), allen::kinds())
}
