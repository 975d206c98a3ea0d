//! Who may ask: only a page that this server served, or a program on this machine.
//!
//! A foreign web page can make a browser send requests to 127.0.0.1, directly or by pointing a name
//! of its own at that address. The first kind carries a foreign `Origin`, the second a foreign
//! `Host`. Ports of the `Host` are not compared, so that a forwarded port works; the `Origin` must
//! then be exactly the page that the `Host` names.

use crate::request::Head;

/// Why a request is refused, or nothing.
pub(crate) fn refusal(head: &Head) -> Option<&'static str> {
    let Some(host) = head.host.as_deref() else {
        return Some("a Host header is needed");
    };
    if !names_this_machine(host) {
        return Some("the Host header names another machine");
    }
    if let Some(origin) = head.origin.as_deref() {
        let same = origin
            .strip_prefix("http://")
            .is_some_and(|from| from.eq_ignore_ascii_case(host));
        if !same {
            return Some("the Origin header names another page");
        }
    }
    let site = head.fetch_site.as_deref().unwrap_or("none");
    if head.method == "POST" && site != "same-origin" && site != "none" {
        return Some("another site may not press the buttons");
    }
    None
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
            host: host.map(Into::into),
            origin: origin.map(Into::into),
            fetch_site: None,
            body_bytes: 0,
        }
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
            assert_eq!(refusal(&head("GET", Some(host), None)), None, "{host}");
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
            assert!(refusal(&head("GET", Some(host), None)).is_some(), "{host}");
        }
        assert!(refusal(&head("GET", None, None)).is_some());
    }

    #[test]
    fn the_origin_is_the_page_itself() {
        let host = Some("127.0.0.1:8086");
        assert_eq!(refusal(&head("POST", host, Some("http://127.0.0.1:8086"))), None);
        for origin in [
            "null",
            "http://127.0.0.1:3000",
            "https://127.0.0.1:8086",
            "http://evil",
        ] {
            assert!(refusal(&head("POST", host, Some(origin))).is_some(), "{origin}");
        }
    }

    #[test]
    fn another_site_cannot_post_without_an_origin_either() {
        let mut post = head("POST", Some("localhost:1"), None);
        post.fetch_site = Some("cross-site".into());
        assert!(refusal(&post).is_some());
        post.fetch_site = Some("same-origin".into());
        assert_eq!(refusal(&post), None);
    }
}
