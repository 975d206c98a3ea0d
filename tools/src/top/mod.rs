//! `top`: a running creature on the terminal.
//!
//! Must never leave the terminal other than it found it, whatever happens.

mod look;
mod screen;
mod snapshot;
#[cfg(test)]
mod tests;

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use ipc::control::Request;
use ratatui::crossterm::event::{self, Event, KeyEventKind};

use crate::live;
use look::{Look, Order};
use snapshot::Snapshot;

/// How often the daemon is asked.
const ASK: Duration = Duration::from_millis(250);

/// Shows `creature` until the user has seen enough.
pub(crate) fn top(creature: &str) -> Result<(), String> {
    if !std::io::stdout().is_terminal() {
        return Err("top needs a terminal; `subsumectl status` and `wires` print".into());
    }
    // Before the terminal changes: no daemon is said in plain words.
    let mut snapshot = Snapshot::of(&live::ask_status(creature)?);
    let mut look = Look {
        plain: std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty()),
        ..Look::default()
    };
    let mut terminal = ratatui::try_init().map_err(|e| format!("the terminal: {e}"))?;
    let mut asked = Instant::now();
    let result = loop {
        if let Err(e) = terminal.draw(|frame| screen::draw(frame, &snapshot, &look)) {
            break Err(format!("the terminal: {e}"));
        }
        let order = match next_key(ASK.saturating_sub(asked.elapsed())) {
            Ok(Some(key)) => look.key(key),
            Ok(None) => None,
            Err(e) => break Err(format!("the terminal: {e}")),
        };
        match order {
            Some(Order::Quit) => break Ok(()),
            Some(Order::Halt) => look.said = said(live::send(creature, &Request::Halt), "halted"),
            Some(Order::Reset) => look.said = said(live::send(creature, &Request::Reset), "reset"),
            None => {}
        }
        if asked.elapsed() >= ASK {
            asked = Instant::now();
            match live::ask_status(creature) {
                Ok(status) if !look.frozen => snapshot = Snapshot::of(&status),
                Ok(_) => {}
                Err(e) => look.said = e,
            }
        }
    };
    ratatui::restore();
    result
}

fn next_key(wait: Duration) -> std::io::Result<Option<event::KeyEvent>> {
    if !event::poll(wait)? {
        return Ok(None);
    }
    Ok(match event::read()? {
        Event::Key(key) if key.kind == KeyEventKind::Press => Some(key),
        _ => None,
    })
}

fn said(done: Result<(), String>, what: &str) -> String {
    match done {
        Ok(()) => what.into(),
        Err(e) => e,
    }
}
