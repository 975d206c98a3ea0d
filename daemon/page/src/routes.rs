//! Which request leads where.

use std::net::IpAddr;

use crate::Source;
use crate::answer::Answer;
use crate::origin::{self, Verdict};
use crate::request::{Head, Unread};
use crate::{Token, assets};

/// Where the pace of a world is set; the word follows.
const PACE: &str = "/api/pace/";

/// The answer to a request.
pub(crate) fn answer(head: &Head, from: IpAddr, token: Option<&Token>, source: &dyn Source) -> Answer {
    match origin::verdict(head, from, token) {
        Verdict::Welcome => {}
        Verdict::TokenWanted if !head.path.starts_with("/api/") => {}
        Verdict::TokenWanted => return Answer::refusal("401 Unauthorized", "the token is needed"),
        Verdict::Refused(why) => return Answer::refusal("403 Forbidden", why),
    }
    match (head.method.as_str(), head.path.as_str()) {
        ("GET", "/api/plan") => Answer::json(source.plan()),
        ("GET", "/api/state") => Answer::json(source.state()),
        ("GET", "/api/timeline") => {
            let after = head.query.strip_prefix("after=").map_or(Ok(0), str::parse);
            match after {
                Ok(after) => Answer::json(source.timeline(after)),
                Err(_) => Answer::refusal("400 Bad Request", "after= wants the number of a change"),
            }
        }
        ("POST", "/api/halt") => {
            source.halt();
            Answer::json("{\"halted\":true}".to_owned())
        }
        ("POST", "/api/reset") => match source.reset() {
            Ok(()) => Answer::json("{\"reset\":true}".to_owned()),
            Err(why) => Answer::refusal("409 Conflict", &why),
        },
        ("POST", path) if path.starts_with(PACE) => match source.pace(&path[PACE.len()..]) {
            Ok(()) => Answer::json("{\"pace\":true}".to_owned()),
            Err(why) => Answer::refusal("409 Conflict", &why),
        },
        (_, "/api/plan" | "/api/state" | "/api/timeline") => method("use GET"),
        (_, "/api/halt" | "/api/reset") => method("use POST"),
        ("GET", path) => match assets::find(path) {
            Some(asset) => Answer {
                status: "200 OK",
                media: asset.media,
                text: asset.text.into(),
            },
            None => Answer::refusal("404 Not Found", "there is nothing here"),
        },
        _ => method("use GET"),
    }
}

/// The answer to something that is no request, or nothing if nobody is left to read it.
pub(crate) fn answer_unread(unread: &Unread) -> Option<Answer> {
    match unread {
        Unread::Gone => None,
        Unread::Malformed(why) => Some(Answer::refusal("400 Bad Request", why)),
        Unread::HeadTooLarge => {
            let status = "431 Request Header Fields Too Large";
            Some(Answer::refusal(status, "the request is too large"))
        }
        Unread::BodyTooLarge => Some(Answer::refusal("413 Content Too Large", "the body is too large")),
    }
}

/// A known path with a wrong method.
fn method(why: &str) -> Answer {
    Answer::refusal("405 Method Not Allowed", why)
}
