//! A drawing as SVG: black on white, self-contained, the same bytes for the same drawing.
//!
//! Must never fetch anything, nor hold text that was not escaped.

use std::fmt::Write as _;

use ipc::wiring::creature::How;

use crate::compact::{CONSTANT, LABEL, NAME, PORT};
use crate::drawing::{At, Circle, Drawing, Frame, Line, RADIUS, Shape, Strip, Wire};
use crate::xml::escaped;

/// What the SVG is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dress {
    /// A file of its own: carries its style.
    File,
    /// A part of a page that styles the same classes itself.
    Page,
}

/// Radius of a corner and of the hop of one wire over another.
const BEND: f64 = 4.0;

/// What the classes of a picture look like in a file of its own. A dark screen gets a dark picture, paper never.
const STYLE: &str = "\
text{font-family:'DejaVu Sans',Verdana,Arial,sans-serif;fill:#000}\
.paper{fill:#fff}\
.band rect{fill:none;stroke:#999;stroke-width:.8;stroke-dasharray:2 3}\
.level{font-weight:bold}.process,.port{fill:#444}\
.module rect,.end rect{fill:#fff;stroke:#000;stroke-width:1.4}\
.module .name{font-weight:bold}\
.line{fill:none;stroke:#000;stroke-width:1.2}.head,.joint{fill:#000}\
.label{font-style:italic}\
.disc{fill:#fff;stroke:#000;stroke-width:1.2}.letter{font-weight:bold}\
.fault .line,.module.fault rect,.end.fault rect,.fault .disc{stroke:#c00000}\
.module.fault rect{stroke-dasharray:5 3}\
.fault .line{stroke-width:1.8}\
.fault .head,.fault .joint,.fault text,text.fault{fill:#c00000}\
@media screen and (prefers-color-scheme:dark){\
text,.head,.joint{fill:#e8e8e8}.paper,.module rect,.end rect,.disc{fill:#16181c}\
.process,.port{fill:#aaa}.line,.module rect,.end rect,.disc{stroke:#e8e8e8}.band rect{stroke:#777}\
.fault .line,.module.fault rect,.end.fault rect,.fault .disc{stroke:#ff7a70}\
.fault .head,.fault .joint,.fault text,text.fault{fill:#ff7a70}}";

/// Writes a drawing as SVG.
pub fn svg(drawing: &Drawing, dress: Dress) -> String {
    let notes = drawing.faults.len() as f64 * 16.0;
    let longest = drawing
        .faults
        .iter()
        .map(|f| crate::measure::width(f, PORT) + 24.0);
    let width = longest.fold(drawing.width, f64::max).ceil();
    let height = drawing.height + notes;
    let mut out = String::with_capacity(1 << 14);
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"creature\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"{}\">\n<title>{}</title>\n<desc>{}</desc>\n",
        if dress == Dress::File { "img" } else { "group" },
        escaped(&format!("{}: wiring", drawing.name)),
        escaped(&describe(drawing)),
    );
    if dress == Dress::File {
        let _ = writeln!(out, "<style>{STYLE}</style>");
    }
    let _ = writeln!(
        out,
        "<rect class=\"paper\" width=\"{width}\" height=\"{height}\"/>"
    );
    for band in &drawing.bands {
        strip(&mut out, band, drawing.width);
    }
    for (k, stub) in drawing.stubs.iter().enumerate() {
        let line = path(stub, &crossings(drawing, drawing.wires.len() + k));
        let _ = writeln!(
            out,
            "<g class=\"stub\"><path class=\"line\" d=\"{line}\"/>{}</g>",
            head(stub)
        );
    }
    for (net, wire) in drawing.wires.iter().enumerate() {
        net_of(&mut out, wire, &crossings(drawing, net));
    }
    for frame in &drawing.boxes {
        box_of(&mut out, frame);
    }
    for &(x, y) in &drawing.resets {
        let _ = writeln!(
            out,
            "<g class=\"reset\"><title>reset line</title><circle class=\"disc\" cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>\
             <text class=\"letter\" x=\"{x}\" y=\"{}\" text-anchor=\"middle\" font-size=\"10\">R</text></g>",
            y + 3.5,
            r = RADIUS - 1.0,
        );
    }
    for tap in &drawing.taps {
        circle(&mut out, tap);
    }
    for (k, fault) in drawing.faults.iter().enumerate() {
        let y = drawing.height + 16.0 * k as f64 + 4.0;
        let _ = writeln!(
            out,
            "<text class=\"fault\" x=\"12\" y=\"{y}\" font-size=\"{PORT}\">{}</text>",
            escaped(&fault.replace('\n', "; "))
        );
    }
    out.push_str("</svg>\n");
    out
}

fn describe(drawing: &Drawing) -> String {
    let modules = drawing.boxes.iter().filter(|b| b.shape == Shape::Module).count();
    let layers: Vec<String> = drawing
        .bands
        .iter()
        .rev()
        .map(|b| format!("level {} {}", b.level, b.name))
        .collect();
    format!(
        "Layers from the bottom up: {}. {modules} modules, {} wires, {} taps. A circled S suppresses an input, \
         a circled I inhibits an output, each for the time beside it.",
        layers.join(", "),
        drawing.wires.len(),
        drawing.taps.len(),
    )
}

