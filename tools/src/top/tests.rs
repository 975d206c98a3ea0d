//! The screen at the two sizes that people use, and every key.

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use serde_json::{Value, json};

use super::look::{Look, Order, Sort};
use super::screen::{draw, sparkline};
use super::snapshot::Snapshot;

fn status() -> Value {
    let wire = |k: u32| {
        json!({"wire": format!("module{k}.port"), "type": "number", "unit": "m", "messages": k * 10,
               "rate_hz": f64::from(k), "age_ms": 100.0 - f64::from(k), "value": 0.5})
    };
    json!({
        "creature": "allen", "pid": 77, "time_s": 65.0, "mode": "real time",
        "halt": {"halted": true, "causes": ["emergency stop"], "latched": true, "since_s": 60.0},
        "layers": [
            {"name": "avoid", "level": 0, "period_ms": 10.0, "beats": 6500, "overruns": 3, "attached": false,
             "latency_us": {"p99": 120.0, "max": 900.0}, "trail_us": [1.0, 2.0, 4.0, 8.0]},
            {"name": "wander", "level": 1, "period_ms": 20.0, "attached": true, "pid": 4242},
        ],
        "taps": [{"kind": "suppress", "from": "avoid.heading", "to": "turn.heading", "layer": "wander",
                  "remaining_ms": 1234.0, "delivered": 5, "rejected": 6}],
        "wires": (0..40).map(wire).collect::<Vec<_>>(),
        "events": [{"time_s": 4.0, "text": "layer wander (pid 4242) attached"}],
    })
}

fn shown(look: &Look, width: u16, height: u16) -> Vec<String> {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("a terminal in memory");
    let snapshot = Snapshot::of(&status());
    terminal
        .draw(|frame| draw(frame, &snapshot, look))
        .expect("it draws");
    let buffer = terminal.backend().buffer().clone();
    let row = |y| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(row).collect()
}

fn key(look: &mut Look, code: KeyCode) -> Option<Order> {
    look.key(KeyEvent::new(code, KeyModifiers::NONE))
}

#[test]
fn everything_is_on_a_small_screen_and_on_a_large_one() {
    for (width, height) in [(80, 24), (200, 60)] {
        let rows = shown(&Look::default(), width, height);
        let text = rows.join("\n");
        for part in [
            "allen  pid 77  up 65 s  real time",
            "HALTED: emergency stop (5 s; `r` resets)",
            "6500",
            "900",
            "▁▂▄█",
            "process 4242",
            "(S) avoid.heading",
            "1234 ms",
            "module0.port",
            "WIRE (by wiring, 40 of 40)",
            "q quit",
        ] {
            assert!(
                text.contains(part),
                "{part:?} is not on the screen of {width}x{height}:\n{text}"
            );
        }
        assert_eq!(
            text.contains("layer wander (pid 4242) attached"),
            height == 60,
            "events on a high screen"
        );
    }
}

#[test]
fn the_smallest_terminal_does_not_break_it() {
    for (width, height) in [(1, 1), (10, 3), (30, 8)] {
        shown(
            &Look {
                help: true,
                ..Look::default()
            },
            width,
            height,
        );
    }
}

#[test]
fn keys_sort_filter_scroll_and_freeze() {
    let mut look = Look::default();
    let first = |look: &Look| {
        look.wires(&Snapshot::of(&status()))
            .first()
            .map(|w| w.name.clone())
    };
    for (sort, wire) in [
        (Sort::Name, "module0.port"),
        (Sort::Rate, "module39.port"),
        (Sort::Age, "module39.port"),
        (Sort::Messages, "module39.port"),
    ] {
        assert_eq!(key(&mut look, KeyCode::Char('s')), None);
        assert_eq!((look.sort, first(&look).as_deref()), (sort, Some(wire)));
    }
    key(&mut look, KeyCode::Char('s'));
    "/le17q"
        .chars()
        .for_each(|c| assert_eq!(key(&mut look, KeyCode::Char(c)), None));
    key(&mut look, KeyCode::Backspace);
    key(&mut look, KeyCode::Enter);
    let text = shown(&look, 80, 24).join("\n");
    assert!(
        text.contains("filter: le17 ") && text.contains("module17.port") && !text.contains("module0.port")
    );
    key(&mut look, KeyCode::Esc);
    key(&mut look, KeyCode::PageDown);
    key(&mut look, KeyCode::Down);
    assert!(!shown(&look, 80, 24).join("\n").contains("module10.port"));
    key(&mut look, KeyCode::Char('f'));
    assert!(look.frozen && shown(&look, 80, 24).join("\n").contains("FROZEN"));
    key(&mut look, KeyCode::Char('?'));
    assert!(
        shown(&look, 80, 24)
            .join("\n")
            .contains("emergency stop, holds until reset")
    );
    assert_eq!(
        key(&mut look, KeyCode::Char('h')),
        None,
        "any key closes the help, and does no more"
    );
    assert_eq!(key(&mut look, KeyCode::Char('h')), Some(Order::Halt));
    assert_eq!(key(&mut look, KeyCode::Char('r')), Some(Order::Reset));
    assert_eq!(key(&mut look, KeyCode::Char('q')), Some(Order::Quit));
}

#[test]
fn without_colour_there_is_none() {
    let draws_colour = |plain: bool| {
        let mut terminal = Terminal::new(TestBackend::new(80, 24)).expect("a terminal in memory");
        let look = Look {
            plain,
            ..Look::default()
        };
        let snapshot = Snapshot::of(&status());
        terminal
            .draw(|frame| draw(frame, &snapshot, &look))
            .expect("it draws");
        let reset = ratatui::style::Color::Reset;
        terminal
            .backend()
            .buffer()
            .content()
            .iter()
            .any(|c| c.fg != reset || c.bg != reset)
    };
    assert!(draws_colour(false) && !draws_colour(true));
}

#[test]
fn a_sparkline_is_as_high_as_its_values() {
    assert_eq!(sparkline(&[1.0, 2.0, 4.0, 8.0], 3), "▂▄█");
    assert_eq!(sparkline(&[], 3), "");
    assert_eq!(sparkline(&[0.0, 0.0], 3), "▁▁");
}
