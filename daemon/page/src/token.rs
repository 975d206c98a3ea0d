//! The token that others than this machine have to send.
//!
//! Must never be printed, nor compared in a time that tells how much of it was right.

use std::fmt;

/// A secret of at least [`Token::BYTES_MIN`] printable letters, digits and signs, sent as `Authorization: Bearer ...`.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

impl Token {
    /// The shortest token: 16 random letters are more than anybody can try.
    pub const BYTES_MIN: usize = 16;

    /// The longest token; a request has room for it many times.
    pub const BYTES_MAX: usize = 512;

    /// A token of that text, without the blanks around it; none if it is too short, too long or not printable.
    #[must_use]
    pub fn new(text: &str) -> Option<Token> {
        let text = text.trim();
        let sound = (Token::BYTES_MIN..=Token::BYTES_MAX).contains(&text.len());
        (sound && text.bytes().all(|byte| byte.is_ascii_graphic())).then(|| Token(text.to_owned()))
    }

    /// Whether an `Authorization` header carries it.
    pub(crate) fn is_in(&self, authorization: Option<&str>) -> bool {
        let (scheme, sent) = authorization
            .and_then(|text| text.split_once(' '))
            .unwrap_or_default();
        let (ours, sent) = (self.0.as_bytes(), sent.trim().as_bytes());
        let differ = ours
            .iter()
            .zip(sent)
            .fold(ours.len() ^ sent.len(), |differ, (a, b)| {
                differ | usize::from(a ^ b)
            });
        scheme.eq_ignore_ascii_case("bearer") && differ == 0
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("Token(..)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_whole_token_will_do() {
        let token = Token::new(" 0123456789abcdef\n").expect("long enough");
        assert!(token.is_in(Some("Bearer 0123456789abcdef")) && token.is_in(Some("bearer 0123456789abcdef")));
        for other in [
            "0123456789abcdef",
            "Bearer",
            "Bearer ",
            "Bearer 0123456789abcde",
            "Bearer 0123456789abcdefg",
            "Bearer 0123456789abcdeF",
            "Basic 0123456789abcdef",
        ] {
            assert!(!token.is_in(Some(other)), "{other}");
        }
        assert!(!token.is_in(None));
        assert_eq!(format!("{token:?}"), "Token(..)");
    }

    #[test]
    fn a_token_is_neither_short_nor_strange() {
        for text in [
            "",
            "short",
            "0123456789 abcdef",
            "0123456789abcdé",
            &"x".repeat(513),
        ] {
            assert_eq!(Token::new(text), None, "{text}");
        }
    }
}
