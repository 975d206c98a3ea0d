//! Level 2 of Allen, explore, as a process of its own.

fn main() -> std::process::ExitCode {
    afsm::process::run(allen::explore_manifest(), allen::kinds())
}
