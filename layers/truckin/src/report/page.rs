//! The HTML file: a heading, sections one after the other, written in one go.

use std::io;
use std::path::Path;

use super::svg::{COLOURS, escape};
use crate::strategies::SLOTS;

/// A page being put together.
pub struct Page {
    body: String,
}

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:70em;margin:2em auto;padding:0 1em}\
table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #bbb;padding:.2em .6em;text-align:right}\
th{background:#eee}td:first-child,th:first-child{text-align:left}svg{margin:2px}\
svg text{font:10px system-ui,sans-serif;fill:#333}svg .t{font-weight:600;font-size:11px}\
svg .e{text-anchor:end}svg .m{text-anchor:middle}svg .g{stroke:#ddd}svg .b{fill:#0072b2;opacity:.18}\
.k{display:inline-block;width:.8em;height:.8em;margin-right:.3em}";

impl Page {
    /// An empty page.
    pub fn new(title: &str) -> Self {
        let title = escape(title);
        Self {
            body: format!(
                "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\
                 <style>{STYLE}</style></head><body><h1>{title}</h1>\n"
            ),
        }
    }

    /// Adds a heading.
    pub fn heading(&mut self, text: &str) {
        self.html(&format!("<h2>{}</h2>\n", escape(text)));
    }

    /// Adds a paragraph.
    pub fn paragraph(&mut self, text: &str) {
        self.html(&format!("<p>{}</p>\n", escape(text)));
    }

    /// Adds a table.
    pub fn table(&mut self, head: &[&str], rows: &[Vec<String>]) {
        let cells = |tag: &str, cells: &[String]| -> String {
            cells
                .iter()
                .map(|cell| format!("<{tag}>{}</{tag}>", escape(cell)))
                .collect()
        };
        let head: Vec<String> = head.iter().map(ToString::to_string).collect();
        let rows: String = rows
            .iter()
            .map(|row| format!("<tr>{}</tr>\n", cells("td", row)))
            .collect();
        self.html(&format!(
            "<table><tr>{}</tr>\n{rows}</table>\n",
            cells("th", &head)
        ));
    }

    /// Adds what is HTML already.
    pub fn html(&mut self, html: &str) {
        self.body.push_str(html);
    }

    /// Adds what the digits and colours stand for.
    pub fn key_to_alleles(&mut self) {
        for slot in SLOTS {
            self.html(&format!("<p><b>{}</b> ", escape(slot.name)));
            for (digit, allele) in slot.alleles.iter().enumerate() {
                let (colour, name) = (COLOURS[digit % COLOURS.len()], escape(allele.name));
                let idea = escape(allele.idea());
                self.html(&format!(
                    "<span title=\"{idea}\"><span class=\"k\" style=\"background:{colour}\"></span>\
                     {digit} {name}</span> &nbsp; "
                ));
            }
            self.html("</p>\n");
        }
    }

    /// Writes the page beside its place and moves it there, so that there is never half a page.
    ///
    /// # Errors
    /// Whatever the system says.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let mut beside = path.as_os_str().to_owned();
        beside.push(".part");
        std::fs::write(&beside, format!("{}</body></html>\n", self.body))?;
        std::fs::rename(&beside, path)
    }
}
