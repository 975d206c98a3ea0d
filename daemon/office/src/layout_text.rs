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
use crate::layout::{BLOCKS_MAX, Door, Kind, Layout, PLACES_MAX, Place, Room, Surface, WALL_THICKNESS_M};
use crate::plane::vec2;
use crate::space::Space;
use crate::ways::{WALK_RADIUS_M, Ways};
use core::fmt;
use core::ops::Range;
use serde::Deserialize;
use toml::Spanned;

/// Why a layout's text was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayoutError {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// What is wrong and what was expected.
    pub message: String,
}

impl fmt::Display for LayoutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.line, self.column, self.message)
    }
}

impl std::error::Error for LayoutError {}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLayout {
    name: String,
    size: Spanned<[f64; 2]>,
    start: Spanned<[f64; 3]>,
    #[serde(default)]
    wall: Vec<RawWall>,
    #[serde(default)]
    block: Vec<RawBlock>,
    #[serde(default)]
    leaf: Vec<RawLeaf>,
    #[serde(default)]
    place: Vec<RawPlace>,
    #[serde(default)]
    room: Vec<RawRoom>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawWall {
    name: Spanned<String>,
    from: Spanned<[f64; 2]>,
    to: Spanned<[f64; 2]>,
    #[serde(default)]
    doors: Vec<Spanned<[f64; 2]>>,
    #[serde(default)]
    surface: Surface,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLeaf {
    name: Spanned<String>,
    at: Spanned<[f64; 2]>,
    width: Spanned<f64>,
    #[serde(default)]
    turned: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRoom {
    name: Spanned<String>,
    from: Spanned<[f64; 2]>,
    to: Spanned<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawBlock {
    name: Spanned<String>,
    kind: RawKind,
    at: Spanned<[f64; 2]>,
    size: Spanned<[f64; 2]>,
    #[serde(default)]
    turned: Option<Spanned<f64>>,
    #[serde(default)]
    surface: Surface,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum RawKind {
    Desk,
    Table,
    Chair,
    Cabinet,
    Box,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPlace {
    name: Spanned<String>,
    at: Spanned<[f64; 2]>,
    goal: Option<bool>,
}

/// A refusal before its bytes are turned into line and column.
type Refusal = (Range<usize>, String);

fn refuse<T>(span: Range<usize>, message: String) -> Result<T, Refusal> {
    Err((span, message))
}

impl Layout {
    /// Reads a layout from TOML text in the form shown at the top of `layout_text.rs`.
    ///
    /// # Errors
    /// The first thing found wrong, with its line and column: the text's form, sizes out of bounds,
    /// names used twice, doors that do not fit their wall, a start or a way point inside something
    /// solid, a way point that nobody could walk to.
    pub fn parse(text: &str) -> Result<Layout, LayoutError> {
        let raw: Result<RawLayout, Refusal> =
            toml::from_str(text).map_err(|error| (error.span().unwrap_or(0..0), error.message().into()));
        raw.and_then(|raw| build(&raw)).map_err(|(span, message)| {
            let before = text.get(..span.start).unwrap_or(text);
            let line = before.matches('\n').count() + 1;
            let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
            LayoutError {
                line,
                column,
                message,
            }
        })
    }
}

fn build(raw: &RawLayout) -> Result<Layout, Refusal> {
    let [width, height] = *raw.size.get_ref();
    if ![width, height].iter().all(|side| (1.0..=200.0).contains(side)) {
        return refuse(raw.size.span(), "an office side must be within 1 to 200 m".into());
    }
    let mut layout = Layout::walled(&raw.name, width, height);
    for wall in &raw.wall {
        add_wall(&mut layout, wall)?;
    }
    for block in &raw.block {
        add_block(&mut layout, block)?;
    }
    for leaf in &raw.leaf {
        add_leaf(&mut layout, leaf)?;
    }
    for room in &raw.room {
        add_room(&mut layout, room)?;
    }
    // The ways are those through open doors.
    let mut space = Space::new(&layout);
    space.open_all_leaves(&layout);
    let start = raw.start.get_ref();
    inside(&layout, &raw.start, [start[0], start[1]])?;
    if let Some(near) = space.nearest(vec2(start[0], start[1]), ROBOT_RADIUS_M) {
        let thing = space.name(near.thing);
        return refuse(
            raw.start.span(),
            format!("the robot's start is inside or against {thing}"),
        );
    }
    layout.start = (start[0], start[1], start[2].to_radians());
    add_places(&mut layout, &space, &raw.place)?;
    Ok(layout)
}

fn inside<T>(layout: &Layout, here: &Spanned<T>, [x, y]: [f64; 2]) -> Result<(), Refusal> {
    if (0.0..=layout.width).contains(&x) && (0.0..=layout.height).contains(&y) {
        return Ok(());
    }
    refuse(
        here.span(),
        format!(
            "({x}, {y}) is outside the office, {} by {} m",
            layout.width, layout.height
        ),
    )
}

fn new_name(layout: &Layout, name: &Spanned<String>) -> Result<(), Refusal> {
    if layout.blocks.iter().any(|block| block.name == *name.get_ref()) {
        return refuse(name.span(), format!("a second thing named {:?}", name.get_ref()));
    }
    if layout.blocks.len() >= BLOCKS_MAX {
        return refuse(name.span(), format!("more than {BLOCKS_MAX} walls and blocks"));
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
        return refuse(raw.to.span(), "a wall must be at least 0.1 m long".into());
    }
    let mut doors = Vec::new();
    let mut free_from = 0.0;
    for door in &raw.doors {
        let [at, width] = *door.get_ref();
        let fits = width > 0.0 && at - width / 2.0 >= free_from && at + width / 2.0 <= length;
        if !fits {
            let expected = format!("expected room between {free_from:.2} and {length:.2} m along the wall");
            return refuse(door.span(), format!("this door does not fit: {expected}"));
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
        return refuse(raw.width.span(), "a door must be 0.3 to 4 m wide".into());
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
        return refuse(
            raw.to.span(),
            "a room goes from its south-west to its north-east".into(),
        );
    }
    let name = raw.name.get_ref().clone();
    if layout.rooms.iter().any(|room| room.name == name) {
        return refuse(raw.name.span(), format!("a second room named {name:?}"));
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
        Some(turned) if !turned.get_ref().is_finite() => refuse(
            turned.span(),
            "an angle must be a finite number of degrees".into(),
        ),
        Some(turned) => Ok(turned.get_ref().to_radians()),
        None => Ok(0.0),
    }
}

fn add_block(layout: &mut Layout, raw: &RawBlock) -> Result<(), Refusal> {
    new_name(layout, &raw.name)?;
    inside(layout, &raw.at, *raw.at.get_ref())?;
    let [width, depth] = *raw.size.get_ref();
    if ![width, depth].iter().all(|side| (0.05..=20.0).contains(side)) {
        return refuse(
            raw.size.span(),
            "a block's side must be within 0.05 to 20 m".into(),
        );
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

fn add_places(layout: &mut Layout, space: &Space, raw: &[RawPlace]) -> Result<(), Refusal> {
    for place in raw {
        let [x, y] = *place.at.get_ref();
        inside(layout, &place.at, [x, y])?;
        if layout
            .places
            .iter()
            .any(|other| other.name == *place.name.get_ref())
        {
            return refuse(
                place.name.span(),
                format!("a second place named {:?}", place.name.get_ref()),
            );
        }
        if layout.places.len() >= PLACES_MAX {
            return refuse(place.name.span(), format!("more than {PLACES_MAX} places"));
        }
        if let Some(near) = space.nearest(vec2(x, y), WALK_RADIUS_M) {
            let thing = space.name(near.thing);
            return refuse(
                place.at.span(),
                format!("nobody can stand here, {thing} is in the way"),
            );
        }
        let goal = place.goal.unwrap_or(true);
        layout.places.push(Place {
            name: place.name.get_ref().clone(),
            x,
            y,
            goal,
        });
    }
    let ways = Ways::new(layout, space);
    for (index, place) in raw.iter().enumerate() {
        if ways.length(0, index).is_infinite() {
            let first = raw[0].name.get_ref();
            return refuse(place.at.span(), format!("nobody can walk here from {first:?}"));
        }
    }
    Ok(())
}
