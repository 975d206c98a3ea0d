//! The screen of `top`, drawn from a snapshot.
//!
//! Must never depend on anything but the snapshot, the look and the size: the same three give the same screen.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::{Block, Cell, Clear, Paragraph, Row, Table};

use super::look::Look;
use super::snapshot::{LayerRow, Snapshot, TapRow, WireRow};

/// Width from which there is room for more columns.
const WIDE: u16 = 120;

/// Lines of events on a high screen.
const EVENTS: u16 = 8;

const HELP: &str = "\
  q        quit
  s        sort wires: wiring, name, rate, age, messages
  /        filter wires by name; Enter keeps it, Esc drops it
  f        freeze and go on
  h        halt: emergency stop, holds until reset
  r        reset: ends an emergency stop
  up, down scroll the wires
  ?        this help; any key closes it";

/// Draws everything.
pub(crate) fn draw(frame: &mut Frame<'_>, snapshot: &Snapshot, look: &Look) {
    let area = frame.area();
    let layers = rows(snapshot.layers.len(), area.height / 4);
    let taps = if snapshot.taps.is_empty() {
        0
    } else {
        rows(snapshot.taps.len(), area.height / 5)
    };
    let events = if area.height >= 40 { EVENTS } else { 0 };
    let [title, halt, layers, taps, wires, events, foot] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(1),
        Constraint::Length(layers),
        Constraint::Length(taps),
        Constraint::Min(2),
        Constraint::Length(events),
        Constraint::Length(1),
    ])
    .areas(area);
    let paint = Paint { plain: look.plain };
    frame.render_widget(Line::styled(snapshot.title.clone(), paint.strong()), title);
    frame.render_widget(halt_line(snapshot, &paint), halt);
    draw_layers(frame, layers, snapshot, &paint);
    draw_taps(frame, taps, snapshot, &paint);
    draw_wires(frame, wires, snapshot, look, &paint);
    let lines = snapshot
        .events
        .iter()
        .rev()
        .take(usize::from(events.height.saturating_sub(1)));
    let lines: Vec<Line<'_>> = lines.rev().map(|e| Line::raw(e.as_str())).collect();
    let block = Block::new().title(Line::styled("EVENTS", paint.head()));
    frame.render_widget(Paragraph::new(lines).block(block), events);
    frame.render_widget(foot_line(look, &paint), foot);
    if look.help {
        draw_help(frame, area);
    }
}

/// Lines of a table with its head, bounded.
fn rows(n: usize, most: u16) -> u16 {
    (u16::try_from(n).unwrap_or(u16::MAX))
        .saturating_add(1)
        .min(most.max(3))
}

/// Colours, or none where `NO_COLOR` is set.
struct Paint {
    plain: bool,
}

impl Paint {
    fn strong(&self) -> Style {
        Style::new().add_modifier(Modifier::BOLD)
    }

    fn head(&self) -> Style {
        if self.plain {
            Style::new().add_modifier(Modifier::UNDERLINED)
        } else {
            Style::new().fg(Color::Cyan).add_modifier(Modifier::UNDERLINED)
        }
    }

    fn on(&self, color: Color) -> Style {
        if self.plain {
            Style::new().add_modifier(Modifier::REVERSED)
        } else {
            Style::new()
                .fg(Color::White)
                .bg(color)
                .add_modifier(Modifier::BOLD)
        }
    }

    fn ink(&self, color: Color) -> Style {
        if self.plain {
            Style::new()
        } else {
            Style::new().fg(color)
        }
    }
}

fn halt_line(snapshot: &Snapshot, paint: &Paint) -> Line<'static> {
    if snapshot.causes.is_empty() {
        return Line::styled("the body may move", paint.ink(Color::Green));
    }
    let how = if snapshot.latched { "; `r` resets" } else { "" };
    let text = format!(
        " HALTED: {} ({:.0} s{how}) ",
        snapshot.causes.join(", "),
        snapshot.halted_s
    );
    Line::styled(text, paint.on(Color::Red))
}

fn foot_line(look: &Look, paint: &Paint) -> Line<'static> {
    let frozen = if look.frozen { "FROZEN  " } else { "" };
    let filter = match (look.typing, look.filter.as_str()) {
        (true, text) => format!("filter: {text}_  "),
        (false, "") => String::new(),
        (false, text) => format!("filter: {text}  "),
    };
    let keys = "q quit  s sort  / filter  f freeze  h halt  r reset  ? help";
    let said = if look.said.is_empty() {
        String::new()
    } else {
        format!("  {}", look.said)
    };
    Line::styled(
        format!("{frozen}{filter}{keys}{said}"),
        paint.ink(Color::DarkGray),
    )
}

