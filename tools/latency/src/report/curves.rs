//! Percentile curves as a picture: how long, against how rarely longer.

use std::fmt::Write as _;

use graph::xml::escaped;

use crate::track::Track;

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 230.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 50.0;

/// Colours that can be told apart, also without colour vision (P. Tol's bright scheme and two greys).
const COLOURS: [&str; 9] = [
    "#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#777777", "#222222", "#bbbbbb",
];

/// Nines shown: up to one in a hundred thousand.
const DECADES: f64 = 5.0;

/// The curves of `tracks`.
pub fn draw(tracks: &[Track]) -> String {
    let shown: Vec<&Track> = tracks.iter().filter(|t| !t.total.is_empty()).collect();
    let low = shown
        .iter()
        .map(|t| t.total.value_at_quantile(0.1))
        .min()
        .unwrap_or(1)
        .max(10);
    let high = shown
        .iter()
        .map(|t| t.total.max())
        .max()
        .unwrap_or(1_000_000)
        .max(low * 10);
    let (low, high) = ((low as f64).log10().floor(), (high as f64).log10().ceil());
    let y = |ns: f64| {
        TOP + (HEIGHT - TOP - BOTTOM) * (1.0 - (ns.max(1.0).log10() - low) / (high - low)).clamp(0.0, 1.0)
    };
    let x = |q: f64| LEFT + (WIDTH - LEFT - RIGHT) * ((1.0 / (1.0 - q)).log10() / DECADES).min(1.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"12\"><title>Latency by percentile</title><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    axes(&mut svg, (low, high), x, y);
    for (k, track) in shown.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let dash = if k < COLOURS.len() { "none" } else { "5 3" };
        let mut points = String::new();
        for tenth in 0..=(DECADES * 20.0) as u32 {
            let q = 1.0 - 10_f64.powf(-f64::from(tenth) / 20.0);
            // Beyond the last sample there is nothing to show.
            if (1.0 - q) * (track.total.len() as f64) < 1.0 {
                break;
            }
            let _ = write!(
                points,
                "{:.1},{:.1} ",
                x(q),
                y(track.total.value_at_quantile(q) as f64)
            );
        }
        let _ = writeln!(
            svg,
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\" points=\"{points}\"/>"
        );
        let at = TOP + 14.0 + 17.0 * k as f64;
        let text_x = WIDTH - RIGHT + 36.0;
        let _ = writeln!(
            svg,
            "<path d=\"M{:.0} {:.0}h20\" stroke=\"{colour}\" stroke-width=\"3\" stroke-dasharray=\"{dash}\"/>\
             <text x=\"{text_x}\" y=\"{at}\">{}</text>",
            WIDTH - RIGHT + 10.0,
            at - 4.0,
            escaped(&track.name())
        );
    }
    svg.push_str("</svg>\n");
    svg
}

fn axes(svg: &mut String, (low, high): (f64, f64), x: impl Fn(f64) -> f64, y: impl Fn(f64) -> f64) {
    for decade in low as i32..=high as i32 {
        let at = y(10_f64.powi(decade));
        let label = match decade {
            ..3 => format!("{} ns", 10_u64.pow(decade.max(0) as u32)),
            3..6 => format!("{} µs", 10_u64.pow(decade as u32 - 3)),
            6..9 => format!("{} ms", 10_u64.pow(decade as u32 - 6)),
            _ => format!("{} s", 10_u64.pow(decade as u32 - 9)),
        };
        let end = WIDTH - RIGHT;
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {at:.1}H{end}\" stroke=\"#ddd\"/><text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            LEFT - 6.0,
            at + 4.0
        );
    }
    for (q, label) in [
        (0.0, "0"),
        (0.9, "90 %"),
        (0.99, "99 %"),
        (0.999, "99.9 %"),
        (0.9999, "99.99 %"),
        (0.99999, "99.999 %"),
    ] {
        let at = x(q);
        let bottom = HEIGHT - BOTTOM;
        let _ = writeln!(
            svg,
            "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{:.0}\" text-anchor=\"middle\">{label}</text>",
            bottom + 18.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{LEFT}\" y=\"{:.0}\">percentile: so many were not longer</text>",
        HEIGHT - 12.0
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn every_track_has_a_curve_and_a_name() {
        let tracks: Vec<Track> = (1..=12)
            .map(|k| {
                let mut track = Track::new(format!("layer<{k}>"), "step");
                let mut h = crate::track::histogram();
                (1..=1000).for_each(|n| h.saturating_record(n * 100 * k));
                track.add(Duration::ZERO, Duration::from_secs(1), h);
                track
            })
            .collect();
        let svg = draw(&tracks);
        assert_eq!(svg.matches("<polyline").count(), 12);
        assert!(svg.contains("layer&lt;12&gt;.step") && !svg.contains("NaN") && !svg.contains("inf"));
        assert!(draw(&[]).ends_with("</svg>\n"));
    }
}
