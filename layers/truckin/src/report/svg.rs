//! Plots of lines, bands and points as inline SVG.

use std::fmt::Write;

/// Colours of alleles 0 to 9; distinguishable without red and green.
pub const COLOURS: [&str; 10] = [
    "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8c6d31", "#7f7f7f", "#393b79",
    "#000000",
];

/// A line through points, in the plot's own units.
pub struct Line<'a> {
    /// Its name, shown when pointed at.
    pub name: String,
    /// Its colour.
    pub colour: &'a str,
    /// Its points.
    pub points: Vec<(f64, f64)>,
}

/// A plot with one pair of axes.
pub struct Plot<'a> {
    /// What is plotted.
    pub title: String,
    /// Size in pixels.
    pub size: (f64, f64),
    /// What the horizontal axis counts.
    pub across: &'a str,
    /// Lines.
    pub lines: Vec<Line<'a>>,
    /// A band between a lower and an upper line: across, lower, upper.
    pub band: Vec<(f64, f64, f64)>,
    /// Whether single points are drawn and the lines between them are not.
    pub dots: bool,
    /// How a height is written at the axis.
    pub label: fn(f64) -> String,
}

const LEFT: f64 = 62.0;
const RIGHT: f64 = 8.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 30.0;

impl Plot<'_> {
    /// The plot as an `svg` element.
    pub fn render(&self) -> String {
        let (width, height) = self.size;
        let limits = self.limits();
        let ((x_low, x_high), (y_low, y_high)) = limits;
        let x = |at: f64| LEFT + (at - x_low) / (x_high - x_low) * (width - LEFT - RIGHT);
        let y = |at: f64| height - BOTTOM - (at - y_low) / (y_high - y_low) * (height - TOP - BOTTOM);
        let mut svg = String::new();
        let _ = write!(
            svg,
            "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\">\
             <title>{title}</title><text x=\"{LEFT}\" y=\"13\" class=\"t\">{title}</text>",
            title = escape(&self.title),
        );
        self.axes(&mut svg, limits);
        if !self.band.is_empty() {
            let upper = self.band.iter().map(|(at, _, high)| (x(*at), y(*high)));
            let lower = self.band.iter().rev().map(|(at, low, _)| (x(*at), y(*low)));
            let points: String = upper
                .chain(lower)
                .map(|(x, y)| format!("{x:.1},{y:.1} "))
                .collect();
            let _ = write!(svg, "<polygon points=\"{points}\" class=\"b\"/>");
        }
        for line in &self.lines {
            let name = escape(&line.name);
            if self.dots {
                for (at, value) in &line.points {
                    let (x, y) = (x(*at), y(*value));
                    let _ = write!(
                        svg,
                        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\" fill=\"{}\"><title>{name}</title></circle>",
                        line.colour
                    );
                }
            } else {
                let points: String = line
                    .points
                    .iter()
                    .map(|(at, value)| format!("{:.1},{:.1} ", x(*at), y(*value)))
                    .collect();
                let _ = write!(
                    svg,
                    "<polyline points=\"{points}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\">\
                     <title>{name}</title></polyline>",
                    line.colour
                );
            }
        }
        svg.push_str("</svg>");
        svg
    }

    fn axes(&self, svg: &mut String, ((x_low, x_high), (y_low, y_high)): ((f64, f64), (f64, f64))) {
        let (width, height) = self.size;
        let floor = height - BOTTOM;
        for part in 0..=4 {
            let value = y_low + (y_high - y_low) * f64::from(part) / 4.0;
            let at = floor - (floor - TOP) * f64::from(part) / 4.0;
            let _ = write!(
                svg,
                "<line x1=\"{LEFT}\" x2=\"{}\" y1=\"{at:.1}\" y2=\"{at:.1}\" class=\"g\"/>\
                 <text x=\"{}\" y=\"{:.1}\" class=\"e\">{}</text>",
                width - RIGHT,
                LEFT - 4.0,
                at + 3.5,
                escape(&(self.label)(value))
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{LEFT}\" y=\"{0}\">{x_low:.0}</text><text x=\"{1}\" y=\"{0}\" class=\"e\">{x_high:.0}</text>\
             <text x=\"{2}\" y=\"{0}\" class=\"m\">{3}</text>",
            height - 12.0,
            width - RIGHT,
            (width + LEFT) / 2.0,
            escape(self.across)
        );
    }

    fn limits(&self) -> ((f64, f64), (f64, f64)) {
        let points = self.lines.iter().flat_map(|line| line.points.iter().copied());
        let band = self
            .band
            .iter()
            .flat_map(|(at, low, high)| [(*at, *low), (*at, *high)]);
        let (mut x, mut y) = ((f64::MAX, f64::MIN), (0.0_f64, f64::MIN));
        for (at, value) in points.chain(band) {
            x = (x.0.min(at), x.1.max(at));
            y = (y.0.min(value), y.1.max(value));
        }
        if x.0 >= x.1 {
            x = (x.0.min(0.0), x.0.max(0.0) + 1.0);
        }
        if y.0 >= y.1 {
            y = (y.0, y.0 + 1.0);
        }
        (x, y)
    }
}

/// Text as it may stand in HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
