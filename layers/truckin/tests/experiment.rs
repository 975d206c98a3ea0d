//! The grid: the same bytes on any number of threads, after a kill, and never over a damaged file.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

fn truckin(args: &[&str], out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_truckin"));
    command
        .args(args)
        .arg("--out")
        .arg(out)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn run(args: &[&str], out: &Path) -> Output {
    truckin(args, out).output().expect("the command starts")
}

const SMALL: [&str; 7] = ["grid", "--games", "35", "--trucks", "1,3", "--slots", "50,120"];

/// A finished small grid.
fn small(place: &TempDir, threads: &str) -> PathBuf {
    let out = place.path().join(format!("t{threads}.csv"));
    let done = run(&[&SMALL[..], &["--threads", threads, "--check"]].concat(), &out);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    out
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let place = TempDir::new().expect("a folder");
    let one = std::fs::read(small(&place, "1")).expect("results");
    for threads in ["2", "5"] {
        assert_eq!(std::fs::read(small(&place, threads)).expect("results"), one);
    }
    let rows = one
        .split(|byte| *byte == b'\n')
        .filter(|line| line.first().is_some_and(u8::is_ascii_digit));
    assert_eq!(rows.count(), 35 * 2 * (1 + 3));
    let report = std::fs::read_to_string(place.path().join("t1.html")).expect("a report");
    assert!(report.contains("<svg") && !report.contains("http") && !report.contains("src="));
}

#[test]
fn a_run_that_was_killed_goes_on_where_it_was() {
    let place = TempDir::new().expect("a folder");
    let args = [
        "grid",
        "--games",
        "60",
        "--trucks",
        "2,8",
        "--slots",
        "400,900",
        "--threads",
        "2",
    ];
    let whole = place.path().join("whole.csv");
    assert!(run(&args, &whole).status.success());
    let whole = std::fs::read(whole).expect("results");
    let out = place.path().join("killed.csv");
    let mut kills = 0;
    for enough in [1, whole.len() / 3, whole.len() / 2] {
        let mut child = truckin(&args, &out).spawn().expect("the command starts");
        let late = Instant::now() + Duration::from_secs(60);
        while std::fs::metadata(&out).map_or(0, |file| file.len()) < enough as u64 && Instant::now() < late {
            std::thread::sleep(Duration::from_micros(200));
        }
        child.kill().expect("SIGKILL");
        kills += u32::from(!child.wait().expect("its end").success());
        let so_far = std::fs::read(&out).expect("results so far");
        assert!(
            whole.starts_with(&so_far),
            "nothing in the file that should not be there"
        );
    }
    assert!(kills > 0, "at least one run was killed under way");
    assert!(run(&args, &out).status.success());
    assert_eq!(std::fs::read(&out).expect("results"), whole);
}

#[test]
fn ctrl_c_keeps_what_was_played_and_says_how_to_go_on() {
    let place = TempDir::new().expect("a folder");
    let out = place.path().join("stopped.csv");
    // An hour's work: it does not end by itself before it is told to.
    let args = [
        "grid",
        "--games",
        "100000",
        "--trucks",
        "8",
        "--slots",
        "900",
        "--threads",
        "1",
    ];
    let child = truckin(&args, &out).spawn().expect("the command starts");
    let late = Instant::now() + Duration::from_secs(60);
    while std::fs::metadata(&out).map_or(0, |file| file.len()) < 1000 && Instant::now() < late {
        std::thread::sleep(Duration::from_millis(1));
    }
    let told = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(told.expect("kill starts").success());
    let done = child.wait_with_output().expect("its end");
    let said = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(130), "{said}");
    assert!(
        said.contains("truck-slots are kept, and the same command goes on"),
        "{said}"
    );
    let kept = std::fs::read_to_string(&out).expect("results so far");
    assert!(kept.ends_with('\n') && kept.lines().count() > 2, "whole lines");
}

#[test]
fn a_file_cut_anywhere_is_completed() {
    let place = TempDir::new().expect("a folder");
    let whole = std::fs::read(small(&place, "2")).expect("results");
    let out = place.path().join("cut.csv");
    for cut in [
        0,
        1,
        30,
        150,
        250,
        251,
        300,
        whole.len() / 2,
        whole.len() - 1,
        whole.len(),
    ] {
        std::fs::write(&out, &whole[..cut]).expect("a file");
        let done = run(&SMALL, &out);
        assert!(
            done.status.success(),
            "cut at {cut}: {}",
            String::from_utf8_lossy(&done.stderr)
        );
        assert_eq!(std::fs::read(&out).expect("results"), whole, "cut at {cut}");
    }
}

#[test]
fn a_damaged_file_is_refused_with_its_place_and_left_alone() {
    let place = TempDir::new().expect("a folder");
    let whole = std::fs::read(small(&place, "2")).expect("results");
    let out = place.path().join("damaged.csv");
    let mut refused = 0;
    for at in (0..whole.len()).step_by(97) {
        let mut bytes = whole.clone();
        bytes[at] = if bytes[at] == b'7' { b'8' } else { b'7' };
        std::fs::write(&out, &bytes).expect("a file");
        let done = run(&SMALL, &out);
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(2), "byte {at}: {said}");
        assert!(said.contains("damaged.csv:"), "{said}");
        assert_eq!(std::fs::read(&out).expect("results"), bytes, "never written over");
        refused += 1;
    }
    assert!(refused > 40);
    let mut more = whole.clone();
    more.extend_from_slice(b"1,50,0,0,0000,1,1\n");
    std::fs::write(&out, &more).expect("a file");
    assert_eq!(run(&SMALL, &out).status.code(), Some(2), "rows after the end");
    let half = [&whole[..whole.len() / 2], b"x"].concat();
    std::fs::write(&out, &half).expect("a file");
    assert_eq!(
        run(&SMALL, &out).status.code(),
        Some(2),
        "a tail that is no beginning of the next block"
    );
    assert_eq!(std::fs::read(&out).expect("results"), half);
}

#[test]
fn another_experiment_is_refused() {
    let place = TempDir::new().expect("a folder");
    let out = small(&place, "2");
    let before = std::fs::read(&out).expect("results");
    let done = run(&[&SMALL[..], &["--seed", "2"]].concat(), &out);
    assert_eq!(done.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&done.stderr).contains(":1: holds another experiment"));
    assert_eq!(std::fs::read(&out).expect("results"), before);
}

#[test]
fn a_report_never_takes_the_place_of_the_results() {
    let place = TempDir::new().expect("a folder");
    let out = place.path().join("results.html");
    assert_eq!(run(&SMALL, &out).status.code(), Some(2));
    assert!(!out.exists());
}