fn strip(out: &mut String, band: &Strip, width: f64) {
    let Strip {
        top, bottom, level, ..
    } = band;
    let process = band.process.iter().map(|p| {
        format!(
            "<text class=\"process\" x=\"20\" y=\"{}\" font-size=\"{PORT}\">{}</text>",
            top + 51.0,
            escaped(p)
        )
    });
    let _ = writeln!(
        out,
        "<g class=\"band\" data-layer=\"{name}\" data-level=\"{level}\">\
         <rect x=\"8\" y=\"{top}\" width=\"{}\" height=\"{}\" rx=\"6\"/>\
         <text class=\"level\" x=\"20\" y=\"{}\" font-size=\"{NAME}\">level {level}</text>\
         <text class=\"layer\" x=\"20\" y=\"{}\" font-size=\"{NAME}\">{name}</text>{}</g>",
        width - 16.0,
        bottom - top,
        top + 20.0,
        top + 36.0,
        process.collect::<String>(),
        name = escaped(&band.name),
    );
}

fn title(fault: Option<&String>, words: &str) -> String {
    let words = fault.map_or(words.to_string(), |f| format!("{words}\n{f}"));
    format!("<title>{}</title>", escaped(&words))
}

fn marked(class: &str, fault: bool) -> String {
    if fault {
        format!("{class} fault")
    } else {
        class.into()
    }
}

fn net_of(out: &mut String, wire: &Wire, crossings: &[At]) {
    let faulty = !wire.branches.is_empty() && wire.branches.iter().all(|b| b.fault.is_some());
    let _ = writeln!(
        out,
        "<g class=\"{}\" data-wire=\"{name}\">{}",
        marked("net", faulty),
        title(None, &wire.name),
        name = escaped(&wire.name),
    );
    for b in &wire.branches {
        branch(out, b, &wire.name, crossings);
    }
    for (x, y) in &wire.joints {
        let _ = write!(out, "<circle class=\"joint\" cx=\"{x}\" cy=\"{y}\" r=\"2.6\"/>");
    }
    if let Some((label, (x, y))) = &wire.label {
        let _ = write!(
            out,
            "<text class=\"label\" x=\"{x}\" y=\"{y}\" font-size=\"{LABEL}\">{}</text>",
            escaped(label)
        );
    }
    out.push_str("</g>\n");
}

fn branch(out: &mut String, b: &Line, from: &str, crossings: &[At]) {
    let verb = match b.tap {
        None => "to",
        Some(How::Suppress) => "suppresses",
        Some(How::Inhibit) => "inhibits",
    };
    let words = format!("{from} {verb} {}", b.to);
    let words = if b.to.is_empty() { from } else { &words };
    let class = if b.tap.is_some() {
        "branch tapping"
    } else {
        "branch"
    };
    let _ = writeln!(
        out,
        "<g class=\"{}\" data-to=\"{}\">{}<path class=\"line\" d=\"{}\"/>{}</g>",
        marked(class, b.fault.is_some()),
        escaped(&b.to),
        title(b.fault.as_ref(), words),
        path(&b.points, crossings),
        match b.tap {
            _ if b.to.is_empty() => String::new(),
            None => head(&b.points),
            Some(_) => head(&short(&b.points)),
        },
    );
}

/// The same line, ending at a circle's edge instead of its middle.
fn short(points: &[At]) -> Vec<At> {
    let mut points = points.to_vec();
    if let [.., a, b] = &mut points[..] {
        b.1 -= RADIUS * (b.1 - a.1).signum();
    }
    points
}

/// An arrow head at the last point.
fn head(points: &[At]) -> String {
    let [.., (ax, ay), (x, y)] = *points else {
        return String::new();
    };
    let (dx, dy) = ((x - ax).signum(), (y - ay).signum());
    let (dx, dy) = if (x - ax).abs() > (y - ay).abs() {
        (dx, 0.0)
    } else {
        (0.0, dy)
    };
    let corner = |side: f64| (x - 7.0 * dx + side * dy, y - 7.0 * dy + side * dx);
    let (l, r) = (corner(3.2), corner(-3.2));
    format!(
        "<path class=\"head\" d=\"M{x} {y}L{} {}L{} {}Z\"/>",
        l.0, l.1, r.0, r.1
    )
}

