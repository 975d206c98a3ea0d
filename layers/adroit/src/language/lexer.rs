//! Text to words, numbers, full stops and comments.

use super::problem::{Position, Problem};

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Kind {
    /// A word of the language or a name.
    Word(String),
    /// A number.
    Number(f64),
    /// The full stop that ends a statement.
    Stop,
    /// A comment, from `#` to the end of its line, without the `#`.
    Comment(String),
    /// The end of the text.
    End,
}

/// One token and where it starts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) at: Position,
}

impl Token {
    /// How an error message names it.
    pub(crate) fn described(&self) -> String {
        match &self.kind {
            Kind::Word(word) => format!("`{word}`"),
            Kind::Number(number) => format!("the number {number}"),
            Kind::Stop => "the full stop".to_owned(),
            Kind::Comment(_) => "a comment".to_owned(),
            Kind::End => "the end of the text".to_owned(),
        }
    }
}

struct Reader<'a> {
    rest: std::iter::Peekable<std::str::Chars<'a>>,
    at: Position,
}

impl Reader<'_> {
    fn take(&mut self) -> Option<char> {
        let taken = self.rest.next()?;
        if taken == '\n' {
            self.at = Position {
                line: self.at.line + 1,
                column: 1,
            };
        } else {
            self.at.column += 1;
        }
        Some(taken)
    }

    fn take_while(&mut self, start: char, wanted: impl Fn(char) -> bool) -> String {
        let mut taken = String::from(start);
        while let Some(next) = self.rest.next_if(|&next| wanted(next)) {
            self.at.column += 1;
            taken.push(next);
        }
        taken
    }
}

/// Splits a text; characters that belong to nothing are reported and left out.
pub(crate) fn split(text: &str) -> (Vec<Token>, Vec<Problem>) {
    let mut reader = Reader {
        rest: text.chars().peekable(),
        at: Position { line: 1, column: 1 },
    };
    let mut tokens = Vec::new();
    let mut problems = Vec::new();
    loop {
        let at = reader.at;
        let Some(first) = reader.take() else { break };
        let kind = match first {
            space if space.is_whitespace() => continue,
            '.' => Kind::Stop,
            '#' => Kind::Comment(reader.take_while(' ', |next| next != '\n')[1..].trim().to_owned()),
            letter if letter.is_ascii_alphabetic() => {
                Kind::Word(reader.take_while(letter, |next| next.is_ascii_alphanumeric() || next == '-'))
            }
            digit if digit.is_ascii_digit() || digit == '-' || digit == '+' => {
                match number(&mut reader, digit) {
                    Some(number) => Kind::Number(number),
                    None => {
                        problems.push(Problem::new(at, "expected a number like -2 or 0.5"));
                        continue;
                    }
                }
            }
            other => {
                problems.push(Problem::new(
                    at,
                    format!("expected a word, a number or `.`, found `{other}`"),
                ));
                continue;
            }
        };
        tokens.push(Token { kind, at });
    }
    tokens.push(Token {
        kind: Kind::End,
        at: reader.at,
    });
    (tokens, problems)
}

/// A sign, digits, and a fraction only if a digit follows the point: `2.` is two and a full stop.
fn number(reader: &mut Reader<'_>, first: char) -> Option<f64> {
    let mut digits = reader.take_while(first, |next| next.is_ascii_digit());
    let mut ahead = reader.rest.clone();
    if ahead.next() == Some('.') && ahead.next().is_some_and(|next| next.is_ascii_digit()) {
        reader.take();
        digits.push_str(&reader.take_while('.', |next| next.is_ascii_digit()));
    }
    digits.parse().ok().filter(|number: &f64| number.is_finite())
}
