//! The floor plan: walls, furniture, and the way points that people walk between.
//!
//! A layout is plain data in metres; the south-west corner of the office is the origin, x points
//! east, y north. It is built here call by call, or read from text (`layout_text`).

use serde::Serialize;

/// Thickness of a wall, m: a light partition.
pub const WALL_THICKNESS_M: f64 = 0.10;
/// Most blocks in one layout: a bound for the buffers, ten times the standard office.
pub const BLOCKS_MAX: usize = 1024;
/// Most way points in one layout.
pub const PLACES_MAX: usize = 256;

/// Longest text of a layout, in bytes: [`BLOCKS_MAX`] blocks take less than half of it.
pub const LAYOUT_BYTES_MAX: usize = 256 << 10;

/// What a block is, for whoever draws it. All kinds stop the robot; what they answer depends on their surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A wall, or the piece of one between two doors.
    Wall,
    /// A desk.
    Desk,
    /// A table.
    Table,
    /// A chair.
    Chair,
    /// A cabinet or a shelf.
    Cabinet,
    /// Anything else that stands on the floor.
    Box,
    /// A sliding door: there while it is closed, in the wall while it is open.
    Leaf,
}

/// What a block is faced with: it decides from which angles sound and light come back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Surface {
    /// Paint, wood, cloth.
    #[default]
    Plain,
    /// Lacquer or metal: a mirror to sound from much steeper angles.
    Polished,
    /// As polished to sound; a camera sees it only now and then, and else what is behind it.
    Glass,
}

/// A room or a stretch of corridor: a rectangle of the floor with a name, for those who count rooms.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Room {
    /// Its name.
    pub name: String,
    /// Its edges, m.
    pub west: f64,
    /// m.
    pub south: f64,
    /// m.
    pub east: f64,
    /// m.
    pub north: f64,
}

impl Room {
    /// Whether (`x`, `y`) m lies in it.
    pub fn holds(&self, x: f64, y: f64) -> bool {
        (self.west..self.east).contains(&x) && (self.south..self.north).contains(&y)
    }
}

/// A solid rectangle on the floor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Block {
    /// What contacts with it are called; the pieces of one wall share a name.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// Centre, m.
    pub x: f64,
    /// Centre, m.
    pub y: f64,
    /// Size along its own x axis, m.
    pub width: f64,
    /// Size along its own y axis, m.
    pub depth: f64,
    /// Its own x axis, rad counter-clockwise from the x axis of the office.
    pub angle: f64,
    /// What it is faced with.
    pub surface: Surface,
}

/// A way point: somewhere a person may be headed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// Its name.
    pub name: String,
    /// m.
    pub x: f64,
    /// m.
    pub y: f64,
    /// Whether people choose it as a goal; a doorway is only passed through.
    pub goal: bool,
}

/// An opening in a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Door {
    /// Distance of the opening's middle from the start of the wall, m.
    pub at: f64,
    /// Width of the opening, m.
    pub width: f64,
}

/// A floor plan with its outer walls, its furniture and its way points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Layout {
    /// Its name.
    pub name: String,
    /// Inside, from the west wall to the east wall, m.
    pub width: f64,
    /// Inside, from the south wall to the north wall, m.
    pub height: f64,
    /// Where the robot starts unless told otherwise: x m, y m, heading rad.
    pub start: (f64, f64, f64),
    /// Everything solid.
    pub blocks: Vec<Block>,
    /// Way points. Two of them are joined whenever a person can walk straight from one to the other.
    pub places: Vec<Place>,
    /// Its rooms, in so far as they are told apart.
    pub rooms: Vec<Room>,
}

/// The texts of ten generated offices, seeds 1 to 10, kept as they were drawn: `layouts/kept`.
pub const KEPT: [&str; 10] = [
    include_str!("../layouts/kept/1.toml"),
    include_str!("../layouts/kept/2.toml"),
    include_str!("../layouts/kept/3.toml"),
    include_str!("../layouts/kept/4.toml"),
    include_str!("../layouts/kept/5.toml"),
    include_str!("../layouts/kept/6.toml"),
    include_str!("../layouts/kept/7.toml"),
    include_str!("../layouts/kept/8.toml"),
    include_str!("../layouts/kept/9.toml"),
    include_str!("../layouts/kept/10.toml"),
];

