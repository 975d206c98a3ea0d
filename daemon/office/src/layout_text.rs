//! Reading a layout from TOML text; every refusal names the line and column it is about.
//!
//! ```toml
//! name = "two rooms"
//! size = [6.0, 4.0]              # inside of the outer walls, m: x east, y north
//! start = [1.0, 2.0, 90.0]       # the robot: m, m, degrees counter-clockwise from east
//!
//! [[wall]]                       # inner walls; the outer ones are made from the size
//! name = "partition"
//! from = [3.0, 0.0]
//! to = [3.0, 4.0]
//! doors = [[2.0, 1.0]]           # middle of the opening from the wall's start, its width
//! surface = "glass"              # plain, polished, glass; may be left out, here and for blocks
//!
//! [[leaf]]                       # a sliding door in an opening: people open it, time closes it
//! name = "west door"
//! at = [3.0, 2.0]
//! width = 1.0
//! turned = 90.0                  # degrees, may be left out
//!
//! [[room]]                       # for those who count rooms
//! name = "west room"
//! from = [0.0, 0.0]
//! to = [3.0, 4.0]
//!
//! [[block]]
//! name = "desk"
//! kind = "desk"                  # desk, table, chair, cabinet, box
//! at = [5.0, 0.5]                # centre
//! size = [1.6, 0.8]
//! turned = 0.0                   # degrees, may be left out
//!
//! [[place]]                      # way points, all of them reachable from each other
//! name = "west room"
//! at = [1.5, 3.0]
//! goal = true                    # may be left out; false for doorways: passed, never aimed at
//! ```

use crate::config::ROBOT_RADIUS_M;
use crate::layout::{BLOCKS_MAX, Door, Kind, Layout, PLACES_MAX, Place, Room, WALL_THICKNESS_M};
use crate::layout_form::{RawBlock, RawKind, RawLayout, RawLeaf, RawPlace, RawRoom, RawWall};
use crate::plane::vec2;
use crate::space::Space;
use crate::ways::{WALK_RADIUS_M, Ways};
use core::fmt;
use core::ops::Range;
use toml::Spanned;

/// Why a layout's text was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayoutError {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// The offending bytes.
    pub at: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What was expected, or what to do.
    pub help: String,
}

impl fmt::Display for LayoutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {}; {}",
            self.line, self.column, self.message, self.help
        )
    }
}

impl std::error::Error for LayoutError {}

/// A refusal before its bytes are turned into line and column: where, what is wrong, what to do.
type Refusal = (Range<usize>, String, String);

