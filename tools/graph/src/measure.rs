//! How wide words are, near enough, without a font at hand.
//!
//! Must never say less than a common sans-serif font needs: words would run into lines.

/// Width of `text` in pixels at `size`, in a wide sans-serif such as DejaVu Sans.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|c| share(c) * size).sum()
}

fn share(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '.' | ',' | '\'' | '|' | ':' | ';' => 0.33,
        'f' | 't' | 'r' | '-' | ' ' | '(' | ')' | '/' => 0.41,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.98,
        'A'..='Z' => 0.72,
        '_' => 0.52,
        '\u{1100}'.. => 1.1,
        _ => 0.63,
    }
}
