//! What a layout's text may say, and where an error is said to be.

use office::Layout;

const GOOD: &str = r#"name = "two rooms"
size = [6.0, 4]
start = [1.0, 2.0, 90.0]

[[wall]]
name = "partition"
from = [3.0, 0.0]
to = [3.0, 4.0]
doors = [[2.0, 1.0]]

[[block]]
name = "desk"
kind = "desk"
at = [5.0, 0.5]
size = [1.6, 0.8]

[[place]]
name = "west"
at = [1.5, 3.0]

[[place]]
name = "door"
at = [3.0, 2.0]
goal = false

[[place]]
name = "east"
at = [4.5, 3.0]
"#;

#[test]
fn a_good_text_is_read() {
    let layout = Layout::parse(GOOD).expect("the text is good");
    assert_eq!(layout.blocks.len(), 4 + 2 + 1, "outer walls, two pieces, a desk");
    assert_eq!(layout.places.len(), 3);
    assert!((layout.start.2 - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn the_standard_office_is_good_and_furnished() {
    let layout = Layout::office();
    assert!(layout.blocks.len() >= 55, "{} blocks", layout.blocks.len());
    assert!(layout.places.len() >= 25, "{} places", layout.places.len());
}

#[test]
fn every_error_says_where() {
    let cases = [
        (
            "size = [6.0, 4]",
            "size = [6.0, 0.4]",
            (2, 8),
            "expected 1 to 200 m",
        ),
        ("size = [6.0, 4]", "size = [6.0, \"4\"]", (2, 14), "expected"),
        ("size = [6.0, 4]", "size = [6.0, 4", (3, 1), "missing comma"),
        (
            "start = [1.0, 2.0, 90.0]",
            "start = [7.0, 2.0, 90.0]",
            (3, 9),
            "outside the office",
        ),
        (
            "start = [1.0, 2.0, 90.0]",
            "start = [2.9, 0.5, 90.0]",
            (3, 9),
            "partition",
        ),
        (
            "doors = [[2.0, 1.0]]",
            "doors = [[0.2, 1.0]]",
            (9, 10),
            "does not fit",
        ),
        (
            "doors = [[2.0, 1.0]]",
            "doors = [[2.0, 1.0], [2.5, 1.0]]",
            (9, 22),
            "does not fit",
        ),
        (
            "doors = [[2.0, 1.0]]",
            "doors = []",
            (23, 6),
            "partition is in the way",
        ),
        (
            "doors = [[2.0, 1.0]]",
            "windows = 2",
            (9, 1),
            "unknown field `windows`",
        ),
        (
            "kind = \"desk\"",
            "kind = \"sofa\"",
            (13, 8),
            "unknown variant `sofa`",
        ),
        (
            "name = \"desk\"",
            "name = \"partition\"",
            (12, 8),
            "a second thing named",
        ),
        ("size = [1.6, 0.8]", "size = [1.6, 0.0]", (15, 8), "0.05 to 20"),
        (
            "name = \"east\"",
            "name = \"west\"",
            (27, 8),
            "a second place named",
        ),
        (
            "at = [4.5, 3.0]",
            "at = [4.5, 0.5]",
            (28, 6),
            "desk is in the way",
        ),
    ];
    for (from, to, (line, column), part) in cases {
        let error = Layout::parse(&GOOD.replace(from, to)).expect_err(to);
        assert_eq!((error.line, error.column), (line, column), "{to}: {error}");
        assert!(error.to_string().contains(part), "{to}: {error}");
        assert!(!error.help.is_empty(), "{to}: {error}");
    }
}

#[test]
fn a_place_that_nobody_can_walk_to_is_refused() {
    let walled_off = GOOD
        .replace("doors = [[2.0, 1.0]]", "")
        .replace("at = [3.0, 2.0]", "at = [2.0, 2.0]");
    let error = Layout::parse(&walled_off).expect_err("east is walled off");
    assert_eq!((error.line, error.column), (28, 6), "{error}");
    assert!(
        error.message.contains("nobody can walk here from \"west\""),
        "{error}"
    );
}

#[test]
fn all_errors_are_told_in_the_order_of_the_text() {
    let wrong = GOOD
        .replace("start = [1.0, 2.0, 90.0]", "start = [7.0, 2.0, 90.0]")
        .replace("size = [1.6, 0.8]", "size = [1.6, 0.0]")
        .replace("name = \"east\"", "name = \"west\"");
    let errors = Layout::read(&wrong).expect_err("three things are wrong");
    let lines: Vec<usize> = errors.iter().map(|error| error.line).collect();
    assert_eq!(lines, [3, 15, 27], "{errors:?}");
}
