//! Newest: the stamp of the newest message that could be read of a cell which somebody else writes.
//!
//! A cell cannot be read while it is being written, and its writer may be held up right then, for as long as the
//! host likes. That is no message, not the loss of the one before, whose age tells.
//!
//! Must never take a failed read for news, good or bad.

use ipc::clock::Time;
use ipc::wire::{Reader, Reading};

/// The newest stamp read of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Newest(Option<Time>);

impl Newest {
    /// The newest stamp after a look at the cell; `None` if none was ever read.
    pub(crate) fn look(&mut self, cell: &Reader) -> Option<Time> {
        self.take(cell.read())
    }

    /// Forgets it: the cell is another's from now on.
    pub(crate) fn forget(&mut self) {
        self.0 = None;
    }

    fn take(&mut self, read: Option<Reading>) -> Option<Time> {
        self.0 = read.map(|reading| reading.stamp).or(self.0);
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ipc::message::{Kind, WORDS_MAX};
    use ipc::wire::Page;

    #[test]
    fn a_cell_that_is_being_written_leaves_the_stamp_before_to_age() {
        let page = Page::in_memory(1);
        let reader = page.reader(0, Kind::Number).expect("a cell");
        let mut writer = page.writer(0, Kind::Number).expect("its writer");
        let mut newest = Newest::default();
        assert_eq!(newest.look(&reader), None);
        writer.write(Time(20), &[0.0; WORDS_MAX]);
        assert_eq!(newest.look(&reader), Some(Time(20)));
        // Four tries, none of them whole.
        assert_eq!(newest.take(None), Some(Time(20)));
        writer.write(Time(40), &[0.0; WORDS_MAX]);
        assert_eq!(newest.look(&reader), Some(Time(40)));
        newest.forget();
        assert_eq!(newest.take(None), None);
    }
}