/// Points where level lines of a wire cross upright lines of others.
fn crossings(drawing: &Drawing, net: usize) -> Vec<At> {
    let lines = |net: usize| -> Vec<&[At]> {
        match drawing.wires.get(net) {
            Some(wire) => wire.branches.iter().map(|b| &b.points[..]).collect(),
            None => vec![&drawing.stubs[net - drawing.wires.len()][..]],
        }
    };
    let mut found = Vec::new();
    for mine in lines(net).iter().flat_map(|l| l.windows(2)) {
        let ((ax, y), (bx, by)) = (mine[0], mine[1]);
        if y != by {
            continue;
        }
        for other in (0..drawing.wires.len()).filter(|&o| o != net) {
            for theirs in lines(other).iter().flat_map(|l| l.windows(2)) {
                let ((x, ay), (cx, cy)) = (theirs[0], theirs[1]);
                let between = |v: f64, a: f64, b: f64| a.min(b) < v && v < a.max(b);
                if x == cx && between(x, ax, bx) && between(y, ay, cy) {
                    found.push((x, y));
                }
            }
        }
    }
    found
}

/// A path along corners, with round bends, hopping over `crossings`.
fn path(points: &[At], crossings: &[At]) -> String {
    let mut out = String::new();
    let Some(&(x, y)) = points.first() else {
        return out;
    };
    let _ = write!(out, "M{x} {y}");
    for (k, pair) in points.windows(2).enumerate() {
        let ((ax, ay), (bx, by)) = (pair[0], pair[1]);
        if ay == by {
            let mut hops: Vec<f64> = crossings
                .iter()
                .filter(|c| c.1 == ay && ax.min(bx) < c.0 && c.0 < ax.max(bx))
                .map(|c| c.0)
                .collect();
            hops.sort_by(|a, b| if ax < bx { a.total_cmp(b) } else { b.total_cmp(a) });
            hops.dedup();
            let (way, sweep) = if ax < bx { (1.0, 1) } else { (-1.0, 0) };
            for x in hops {
                let (from, to) = (x - way * BEND, x + way * BEND);
                let _ = write!(out, "H{from}A{BEND} {BEND} 0 0 {sweep} {to} {ay}");
            }
        }
        let Some(&(cx, cy)) = points.get(k + 2) else {
            let _ = write!(out, "L{bx} {by}");
            continue;
        };
        let near = |(px, py): At| {
            let length = (px - bx).abs() + (py - by).abs();
            let reach = BEND.min(length / 2.0) / length.max(1e-9);
            (bx + (px - bx) * reach, by + (py - by) * reach)
        };
        let (from, to) = (near((ax, ay)), near((cx, cy)));
        let _ = write!(out, "L{} {}Q{bx} {by} {} {}", from.0, from.1, to.0, to.1);
    }
    out
}

fn box_of(out: &mut String, f: &Frame) {
    let (class, attribute, what) = match f.shape {
        Shape::Module => ("module", "data-module", f.kind.as_str()),
        Shape::Sensor => ("end sensor", "data-body", "sensor"),
        Shape::Actuator => ("end actuator", "data-body", "actuator"),
    };
    let middle = (f.left + f.right) / 2.0;
    let (rx, below) = match f.shape {
        Shape::Module => (4.0, 16.0),
        _ => ((f.bottom - f.top) / 2.0, (f.bottom - f.top) / 2.0 + 4.5),
    };
    let _ = write!(
        out,
        "<g class=\"{}\" {attribute}=\"{name}\">{}\
         <rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{rx}\"/>\
         <text class=\"name\" x=\"{middle}\" y=\"{}\" text-anchor=\"middle\" font-size=\"{NAME}\">{name}</text>",
        marked(class, f.fault.is_some()),
        title(f.fault.as_ref(), &format!("{} ({what})", f.name)),
        f.left,
        f.top,
        f.right - f.left,
        f.bottom - f.top,
        f.top + below,
        name = escaped(&f.name),
    );
    if f.shape == Shape::Module {
        for (port, y) in &f.inputs {
            let _ = write!(
                out,
                "<text class=\"port\" x=\"{}\" y=\"{}\" font-size=\"{PORT}\">{}</text>",
                f.left + 6.0,
                y + 3.5,
                escaped(port)
            );
        }
    }
    out.push_str("</g>\n");
}

fn circle(out: &mut String, tap: &Circle) {
    let (letter, verb) = match tap.how {
        How::Suppress => ("S", "suppresses"),
        How::Inhibit => ("I", "inhibits"),
    };
    let (x, y) = tap.at;
    let words = format!("{} {verb} {} for {}", tap.from, tap.to, tap.constant);
    let _ = writeln!(
        out,
        "<g class=\"{}\" data-tap=\"{}\" data-kind=\"{}\">{}\
         <circle class=\"disc\" cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\"/>\
         <text class=\"letter\" x=\"{x}\" y=\"{}\" text-anchor=\"middle\" font-size=\"11\">{letter}</text>\
         <text class=\"constant\" x=\"{}\" y=\"{}\" font-size=\"{CONSTANT}\">{}</text></g>",
        marked("tap", tap.fault.is_some()),
        escaped(&format!("{}>{}", tap.from, tap.to)),
        if letter == "S" { "suppress" } else { "inhibit" },
        title(tap.fault.as_ref(), &words),
        y + 4.0,
        x + RADIUS - 1.0,
        y - RADIUS + 1.0,
        escaped(&tap.constant),
    );
}