fn refuse<T>(span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Result<T, Refusal> {
    Err((span, message.into(), help.into()))
}

impl Layout {
    /// Reads a layout from TOML text in the form shown at the top of `layout_text.rs`.
    ///
    /// # Errors
    /// The first of those of [`Layout::read`].
    pub fn parse(text: &str) -> Result<Layout, LayoutError> {
        Layout::read(text).map_err(|mut errors| errors.swap_remove(0))
    }

    /// Reads a layout from TOML text in the form shown at the top of `layout_text.rs`.
    ///
    /// # Errors
    /// Everything found wrong, with line and column, in the order of the text; at least one thing: the text's form
    /// (of that the first slip only), sizes out of bounds, names used twice, doors that do not fit their wall, a
    /// start or a way point inside something solid, a way point that nobody could walk to.
    pub fn read(text: &str) -> Result<Layout, Vec<LayoutError>> {
        let form = "see `subsumectl new layout NAME` for an example of a layout";
        let raw: RawLayout = toml::from_str(text).map_err(|error| {
            let refusal = (error.span().unwrap_or(0..0), error.message().into(), form.into());
            vec![located(text, refusal)]
        })?;
        let mut refusals = Vec::new();
        match build(&raw, &mut refusals) {
            Some(layout) if refusals.is_empty() => Ok(layout),
            _ => {
                refusals.sort_by_key(|(at, ..)| at.start);
                Err(refusals
                    .into_iter()
                    .map(|refusal| located(text, refusal))
                    .collect())
            }
        }
    }
}

fn located(text: &str, (at, message, help): Refusal) -> LayoutError {
    let before = text.get(..at.start).unwrap_or(text);
    LayoutError {
        line: before.matches('\n').count() + 1,
        column: before.chars().rev().take_while(|&c| c != '\n').count() + 1,
        at,
        message,
        help,
    }
}

/// The layout; `None` where what is wrong leaves nothing to go on with.
fn build(raw: &RawLayout, refusals: &mut Vec<Refusal>) -> Option<Layout> {
    let [width, height] = *raw.size.get_ref();
    if ![width, height].iter().all(|side| (1.0..=200.0).contains(side)) {
        let help = "expected 1 to 200 m for each side";
        refusals.extend(
            refuse::<()>(
                raw.size.span(),
                format!("an office of {width} by {height} m"),
                help,
            )
            .err(),
        );
        return None;
    }
    let mut layout = Layout::walled(&raw.name, width, height);
    let mut note = |checked: Result<(), Refusal>| refusals.extend(checked.err());
    raw.wall.iter().for_each(|wall| note(add_wall(&mut layout, wall)));
    raw.block
        .iter()
        .for_each(|block| note(add_block(&mut layout, block)));
    raw.leaf.iter().for_each(|leaf| note(add_leaf(&mut layout, leaf)));
    raw.room.iter().for_each(|room| note(add_room(&mut layout, room)));
    // The ways are those through open doors.
    let mut space = Space::new(&layout);
    space.open_all_leaves(&layout);
    note(add_start(&mut layout, &space, &raw.start));
    raw.place
        .iter()
        .for_each(|place| note(add_place(&mut layout, &space, place)));
    // Where places are missing, ways may be missing for that reason.
    if refusals.is_empty() {
        reachable(&layout, &space, &raw.place, refusals);
    }
    Some(layout)
}

fn add_start(layout: &mut Layout, space: &Space, raw: &Spanned<[f64; 3]>) -> Result<(), Refusal> {
    let [x, y, degrees] = *raw.get_ref();
    inside(layout, raw, [x, y])?;
    if !degrees.is_finite() {
        return refuse(raw.span(), "the robot faces nowhere", FINITE);
    }
    if let Some(near) = space.nearest(vec2(x, y), ROBOT_RADIUS_M) {
        let message = format!(
            "the robot's start is inside or against {}",
            space.name(near.thing)
        );
        let help = format!("expected {ROBOT_RADIUS_M} m of room on every side of it");
        return refuse(raw.span(), message, help);
    }
    layout.start = (x, y, degrees.to_radians());
    Ok(())
}

const OWN_NAME: &str = "expected a name of its own";
const FINITE: &str = "expected a finite number of degrees";

fn inside<T>(layout: &Layout, here: &Spanned<T>, [x, y]: [f64; 2]) -> Result<(), Refusal> {
    if (0.0..=layout.width).contains(&x) && (0.0..=layout.height).contains(&y) {
        return Ok(());
    }
    let help = format!(
        "expected 0 to {} m for x, 0 to {} m for y",
        layout.width, layout.height
    );
    refuse(here.span(), format!("({x}, {y}) is outside the office"), help)
}

fn new_name(layout: &Layout, name: &Spanned<String>) -> Result<(), Refusal> {
    if layout.blocks.iter().any(|block| block.name == *name.get_ref()) {
        return refuse(
            name.span(),
            format!("a second thing named {:?}", name.get_ref()),
            OWN_NAME,
        );
    }
    if layout.blocks.len() >= BLOCKS_MAX {
        let message = format!("more than {BLOCKS_MAX} walls and blocks");
        return refuse(name.span(), message, "leave some out");
    }
    Ok(())
}

fn add_wall(layout: &mut Layout, raw: &RawWall) -> Result<(), Refusal> {
    new_name(layout, &raw.name)?;
    inside(layout, &raw.from, *raw.from.get_ref())?;
    inside(layout, &raw.to, *raw.to.get_ref())?;
    let ([x0, y0], [x1, y1]) = (*raw.from.get_ref(), *raw.to.get_ref());
    let length = (vec2(x1, y1) - vec2(x0, y0)).length();
    if length < 0.1 {
        return refuse(
            raw.to.span(),
            "the wall is too short",
            "expected at least 0.1 m from its start",
        );
    }
    let mut doors = Vec::new();
    let mut free_from = 0.0;
    for door in &raw.doors {
        let [at, width] = *door.get_ref();
        let fits = width > 0.0 && at - width / 2.0 >= free_from && at + width / 2.0 <= length;
        if !fits {
            let expected = format!("expected room between {free_from:.2} and {length:.2} m along the wall");
            return refuse(door.span(), "this door does not fit", expected);
        }
        free_from = at + width / 2.0;
        doors.push(Door { at, width });
    }
    let first = layout.blocks.len();
    layout.wall(raw.name.get_ref(), (x0, y0), (x1, y1), &doors);
    layout.blocks[first..]
        .iter_mut()
        .for_each(|piece| piece.surface = raw.surface);
    Ok(())
}

fn add_leaf(layout: &mut Layout, raw: &RawLeaf) -> Result<(), Refusal> {
    new_name(layout, &raw.name)?;
    inside(layout, &raw.at, *raw.at.get_ref())?;
    let width = *raw.width.get_ref();
    if !(0.3..=4.0).contains(&width) {
        return refuse(
            raw.width.span(),
            format!("a door of {width} m"),
            "expected 0.3 to 4 m",
        );
    }
    let turned = angle(raw.turned.as_ref())?;
    let [x, y] = *raw.at.get_ref();
    layout.block(
        raw.name.get_ref(),
        Kind::Leaf,
        (x, y),
        (width, WALL_THICKNESS_M),
        turned,
    );
    Ok(())
}

fn add_room(layout: &mut Layout, raw: &RawRoom) -> Result<(), Refusal> {
    inside(layout, &raw.from, *raw.from.get_ref())?;
    inside(layout, &raw.to, *raw.to.get_ref())?;
    let ([west, south], [east, north]) = (*raw.from.get_ref(), *raw.to.get_ref());
    if west >= east || south >= north {
        let help = "a room goes from its south-west to its north-east corner";
        return refuse(raw.to.span(), "the room has no inside", help);
    }
    let name = raw.name.get_ref().clone();
    if layout.rooms.iter().any(|room| room.name == name) {
        return refuse(raw.name.span(), format!("a second room named {name:?}"), OWN_NAME);
    }
    layout.rooms.push(Room {
        name,
        west,
        south,
        east,
        north,
    });
    Ok(())
}

/// Degrees as written, in rad.
fn angle(turned: Option<&Spanned<f64>>) -> Result<f64, Refusal> {
    match turned {
        Some(turned) if !turned.get_ref().is_finite() => refuse(turned.span(), "no angle", FINITE),
        Some(turned) => Ok(turned.get_ref().to_radians()),
        None => Ok(0.0),
    }
}

fn add_block(layout: &mut Layout, raw: &RawBlock) -> Result<(), Refusal> {
    new_name(layout, &raw.name)?;
    inside(layout, &raw.at, *raw.at.get_ref())?;
    let [width, depth] = *raw.size.get_ref();
    if ![width, depth].iter().all(|side| (0.05..=20.0).contains(side)) {
        let message = format!("a block of {width} by {depth} m");
        return refuse(raw.size.span(), message, "expected 0.05 to 20 m for each side");
    }
    let turned = angle(raw.turned.as_ref())?;
    let kind = match raw.kind {
        RawKind::Desk => Kind::Desk,
        RawKind::Table => Kind::Table,
        RawKind::Chair => Kind::Chair,
        RawKind::Cabinet => Kind::Cabinet,
        RawKind::Box => Kind::Box,
    };
    let [x, y] = *raw.at.get_ref();
    layout.block(raw.name.get_ref(), kind, (x, y), (width, depth), turned);
    if let Some(block) = layout.blocks.last_mut() {
        block.surface = raw.surface;
    }
    Ok(())
}

fn add_place(layout: &mut Layout, space: &Space, raw: &RawPlace) -> Result<(), Refusal> {
    let [x, y] = *raw.at.get_ref();
    inside(layout, &raw.at, [x, y])?;
    let name = raw.name.get_ref();
    if layout.places.iter().any(|other| other.name == *name) {
        return refuse(
            raw.name.span(),
            format!("a second place named {name:?}"),
            OWN_NAME,
        );
    }
    if layout.places.len() >= PLACES_MAX {
        let message = format!("more than {PLACES_MAX} places");
        return refuse(raw.name.span(), message, "leave some out");
    }
    if let Some(near) = space.nearest(vec2(x, y), WALK_RADIUS_M) {
        let message = format!("nobody can stand here, {} is in the way", space.name(near.thing));
        let help = format!("expected {WALK_RADIUS_M} m of room on every side");
        return refuse(raw.at.span(), message, help);
    }
    layout.places.push(Place {
        name: name.clone(),
        x,
        y,
        goal: raw.goal.unwrap_or(true),
    });
    Ok(())
}

/// That everybody can walk from the first place to every other.
fn reachable(layout: &Layout, space: &Space, raw: &[RawPlace], refusals: &mut Vec<Refusal>) {
    let ways = Ways::new(layout, space);
    for (index, place) in raw.iter().enumerate() {
        if ways.length(0, index).is_infinite() {
            let message = format!("nobody can walk here from {:?}", raw[0].name.get_ref());
            let help = "expected a door, or a place between them from which both can be seen";
            refusals.extend(refuse::<()>(place.at.span(), message, help).err());
        }
    }
}
