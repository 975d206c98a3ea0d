//! Level 5 of Allen, home, as a process of its own.

fn main() -> std::process::ExitCode {
    afsm::process::run(allen::manifest("home.toml", allen::HOME), allen::kinds())
}
