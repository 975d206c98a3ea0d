//! The contract of wires, kept by every transport: plain memory and iceoryx2.
//!
//! Must never share a domain with anything else that runs on this host: each case is a process of its own
//! in a domain of its own, and has to leave nothing behind there. Hence no test harness: without arguments
//! this program starts itself once for each case.
//!
//! - [`suite`]: what a page and its two ends do, on either transport
//! - [`processes`]: what processes do to each other, owners and readers killed included

mod processes;
mod suite;
mod transport;

use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

/// Longest that a case may run; the slowest takes a few seconds.
const CASE_MAX: Duration = Duration::from_secs(120);

type Case = (String, Box<dyn Fn()>);

fn cases() -> Vec<Case> {
    let mut cases = Vec::<Case>::new();
    for &(name, case) in suite::SUITE {
        cases.push((
            format!("memory::{name}"),
            Box::new(move || case(&transport::Memory::new())),
        ));
        cases.push((
            format!("iceoryx2::{name}"),
            Box::new(move || case(&transport::Shared::new())),
        ));
    }
    for &(name, case) in processes::CASES {
        cases.push((format!("processes::{name}"), Box::new(case)));
    }
    cases
}

fn main() -> ExitCode {
    let arguments = std::env::args().skip(1).collect::<Vec<_>>();
    match arguments
        .iter()
        .map(String::as_str)
        .collect::<Vec<_>>()
        .as_slice()
    {
        ["--case", name] => {
            let cases = cases();
            let (_, case) = cases.iter().find(|c| c.0 == *name).expect("a case of that name");
            case();
            ExitCode::SUCCESS
        }
        ["--role", role, owner] => {
            processes::play(role, owner);
            ExitCode::SUCCESS
        }
        arguments => run(arguments),
    }
}

/// Runs the cases that the arguments select, in the way of `cargo test`.
fn run(arguments: &[&str]) -> ExitCode {
    let (flags, filters): (Vec<_>, Vec<_>) = arguments.iter().partition(|a| a.starts_with('-'));
    let chosen = cases()
        .into_iter()
        .map(|(name, _)| name)
        .filter(|name| filters.is_empty() || filters.iter().any(|f| name.contains(*f)))
        .filter(|_| !flags.contains(&"--ignored"))
        .collect::<Vec<_>>();
    if flags.contains(&"--list") {
        chosen.iter().for_each(|name| println!("{name}: test"));
        return ExitCode::SUCCESS;
    }
    println!("\nrunning {} tests", chosen.len());
    let mut failed = 0;
    for (number, name) in chosen.iter().enumerate() {
        let begun = Instant::now();
        let result = run_case(name, &format!("contract-{}-{number}", std::process::id()));
        let took = begun.elapsed().as_secs_f64();
        match result {
            Ok(()) => println!("test {name} ... ok ({took:.2} s)"),
            Err(why) => {
                println!("test {name} ... FAILED ({took:.2} s): {why}");
                failed += 1;
            }
        }
    }
    let passed = chosen.len() - failed;
    println!("\ntest result: {passed} passed; {failed} failed\n");
    if failed == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(101)
    }
}

/// Runs one case as a process in `domain`, and looks at what it leaves behind.
fn run_case(name: &str, domain: &str) -> Result<(), String> {
    let mut case = Command::new(std::env::current_exe().expect("this program has a path"))
        .args(["--case", name])
        .env("SUBSUMED_DOMAIN", domain)
        .spawn()
        .expect("this program starts again");
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = case.try_wait().expect("the case is our child") {
            break status;
        }
        if begun.elapsed() > CASE_MAX {
            let _ = case.kill();
            let _ = case.wait();
            let _ = sweep(domain);
            return Err(format!("still running after {CASE_MAX:?}"));
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let left = sweep(domain);
    if !status.success() {
        return Err(format!("{status}"));
    }
    if !left.is_empty() {
        return Err(format!("left behind: {left:?}"));
    }
    Ok(())
}

/// Removes what is left of a domain; says which files there were, save the one that iceoryx2 keeps for good:
/// the counter that its node numbers come from, a page of memory for each domain and version. It cannot be
/// removed while another process may be joining.
fn sweep(domain: &str) -> Vec<PathBuf> {
    let root = PathBuf::from(format!("/tmp/iceoryx2-{domain}"));
    let mut left = files_below(&root);
    let shared = std::fs::read_dir("/dev/shm").into_iter().flatten().flatten();
    let prefix = format!("iox2_{domain}_");
    for entry in shared {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = std::fs::remove_file(entry.path());
            if !entry.file_name().to_string_lossy().ends_with(".global_mgmt") {
                left.push(entry.path());
            }
        }
    }
    let _ = std::fs::remove_dir_all(&root);
    left
}

fn files_below(folder: &std::path::Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files.extend(files_below(&path));
        } else {
            files.push(path);
        }
    }
    files
}