impl Layout {
    /// The standard office, 18 m by 12 m: a corridor with three rooms on either side, doors 1 m
    /// wide, desks, tables, chairs and cabinets. Its text is `layouts/office.toml`.
    pub fn office() -> Layout {
        match Layout::parse(include_str!("../layouts/office.toml")) {
            Ok(layout) => layout,
            Err(error) => panic!("the built-in office: {error}"),
        }
    }

    /// One of the [`KEPT`] offices, numbered from 1: what layers are built in.
    ///
    /// # Panics
    /// If there is none of that number.
    pub fn kept(number: usize) -> Layout {
        match Layout::parse(KEPT[number - 1]) {
            Ok(layout) => layout,
            Err(error) => panic!("kept office {number}: {error}"),
        }
    }

    /// The office that the generator draws from `seed`: what layers are measured in.
    pub fn generated(seed: u64) -> Layout {
        match Layout::parse(&crate::generate(seed)) {
            Ok(layout) => layout,
            Err(error) => panic!("generated office {seed}: {error}"),
        }
    }

    /// One room, `width` by `height` m inside, with nothing in it and the robot in the middle.
    pub fn empty_room(width: f64, height: f64) -> Layout {
        let mut layout = Layout::walled("empty room", width, height);
        layout.places.push(Place {
            name: "middle".into(),
            x: width / 2.0,
            y: height / 2.0,
            goal: true,
        });
        let (inset_x, inset_y) = ((width / 4.0).min(1.0), (height / 4.0).min(1.0));
        for (name, x, y) in [
            ("south-west", inset_x, inset_y),
            ("south-east", width - inset_x, inset_y),
            ("north-east", width - inset_x, height - inset_y),
            ("north-west", inset_x, height - inset_y),
        ] {
            layout.places.push(Place {
                name: name.into(),
                x,
                y,
                goal: true,
            });
        }
        layout
    }

    /// Four outer walls around an inside of `width` by `height` m, and no way points yet.
    ///
    /// # Panics
    /// If a side is not between 1 m and 200 m.
    pub fn walled(name: &str, width: f64, height: f64) -> Layout {
        for side in [width, height] {
            assert!(
                (1.0..=200.0).contains(&side),
                "an office side of {side} m is not within 1..=200 m"
            );
        }
        let start = (width / 2.0, height / 2.0, 0.0);
        let mut layout = Layout {
            name: name.into(),
            width,
            height,
            start,
            blocks: Vec::new(),
            places: Vec::new(),
            rooms: Vec::new(),
        };
        let half = WALL_THICKNESS_M / 2.0;
        let (west, east, south, north) = (-half, width + half, -half, height + half);
        layout.wall("south wall", (west - half, south), (east + half, south), &[]);
        layout.wall("east wall", (east, south + half), (east, north - half), &[]);
        layout.wall("north wall", (east + half, north), (west - half, north), &[]);
        layout.wall("west wall", (west, north - half), (west, south + half), &[]);
        layout
    }

    /// Adds a wall along the line `from`..`to` (m), open at the doors, which come in order of
    /// `at` and do not overlap.
    pub fn wall(&mut self, name: &str, from: (f64, f64), to: (f64, f64), doors: &[Door]) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = libm::sqrt(dx * dx + dy * dy);
        assert!(length > 0.0, "wall {name} has no length");
        let (ux, uy) = (dx / length, dy / length);
        let mut begin = 0.0;
        let ends = doors
            .iter()
            .map(|door| (door.at - door.width / 2.0, door.at + door.width / 2.0));
        for (end, resume) in ends.chain([(length, length)]) {
            if end > begin {
                let middle = (begin + end) / 2.0;
                self.blocks.push(Block {
                    name: name.into(),
                    kind: Kind::Wall,
                    x: from.0 + ux * middle,
                    y: from.1 + uy * middle,
                    width: end - begin,
                    depth: WALL_THICKNESS_M,
                    angle: libm::atan2(uy, ux),
                    surface: Surface::Plain,
                });
            }
            begin = resume;
        }
    }

    /// Adds a block of `size` (m) centred at `centre` (m), turned by `angle` rad.
    pub fn block(&mut self, name: &str, kind: Kind, centre: (f64, f64), size: (f64, f64), angle: f64) {
        self.blocks.push(Block {
            name: name.into(),
            kind,
            x: centre.0,
            y: centre.1,
            width: size.0,
            depth: size.1,
            angle,
            surface: Surface::Plain,
        });
    }
}
