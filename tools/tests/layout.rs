//! A layout file of one's own: what `subsumectl new layout` writes is sound, runs, and its faults are told at their place.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of this test's own, removed when the test ends.
struct Folder(PathBuf);

impl Folder {
    /// With a layout `hall`, and Allen's creature file with `body` added to its body.
    fn new(what: &str, body: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("subsumectl-layout-{what}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        let folder = Folder(path);
        let written = folder.run(&["new", "layout", "hall"]);
        assert_eq!(written.status.code(), Some(0), "{}", text(&written));
        folder.write(
            "mine.toml",
            &allen::CREATURE.replace("[body]\n", &format!("[body]\n{body}\n")),
        );
        folder
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).expect("the file can be written");
    }

    fn layout(&self) -> String {
        std::fs::read_to_string(self.0.join("hall.layout.toml")).expect("the layout was written")
    }

    fn run(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_subsumectl"));
        command.current_dir(&self.0).args(args);
        command.output().expect("subsumectl runs")
    }

    /// What is said of the creature file, which is not sound.
    #[track_caller]
    fn refused(&self) -> String {
        let output = self.run(&["check", "mine.toml"]);
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        text(&output)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn text(output: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

const NAMED: &str = "layout_file = \"hall.layout.toml\"";

#[test]
fn a_new_layout_is_sound_and_is_never_written_over() {
    let folder = Folder::new("new", NAMED);
    let checked = folder.run(&["check", "mine.toml"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked));
    let again = folder.run(&["new", "layout", "hall"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again).contains("is there already"), "{}", text(&again));
}

#[test]
fn the_path_is_found_from_the_creature_file_wherever_one_stands() {
    let folder = Folder::new("elsewhere", NAMED);
    let mut command = Command::new(env!("CARGO_BIN_EXE_subsumectl"));
    let checked = command
        .current_dir(Path::new("/"))
        .arg("check")
        .arg(folder.0.join("mine.toml"))
        .output()
        .expect("subsumectl runs");
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked));
}

#[test]
fn every_fault_of_a_layout_is_told_at_its_own_place_and_where_it_is_named() {
    let folder = Folder::new("broken", NAMED);
    let broken = folder
        .layout()
        .replace("size = [0.4, 1.6]", "size = [0.4, 60.0]")
        .replace("at = [1.2, 4.0]", "at = [10.2, 4.0]");
    folder.write("hall.layout.toml", &broken);
    let said = folder.refused();
    for (text, what) in [
        ("size = [0.4, 60.0]", "a block of 0.4 by 60 m"),
        ("at = [10.2, 4.0]", "(10.2, 4) is outside the office"),
    ] {
        let line = broken
            .lines()
            .position(|l| l.starts_with(text))
            .expect("it is there")
            + 1;
        let column = text.find('[').expect("a list") + 1;
        assert!(said.contains(what), "{said}");
        assert!(
            said.contains(&format!("--> hall.layout.toml:{line}:{column}\n")),
            "{said}"
        );
    }
    assert!(said.contains("::: mine.toml:"), "{said}");
    assert!(said.contains("2 errors"), "{said}");
    folder.write("hall.layout.toml", "name = \"hall\"\nsize = [6.0, 4.0");
    assert!(folder.refused().contains("--> hall.layout.toml:2:"));
}

#[test]
fn a_file_that_is_missing_or_too_long_is_told_where_it_is_named() {
    let folder = Folder::new("missing", "layout_file = \"nowhere.toml\"");
    let said = folder.refused();
    assert!(said.contains("error[missing-file]: nowhere.toml"), "{said}");
    assert!(said.contains("--> mine.toml:"), "{said}");
    folder.write(
        "nowhere.toml",
        &format!("{}\n{}", folder.layout(), "#".repeat(300_000)),
    );
    let said = folder.refused();
    assert!(said.contains("error[file-too-long]"), "{said}");
    assert!(said.contains("expected at most 262144 bytes"), "{said}");
}

#[test]
fn a_layout_by_name_and_one_by_file_are_not_both_given() {
    let folder = Folder::new("both", &format!("{NAMED}\nlayout = \"kept\"\nnumber = 3"));
    let said = folder.refused();
    assert!(
        said.contains("\"layout_file\" is given beside \"layout\""),
        "{said}"
    );
    assert!(
        said.contains("\"layout_file\" is given beside \"number\""),
        "{said}"
    );
}

#[test]
fn a_scenario_is_played_in_it() {
    let folder = Folder::new("scenario", NAMED);
    folder.write(
        "there.toml",
        "scenario = \"It drives about the hall and hits nothing.\"\ncreature = \"mine.toml\"\nworld = true\n\
         duration = \"19500ms\"\n[[expect]]\nwire = \"sonar.map\"\ncount = { min = 19, max = 20 }\n",
    );
    let played = folder.run(&["test", "there.toml"]);
    assert_eq!(played.status.code(), Some(0), "{}", text(&played));
}

#[test]
fn a_measurement_may_be_made_in_it_and_not_in_a_broken_one() {
    let folder = Folder::new("compete", NAMED);
    let measure = |rows: &str| {
        folder.run(&[
            "compete",
            "allen",
            "--layout",
            "hall.layout.toml",
            "--rows",
            rows,
            "--seeds",
            "1",
            "--hours",
            "0.02",
        ])
    };
    let measured = measure("0,two,other0");
    assert_eq!(measured.status.code(), Some(0), "{}", text(&measured));
    assert!(text(&measured).contains("two robots"), "{}", text(&measured));
    assert!(!text(&measured).contains("another world"), "{}", text(&measured));
    assert_eq!(measure("other0").status.code(), Some(2));
    folder.write("hall.layout.toml", "name = \"hall\"\n");
    let refused = measure("0");
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused));
    assert!(
        text(&refused).contains("hall.layout.toml:1:1"),
        "{}",
        text(&refused)
    );
}
