//! A layer process in five lines: level 1 of Allen, wander, as tests of the daemon start it.

fn main() -> std::process::ExitCode {
    afsm::process::run(allen::wander_manifest(), allen::kinds())
}
