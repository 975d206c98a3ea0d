//! The competence table as a picture: one panel for each column, one bar for each row, with its interval.
//!
//! SVG by hand: rectangles, lines and text are all it takes.

use std::fmt::Write as _;

use graph::xml::escaped;

use crate::figures::COLUMNS;
use crate::measure::Measured;
use crate::statistics::Estimate;
use crate::table::estimates;

/// Width of a panel, its labels, its bars, height of a line and of a title, pixels.
const PANEL: (f64, f64, f64, f64, f64) = (460.0, 210.0, 190.0, 18.0, 28.0);
/// Panels side by side.
const ACROSS: usize = 3;

/// The picture.
pub fn svg(measured: &[Measured]) -> String {
    let (width, _, _, line, title) = PANEL;
    let tall = title + line * measured.len() as f64 + 14.0;
    let down = COLUMNS.len().div_ceil(ACROSS);
    let (w, h) = (width * ACROSS as f64, tall * down as f64);
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"white\"/>\n"
    );
    let all: Vec<Vec<Estimate>> = measured.iter().map(estimates).collect();
    for (index, column) in COLUMNS.iter().enumerate() {
        let (x, y) = (width * (index % ACROSS) as f64, tall * (index / ACROSS) as f64);
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" font-weight=\"bold\"><title>{}</title>{}</text>",
            x + 8.0,
            y + 18.0,
            column.about,
            column.title
        );
        let top = all.iter().map(|row| row[index].high).filter(|v| v.is_finite());
        let top = top.fold(0.0_f64, f64::max).max(1e-9);
        for (row, estimates) in measured.iter().zip(&all) {
            let position = measured.iter().position(|m| std::ptr::eq(m, row)).unwrap_or(0);
            let place = (x, y + title + line * position as f64);
            bar(
                &mut out,
                place,
                row.row.title,
                &estimates[index],
                top,
                column.decimals,
            );
        }
    }
    out + "</svg>\n"
}

fn bar(out: &mut String, (x, y): (f64, f64), label: &str, estimate: &Estimate, top: f64, decimals: usize) {
    let (_, labels, bars, line, _) = PANEL;
    let (left, middle) = (x + labels + 8.0, y + line / 2.0);
    let shown = match label.char_indices().nth(36) {
        Some(_) => escaped(&label.chars().take(35).chain(['…']).collect::<String>()),
        None => escaped(label),
    };
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" font-size=\"10\">{shown}</text>",
        left - 6.0,
        middle + 4.0
    );
    if !estimate.value.is_finite() {
        return;
    }
    let at = |value: f64| left + bars * value / top;
    let _ = writeln!(
        out,
        "<rect x=\"{left}\" y=\"{}\" width=\"{:.1}\" height=\"{}\" fill=\"#7aa6c2\"/>\
         <line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{middle}\" y2=\"{middle}\" stroke=\"#222\"/>\
         <text x=\"{:.1}\" y=\"{}\" font-size=\"10\">{:.decimals$}</text>",
        y + 3.0,
        at(estimate.value) - left,
        line - 6.0,
        at(estimate.low),
        at(estimate.high),
        at(estimate.high) + 4.0,
        middle + 4.0,
        estimate.value
    );
}