fn draw_layers(frame: &mut Frame<'_>, area: Rect, snapshot: &Snapshot, paint: &Paint) {
    let wide = area.width >= WIDE;
    let trail = if wide { 60 } else { 16 };
    let head = Row::new([
        "LAYER",
        "LEVEL",
        "PERIOD",
        "BEATS",
        "OVER",
        "P99 us",
        "MAX us",
        "LATENCY, 1 s MAX",
    ]);
    let row = |l: &LayerRow| {
        let level = l.level.map_or("-".into(), |n| n.to_string());
        let period = format!("{} ms", l.period_ms);
        if let Some(pid) = l.pid {
            let last = [
                String::new(),
                String::new(),
                String::new(),
                format!("process {pid}"),
            ];
            let cells = [l.name.clone(), level, period, "attached".into()]
                .into_iter()
                .chain(last);
            return Row::new(cells).style(paint.ink(Color::Magenta));
        }
        let over = Cell::new(l.overruns.to_string());
        let over = if l.overruns > 0 {
            over.style(paint.ink(Color::Yellow))
        } else {
            over
        };
        Row::new([
            Cell::new(l.name.clone()),
            Cell::new(level),
            Cell::new(period),
            Cell::new(l.beats.to_string()),
            over,
            Cell::new(format!("{:.0}", l.p99_us)),
            Cell::new(format!("{:.0}", l.max_us)),
            Cell::new(sparkline(&l.trail_us, trail)),
        ])
    };
    let widths = [
        Constraint::Length(if wide { 24 } else { 12 }),
        Constraint::Length(5),
        Constraint::Length(8),
        Constraint::Length(10),
        Constraint::Length(6),
        Constraint::Length(7),
        Constraint::Length(8),
        Constraint::Min(16),
    ];
    let table = Table::new(snapshot.layers.iter().map(row), widths).header(head.style(paint.head()));
    frame.render_widget(table, area);
}

/// The last `width` values as bars, each against the longest of them.
pub(crate) fn sparkline(values: &[f64], width: usize) -> String {
    const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let shown = &values[values.len().saturating_sub(width)..];
    let most = shown.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    shown
        .iter()
        .map(|v| BARS[((v / most * 8.0).ceil() as usize).clamp(1, 8) - 1])
        .collect()
}

fn draw_taps(frame: &mut Frame<'_>, area: Rect, snapshot: &Snapshot, paint: &Paint) {
    let head = Row::new(["TAP", "ON", "LAYER", "LEFT", "DELIVERED", "REJECTED"]);
    let row = |t: &TapRow| {
        let mark = if t.suppresses { "(S)" } else { "(I)" };
        let left = if t.left_ms > 0.0 {
            format!("{:.0} ms", t.left_ms)
        } else {
            "-".into()
        };
        let style = if t.left_ms > 0.0 {
            paint.ink(Color::Yellow)
        } else {
            Style::new()
        };
        let counts = [t.delivered.to_string(), t.rejected.to_string()];
        let cells = [format!("{mark} {}", t.from), t.to.clone(), t.layer.clone(), left];
        Row::new(cells.into_iter().chain(counts)).style(style)
    };
    let name = if area.width >= WIDE { 40 } else { 22 };
    let widths = [
        Constraint::Length(name),
        Constraint::Length(name - 4),
        Constraint::Length(10),
        Constraint::Length(9),
        Constraint::Length(10),
        Constraint::Length(10),
    ];
    // Those that hold first: they are what the space is for.
    let mut taps: Vec<&TapRow> = snapshot.taps.iter().collect();
    taps.sort_by(|a, b| b.left_ms.total_cmp(&a.left_ms));
    let table = Table::new(taps.into_iter().map(row), widths).header(head.style(paint.head()));
    frame.render_widget(table, area);
}

fn draw_wires(frame: &mut Frame<'_>, area: Rect, snapshot: &Snapshot, look: &Look, paint: &Paint) {
    let wires = look.wires(snapshot);
    let room = usize::from(area.height.saturating_sub(1));
    let first = look.scroll.min(wires.len().saturating_sub(room));
    let title = format!(
        "WIRE (by {}, {} of {})",
        look.sort.name(),
        wires.len(),
        snapshot.wires.len()
    );
    let head = Row::new([title.as_str(), "TYPE", "MESSAGES", "Hz", "AGE ms", "VALUE"].map(Cell::new));
    let row = |w: &&WireRow| {
        let age = w.age_ms.map_or("never".into(), |ms| format!("{ms:.0}"));
        let value = format!("{} {}", w.value, w.unit);
        let cells = [
            w.name.clone(),
            w.kind.clone(),
            w.messages.to_string(),
            format!("{:.1}", w.rate_hz),
            age,
            value,
        ];
        Row::new(cells)
    };
    let widths = [
        Constraint::Length(if area.width >= WIDE { 40 } else { 30 }),
        Constraint::Length(7),
        Constraint::Length(9),
        Constraint::Length(6),
        Constraint::Length(7),
        Constraint::Min(10),
    ];
    let table = Table::new(wires.iter().skip(first).map(row), widths).header(head.style(paint.head()));
    frame.render_widget(table, area);
}

fn draw_help(frame: &mut Frame<'_>, area: Rect) {
    let (width, height) = (64.min(area.width), 10.min(area.height));
    let place = Rect {
        x: (area.width - width) / 2,
        y: (area.height - height) / 2,
        width,
        height,
    };
    frame.render_widget(Clear, place);
    frame.render_widget(Paragraph::new(HELP).block(Block::bordered().title("keys")), place);
}
