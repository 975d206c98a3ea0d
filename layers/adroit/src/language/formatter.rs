//! One statement a line, comments and single blank lines kept, an indent for what belongs to an RM.

use super::lexer::{self, Kind, Token};
use super::parser::{Parser, parse};
use super::problem::Problems;
use super::statement::Statement;

/// Formats a program; formatting twice changes nothing more.
///
/// # Errors
/// Every place where the text is not of the language. A text with errors is not formatted in part.
pub fn format(text: &str) -> Result<String, Problems> {
    parse(text)?;
    let (tokens, _) = lexer::split(text);
    let mut out = String::new();
    let mut place = 0;
    let mut line_before = None;
    while tokens[place].kind != Kind::End {
        let at = tokens[place].at.line;
        if line_before.is_some_and(|before| at > before + 1) {
            out.push('\n');
        }
        if let Kind::Comment(comment) = &tokens[place].kind {
            if line_before == Some(at) {
                out.pop();
                out.push_str("  ");
            }
            out.push_str(format!("# {comment}").trim_end());
            place += 1;
            line_before = Some(at);
        } else {
            let (line, inner, consumed) = statement(&tokens[place..])?;
            for comment in inner {
                out.push_str(&format!("# {comment}\n"));
            }
            out.push_str(&line);
            place += consumed;
            line_before = Some(tokens[place - 1].at.line);
        }
        out.push('\n');
    }
    Ok(out)
}

/// The next statement, the comments inside it, and how many tokens both take.
fn statement(tokens: &[Token]) -> Result<(String, Vec<String>, usize), Problems> {
    let mut inner = Vec::new();
    let mut own = Vec::new();
    let mut consumed = 0;
    for token in tokens {
        consumed += 1;
        match &token.kind {
            Kind::Comment(comment) => inner.push(comment.clone()),
            _ => own.push(token.clone()),
        }
        if token.kind == Kind::Stop {
            break;
        }
    }
    let statement = Parser::over(&own)
        .statement()
        .map_err(|problem| Problems(vec![problem]))?;
    let opens = matches!(
        statement,
        Statement::ReportsToTop { .. }
            | Statement::ReportsToRm { .. }
            | Statement::ReportsToSubroutine { .. }
    );
    let indent = if opens { "" } else { "  " };
    Ok((format!("{indent}{statement}"), inner, consumed))
}
