//! Text as XML holds it, for everything here that writes pictures and reports.
//!
//! Must never let a name out of somebody's file end an element or an attribute.

/// `text` as it may stand in an element or between double quotes; control characters that XML does not have are
/// shown as �.
///
/// ```
/// assert_eq!(graph::xml::escaped("a < \"b\"\t& c"), "a &lt; &quot;b&quot;&#9;&amp; c");
/// ```
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push_str("&#10;"),
            '\t' => out.push_str("&#9;"),
            c if c.is_control() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}
