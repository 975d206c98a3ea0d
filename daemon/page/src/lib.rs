//! The live page: what a creature senses, carries and does, in a browser on the same machine.
//!
//! A page must never make the creature wait. It reads what a [`Source`] hands it, at its own pace,
//! on its own threads, and it has two buttons: halt and reset. It never writes a wire.
//!
//! ```text
//!   browser ──GET /api/plan, state, timeline──► worker threads ──► Source::plan, state, timeline
//!           ──POST /api/halt, /api/reset──────►                ──► Source::halt, reset
//! ```
//!
//! Local words: the *plan* is what stays (the floor and the wiring), the *state* is what moves and
//! is asked for ten times a second. Both are JSON texts that pass through this crate unread; their
//! shape is in the crate's README.
//!
//! Only this machine is served, unless a [`Token`] is given: then others are who send it. A request whose
//! `Host` or `Origin` names anybody else is refused, so that a web page from elsewhere cannot read the
//! creature or press its buttons.

mod answer;
mod assets;
mod error;
mod origin;
mod request;
mod routes;
mod server;
mod token;

pub use error::ServeError;
pub use server::{Server, serve, serve_others};
pub use token::Token;

/// Where the page gets what it shows, and where its two buttons lead.
///
/// The methods are called on the page's own threads, several at a time. They must not panic and
/// should not block on anything that a real-time thread holds.
pub trait Source: Send + Sync {
    /// The floor and the wiring as one JSON object.
    ///
    /// Asked for once by each page, and again whenever `graph_version` in the state has changed.
    fn plan(&self) -> String;

    /// Everything that moves as one JSON object. Asked for ten times a second by each page.
    fn state(&self) -> String;

    /// What changed of the time line after the change numbered `after`, as one JSON object.
    ///
    /// Asked for once a second by each page.
    fn timeline(&self, after: u64) -> String;

    /// Halts the creature. Cannot be refused.
    fn halt(&self);

    /// Releases a halt.
    ///
    /// # Errors
    /// Says in words for an operator why the creature stays halted.
    fn reset(&self) -> Result<(), String>;

    /// Sets the pace of a world that goes by turns: `slow`, `normal`, `fast`, `pause`, or `step` for one turn.
    ///
    /// # Errors
    /// Says in words for an operator why the world goes on as it did.
    fn pace(&self, _word: &str) -> Result<(), String> {
        Err("this world keeps its own pace".to_owned())
    }
}
