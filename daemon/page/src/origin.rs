//! Who may ask: a page that this server served, or a program on this machine; with a token, others too.
//!
//! A foreign web page can make a browser send requests to 127.0.0.1, directly or by pointing a name
//! of its own at that address. The first kind carries a foreign `Origin`, the second a foreign
//! `Host`. Ports of the `Host` are not compared, so that a forwarded port works; the `Origin` must
//! then be exactly the page that the `Host` names. Who comes from elsewhere, or calls this machine by another
//! name, has to send the token: no page can make a browser do that.

use std::net::IpAddr;

use crate::Token;
use crate::request::Head;

/// What is to be done with a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It is answered.
    Welcome,
    /// It is from elsewhere and did not send the token: it may see the empty page and nothing else.
    TokenWanted,
    /// It is refused, for that reason.
    Refused(&'static str),
}

/// Judges a request that came from the address `from`; `token` is there if others are served.
pub(crate) fn verdict(head: &Head, from: IpAddr, token: Option<&Token>) -> Verdict {
    let Some(host) = head.host.as_deref() else {
        return Verdict::Refused("a Host header is needed");
    };
    let local = from.to_canonical().is_loopback() && names_this_machine(host);
    if !local && token.is_none() {
        return Verdict::Refused("the Host header names another machine");
    }
    if let Some(origin) = head.origin.as_deref() {
        let same = origin
            .strip_prefix("http://")
            .is_some_and(|from| from.eq_ignore_ascii_case(host));
        if !same {
            return Verdict::Refused("the Origin header names another page");
        }
    }
    let site = head.fetch_site.as_deref().unwrap_or("none");
    if head.method == "POST" && site != "same-origin" && site != "none" {
        return Verdict::Refused("another site may not press the buttons");
    }
    match token {
        Some(token) if !local && !token.is_in(head.authorization.as_deref()) => Verdict::TokenWanted,
        _ => Verdict::Welcome,
    }
}

/// Whether `host` (a `Host` header) is a loopback name, with a port or without.
fn names_this_machine(host: &str) -> bool {
    ["localhost", "127.0.0.1", "[::1]"].iter().any(|name| {
        let Some((head, tail)) = host.split_at_checked(name.len()) else {
            return false;
        };
        head.eq_ignore_ascii_case(name) && (tail.is_empty() || is_port(tail))
    })
}

/// Whether `tail` is a colon and a port number.
fn is_port(tail: &str) -> bool {
    tail.strip_prefix(':').is_some_and(|digits| {
        digits.bytes().all(|byte| byte.is_ascii_digit()) && digits.parse::<u16>().is_ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(method: &str, host: Option<&str>, origin: Option<&str>) -> Head {
        Head {
            method: method.into(),
            path: "/".into(),
            query: String::new(),
            authorization: None,
            host: host.map(Into::into),
            origin: origin.map(Into::into),
            fetch_site: None,
            body_bytes: 0,
        }
    }

    const HERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);

    fn here(head: &Head) -> Verdict {
        verdict(head, HERE, None)
    }

    fn refused(head: &Head) -> bool {
        matches!(here(head), Verdict::Refused(_))
    }

    #[test]
    fn others_need_the_token_and_this_machine_does_not() {
        let token = Token::new("0123456789abcdef");
        let elsewhere: IpAddr = [192, 168, 1, 5].into();
        let mut asked = head("GET", Some("robot.example:4686"), None);
        assert_eq!(verdict(&asked, elsewhere, token.as_ref()), Verdict::TokenWanted);
        assert_eq!(
            verdict(&asked, HERE, token.as_ref()),
            Verdict::TokenWanted,
            "a name that was pointed here"
        );
        assert!(matches!(verdict(&asked, elsewhere, None), Verdict::Refused(_)));
        asked.authorization = Some("Bearer 0123456789abcdef".into());
        assert_eq!(verdict(&asked, elsewhere, token.as_ref()), Verdict::Welcome);
        asked.origin = Some("http://evil.example".into());
        assert!(matches!(
            verdict(&asked, elsewhere, token.as_ref()),
            Verdict::Refused(_)
        ));
        let forged = head("GET", Some("localhost"), None);
        assert_eq!(verdict(&forged, elsewhere, token.as_ref()), Verdict::TokenWanted);
        assert_eq!(verdict(&forged, HERE, token.as_ref()), Verdict::Welcome);
    }

    #[test]
    fn loopback_names_pass_with_any_port() {
        for host in [
            "localhost",
            "LocalHost:1",
            "127.0.0.1:8086",
            "[::1]:65535",
            "[::1]",
        ] {
            assert_eq!(here(&head("GET", Some(host), None)), Verdict::Welcome, "{host}");
        }
    }

    #[test]
    fn foreign_and_malformed_hosts_are_refused() {
        let foreign = [
            "example.org",
            "127.0.0.1.example.org",
            "localhost:",
            "localhost:99999",
            "localhost:+1",
            "127.0.0.1@example.org",
            "",
            "0.0.0.0:80",
            "é",
        ];
        for host in foreign {
            assert!(refused(&head("GET", Some(host), None)), "{host}");
        }
        assert!(refused(&head("GET", None, None)));
    }

    #[test]
    fn the_origin_is_the_page_itself() {
        let host = Some("127.0.0.1:8086");
        assert_eq!(
            here(&head("POST", host, Some("http://127.0.0.1:8086"))),
            Verdict::Welcome
        );
        for origin in [
            "null",
            "http://127.0.0.1:3000",
            "https://127.0.0.1:8086",
            "http://evil",
        ] {
            assert!(refused(&head("POST", host, Some(origin))), "{origin}");
        }
    }

    #[test]
    fn another_site_cannot_post_without_an_origin_either() {
        let mut post = head("POST", Some("localhost:1"), None);
        post.fetch_site = Some("cross-site".into());
        assert!(refused(&post));
        post.fetch_site = Some("same-origin".into());
        assert_eq!(here(&post), Verdict::Welcome);
    }
}
