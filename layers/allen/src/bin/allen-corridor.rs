//! Level 3 of Allen, corridor, as a process of its own.

fn main() -> std::process::ExitCode {
    afsm::process::run(allen::manifest("corridor.toml", allen::CORRIDOR), allen::kinds())
}
