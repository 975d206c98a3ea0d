//! Level 4 of Allen, company, as a process of its own.

fn main() -> std::process::ExitCode {
    afsm::process::run(allen::manifest("company.toml", allen::COMPANY), allen::kinds())
}
