//! Where everything stands in the drawing: the main tree first, then each subroutine as a tree of its own.

use super::{LINE, lines};
use crate::hierarchy::{Control, Hierarchy, LevelIndex, MechanismIndex};
use crate::language::Vocabulary;

const GAP: f64 = 12.0;
const LETTER: f64 = 6.4;
const BAR: f64 = 18.0;
const BELOW_BAR: f64 = 16.0;
const END: f64 = 44.0;

/// A rectangle, pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Box {
    pub(super) fn middle(&self) -> f64 {
        self.x + self.width / 2.0
    }
}

/// Boxes of all RMs and bars of all selectors.
pub(super) struct Layout {
    pub(super) boxes: Vec<(MechanismIndex, Box)>,
    pub(super) bars: Vec<(LevelIndex, Box)>,
    pub(super) width: f64,
    pub(super) height: f64,
}

struct Drawer<'a> {
    hierarchy: &'a Hierarchy,
    vocabulary: &'a Vocabulary,
    layout: Layout,
    roots: Vec<LevelIndex>,
}

impl Layout {
    pub(super) fn of(hierarchy: &Hierarchy, vocabulary: &Vocabulary) -> Self {
        let layout = Self {
            boxes: Vec::new(),
            bars: Vec::new(),
            width: 0.0,
            height: 0.0,
        };
        let mut drawer = Drawer {
            hierarchy,
            vocabulary,
            layout,
            roots: vec![LevelIndex(0)],
        };
        let (mut done, mut y) = (0, GAP);
        while done < drawer.roots.len() {
            let width = drawer.level(drawer.roots[done], GAP, y);
            drawer.layout.width = drawer.layout.width.max(width + 2.0 * GAP);
            y = drawer.layout.height + 3.0 * GAP;
            done += 1;
        }
        drawer.layout.height += GAP;
        drawer.layout
    }
}

impl Drawer<'_> {
    /// Lays out a level and all below it from a corner on; tells how wide it came out.
    fn level(&mut self, level: LevelIndex, x: f64, y: f64) -> f64 {
        let members: Vec<_> = self.hierarchy.members(level).collect();
        let top = y + BAR + BELOW_BAR;
        let tallest = members.iter().map(|&rm| self.size(rm).1).fold(0.0, f64::max);
        let mut right = x;
        for rm in members {
            let (own, height) = self.size(rm);
            let mut width = own;
            match self.hierarchy.mechanisms()[usize::from(rm.0)].control {
                Control::Branch(below) => width = width.max(self.level(below, right, top + tallest + END)),
                Control::Subroutine(called) if !self.roots.contains(&called) => self.roots.push(called),
                _ => {}
            }
            let place = Box {
                x: right + (width - own) / 2.0,
                y: top,
                width: own,
                height,
            };
            self.layout.height = self.layout.height.max(top + height + END);
            self.layout.boxes.push((rm, place));
            right += width + GAP;
        }
        let width = (right - GAP - x).max(80.0);
        self.layout.bars.push((
            level,
            Box {
                x,
                y,
                width,
                height: BAR,
            },
        ));
        width
    }

    fn size(&self, rm: MechanismIndex) -> (f64, f64) {
        let lines = lines(self.hierarchy, self.vocabulary, rm);
        let end = match self.hierarchy.mechanisms()[usize::from(rm.0)].control {
            Control::Subroutine(level) => self.hierarchy.caption(level).len(),
            _ => 8,
        };
        let letters = lines.iter().map(String::len).max().unwrap_or(0).max(end);
        (letters as f64 * LETTER + 10.0, LINE * lines.len() as f64 + 8.0)
    }
}
