//! Colours for people at a terminal; none for programs, for `--color never` and where NO_COLOR is set.
//!
//! Must never change a word: without colours a report is the same text.

use std::io::Write as _;

use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};
use clap::ValueEnum;
use ipc::wiring::{Piece, Rejected};

/// When to use colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Color {
    /// At a terminal, unless NO_COLOR is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

fn style(piece: Piece) -> Style {
    let plain = Style::new();
    match piece {
        Piece::Error => plain.bold().fg_color(Some(AnsiColor::Red.into())),
        Piece::Message => plain.bold(),
        Piece::Frame | Piece::Also => plain.bold().fg_color(Some(AnsiColor::Blue.into())),
    }
}

/// Shows the errors of a file on the standard error stream.
pub(crate) fn show(rejected: &Rejected, color: Color) {
    let choice = match color {
        Color::Auto => ColorChoice::Auto,
        Color::Always => ColorChoice::Always,
        Color::Never => ColorChoice::Never,
    };
    let report = rejected.painted(&|piece, text| {
        let style = style(piece);
        format!("{style}{text}{style:#}")
    });
    let mut stream = AutoStream::new(std::io::stderr(), choice);
    // Nobody can be told that the standard error stream is gone.
    let _ = writeln!(stream, "{report}\n");
}
