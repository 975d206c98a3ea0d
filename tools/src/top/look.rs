//! How the user wants to look: sorting, filter, freeze, help; and what each key does to that.
//!
//! Must never halt or reset by itself: a key that means that is handed on as an [`Order`].

use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use super::snapshot::{Snapshot, WireRow};

/// By what wires are sorted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Sort {
    /// As the daemon lists them: the body, then layer by layer.
    #[default]
    Wiring,
    Name,
    Rate,
    Age,
    Messages,
}

impl Sort {
    fn next(self) -> Sort {
        match self {
            Sort::Wiring => Sort::Name,
            Sort::Name => Sort::Rate,
            Sort::Rate => Sort::Age,
            Sort::Age => Sort::Messages,
            Sort::Messages => Sort::Wiring,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Sort::Wiring => "wiring",
            Sort::Name => "name",
            Sort::Rate => "rate",
            Sort::Age => "age",
            Sort::Messages => "messages",
        }
    }
}

/// What the user asked for beyond looking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    Halt,
    Reset,
    Quit,
}

/// How the user wants to look.
#[derive(Clone, Debug, Default)]
pub(crate) struct Look {
    pub(crate) sort: Sort,
    pub(crate) filter: String,
    /// Whether keys go into the filter.
    pub(crate) typing: bool,
    pub(crate) frozen: bool,
    pub(crate) help: bool,
    /// First wire that is shown.
    pub(crate) scroll: usize,
    pub(crate) plain: bool,
    /// What came of the last order, or why nothing new comes.
    pub(crate) said: String,
}

impl Look {
    /// Takes a key.
    pub(crate) fn key(&mut self, key: KeyEvent) -> Option<Order> {
        if key.modifiers.contains(KeyModifiers::CONTROL) && key.code == KeyCode::Char('c') {
            return Some(Order::Quit);
        }
        if self.typing {
            match key.code {
                KeyCode::Enter => self.typing = false,
                KeyCode::Esc => (self.typing, self.filter) = (false, String::new()),
                KeyCode::Backspace => drop(self.filter.pop()),
                KeyCode::Char(c) => self.filter.push(c),
                _ => {}
            }
            return None;
        }
        if self.help {
            self.help = false;
            return None;
        }
        match key.code {
            KeyCode::Char('q') => return Some(Order::Quit),
            KeyCode::Char('h') => return Some(Order::Halt),
            KeyCode::Char('r') => return Some(Order::Reset),
            KeyCode::Char('s') => self.sort = self.sort.next(),
            KeyCode::Char('f' | ' ') => self.frozen = !self.frozen,
            KeyCode::Char('/') => self.typing = true,
            KeyCode::Char('?') => self.help = true,
            KeyCode::Esc => self.filter.clear(),
            KeyCode::Down | KeyCode::Char('j') => self.scroll = self.scroll.saturating_add(1),
            KeyCode::Up | KeyCode::Char('k') => self.scroll = self.scroll.saturating_sub(1),
            KeyCode::PageDown => self.scroll = self.scroll.saturating_add(10),
            KeyCode::PageUp => self.scroll = self.scroll.saturating_sub(10),
            KeyCode::Home => self.scroll = 0,
            _ => {}
        }
        None
    }

    /// The wires as they are to be shown.
    pub(crate) fn wires<'s>(&self, snapshot: &'s Snapshot) -> Vec<&'s WireRow> {
        let mut wires: Vec<&WireRow> = snapshot
            .wires
            .iter()
            .filter(|w| w.name.contains(&self.filter))
            .collect();
        match self.sort {
            Sort::Wiring => {}
            Sort::Name => wires.sort_by(|a, b| a.name.cmp(&b.name)),
            Sort::Rate => wires.sort_by(|a, b| b.rate_hz.total_cmp(&a.rate_hz)),
            Sort::Age => {
                let age = |w: &WireRow| w.age_ms.unwrap_or(f64::INFINITY);
                wires.sort_by(|a, b| age(a).total_cmp(&age(b)));
            }
            Sort::Messages => wires.sort_by_key(|w| std::cmp::Reverse(w.messages)),
        }
        wires
    }
}
