//! Walls, doors and rooms of a generated office, before anything is put into it.

use crate::layout::Surface;
use crate::noise::Noise;
use crate::plane::{Vec2, vec2};

/// A rectangle: west, south, east, north, m.
pub(crate) type Rect = (f64, f64, f64, f64);

/// A wall with its openings.
pub(crate) struct Wall {
    pub(crate) name: String,
    pub(crate) from: Vec2,
    pub(crate) to: Vec2,
    /// Middle from the wall's start, and width, m; sorted before it is written.
    pub(crate) doors: Vec<(f64, f64)>,
    pub(crate) surface: Surface,
}

/// A sliding door.
pub(crate) struct Leaf {
    pub(crate) at: Vec2,
    pub(crate) width: f64,
    /// Whether it runs along the y axis.
    pub(crate) upright: bool,
}

/// A room with the points just inside its doors.
pub(crate) struct Room {
    pub(crate) name: String,
    pub(crate) rect: Rect,
    pub(crate) doors: Vec<Vec2>,
}

/// A piece of furniture, turned in degrees.
pub(crate) struct Piece {
    pub(crate) kind: &'static str,
    pub(crate) at: Vec2,
    pub(crate) size: (f64, f64),
    pub(crate) turned: f64,
    pub(crate) surface: Surface,
}

/// A whole office.
pub(crate) struct Plan {
    pub(crate) size: (f64, f64),
    pub(crate) start: (Vec2, f64),
    pub(crate) walls: Vec<Wall>,
    pub(crate) leaves: Vec<Leaf>,
    /// The rooms proper.
    pub(crate) rooms: Vec<Room>,
    /// The four stretches of corridor; their doors are the points before the rooms' doors.
    pub(crate) corridors: Vec<Room>,
    /// Way points, with whether people choose them as goals.
    pub(crate) places: Vec<(Vec2, bool)>,
    pub(crate) pieces: Vec<Piece>,
}

impl Room {
    pub(crate) fn middle(&self) -> Vec2 {
        let (west, south, east, north) = self.rect;
        vec2((west + east) / 2.0, (south + north) / 2.0)
    }
}

/// How far before and behind a door's middle its way points stand, m.
const BEFORE_M: f64 = 0.65;
/// From a door's middle to the end of its wall, at least, m.
const FROM_END_M: f64 = 1.0;

/// Draws walls, doors, rooms and way points.
pub(crate) fn draw(noise: &mut Noise) -> Plan {
    let (width, height) = (noise.between(20.0, 24.0), noise.between(15.6, 17.6));
    // Depth of the rooms along the sides, width of the corridor.
    let (depth, lane) = (noise.between(4.0, 4.5), noise.between(1.9, 2.4));
    let mut plan = Plan {
        size: (width, height),
        start: (vec2(0.0, 0.0), noise.between(-180.0, 180.0)),
        walls: Vec::new(),
        leaves: Vec::new(),
        rooms: Vec::new(),
        corridors: Vec::new(),
        places: Vec::new(),
        pieces: Vec::new(),
    };
    let ring = (depth, depth, width - depth, height - depth);
    let core = (ring.0 + lane, ring.1 + lane, ring.2 - lane, ring.3 - lane);
    corridors(&mut plan, ring, core);
    strip(&mut plan, "south", ring, (0.0, 0.0, width, depth), noise);
    strip(&mut plan, "north", ring, (0.0, ring.3, width, height), noise);
    side(&mut plan, "west", (0.0, ring.1, ring.0, ring.3), ring.0, noise);
    side(&mut plan, "east", (ring.2, ring.1, width, ring.3), ring.2, noise);
    inner(&mut plan, core, noise);
    for room in &plan.rooms {
        plan.places.push((room.middle(), true));
    }
    let chosen = noise.below(plan.rooms.len());
    plan.start.0 = plan.rooms[chosen].middle();
    plan
}

fn corridors(plan: &mut Plan, ring: Rect, core: Rect) {
    let (west, south, east, north) = ring;
    for (name, rect) in [
        ("corridor south", (west, south, east, core.1)),
        ("corridor north", (west, core.3, east, north)),
        ("corridor west", (west, core.1, core.0, core.3)),
        ("corridor east", (core.2, core.1, east, core.3)),
    ] {
        let room = Room {
            name: name.into(),
            rect,
            doors: Vec::new(),
        };
        plan.places.push((room.middle(), true));
        plan.corridors.push(room);
    }
    let (x, y) = (
        [(west + core.0) / 2.0, (core.2 + east) / 2.0],
        [(south + core.1) / 2.0, (core.3 + north) / 2.0],
    );
    for (x, y) in [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])] {
        plan.places.push((vec2(x, y), false));
    }
}

/// What a wall is faced with.
fn facing(noise: &mut Noise, polished: f64, glass: f64) -> Surface {
    let draw = noise.unit();
    if draw < polished {
        Surface::Polished
    } else if draw < polished + glass {
        Surface::Glass
    } else {
        Surface::Plain
    }
}

/// Width of a door, m: mostly as an office has them, now and then too narrow to be sure of.
fn door_width(noise: &mut Noise) -> f64 {
    if noise.unit() < 0.1 {
        noise.between(0.8, 0.95)
    } else {
        noise.between(1.05, 1.5)
    }
}

/// Opens `wall` at `along` m from its start between two rooms, with way points and perhaps a leaf.
fn open(plan: &mut Plan, wall: usize, along: f64, rooms: [usize; 2], noise: &mut Noise) {
    let width = door_width(noise);
    let Wall { from, to, .. } = plan.walls[wall];
    let way = (to - from).unit();
    let at = from + way * along;
    plan.walls[wall].doors.push((along, width));
    if noise.unit() < 0.6 {
        let upright = way.y.abs() > way.x.abs();
        plan.leaves.push(Leaf { at, width, upright });
    }
    plan.places.push((at, false));
    let corridors = plan.corridors.len();
    for room in rooms {
        let room = if room < corridors {
            &mut plan.corridors[room]
        } else {
            &mut plan.rooms[room - corridors]
        };
        let side = if (room.middle() - at).dot(way.left()) > 0.0 {
            way.left()
        } else {
            way.left() * -1.0
        };
        let inside = at + side * BEFORE_M;
        room.doors.push(inside);
        plan.places.push((inside, false));
    }
}

/// Rooms side by side along the south or north side of the building.
fn strip(plan: &mut Plan, name: &str, ring: Rect, rect: Rect, noise: &mut Noise) {
    let (west, south, east, north) = rect;
    let corridor = usize::from(name == "north");
    let count = 3 + noise.below(2);
    // Every room needs a stretch of corridor to open on.
    let (first, last) = (ring.0 + 2.4, ring.2 - 2.4);
    let step = (last - first) / (count - 2) as f64;
    let mut edges = vec![west];
    edges.extend((0..count - 1).map(|i| first + step * i as f64 + noise.between(-0.2, 0.2)));
    edges.push(east);
    let y = if corridor == 1 { south } else { north };
    plan.walls.push(Wall {
        name: format!("{name} corridor wall"),
        from: vec2(west, y),
        to: vec2(east, y),
        doors: Vec::new(),
        surface: facing(noise, 0.25, 0.0),
    });
    let long = plan.walls.len() - 1;
    let corridors = plan.corridors.len();
    for (i, pair) in edges.windows(2).enumerate() {
        let this = corridors + plan.rooms.len();
        plan.rooms.push(Room {
            name: format!("{name} room {}", i + 1),
            rect: (pair[0], south, pair[1], north),
            doors: Vec::new(),
        });
        let (low, high) = (pair[0].max(ring.0) + FROM_END_M, pair[1].min(ring.2) - FROM_END_M);
        let along = noise.between(low, high);
        open(plan, long, along, [this, corridor], noise);
        if i > 0 {
            plan.walls.push(Wall {
                name: format!("{name} wall {i}"),
                from: vec2(pair[0], south),
                to: vec2(pair[0], north),
                doors: Vec::new(),
                surface: facing(noise, 0.1, 0.15),
            });
            if noise.unit() < 0.35 {
                let wall = plan.walls.len() - 1;
                let along = noise.between(FROM_END_M + 0.3, north - south - FROM_END_M - 0.3);
                open(plan, wall, along, [this, this - 1], noise);
            }
        }
    }
}

/// The one room at the west or the east side.
fn side(plan: &mut Plan, name: &str, rect: Rect, x: f64, noise: &mut Noise) {
    let corridor = if name == "west" { 2 } else { 3 };
    plan.walls.push(Wall {
        name: format!("{name} corridor wall"),
        from: vec2(x, rect.1),
        to: vec2(x, rect.3),
        doors: Vec::new(),
        surface: facing(noise, 0.2, 0.2),
    });
    let (wall, this) = (plan.walls.len() - 1, plan.corridors.len() + plan.rooms.len());
    plan.rooms.push(Room {
        name: format!("{name} room"),
        rect,
        doors: Vec::new(),
    });
    let span = rect.3 - rect.1;
    // Where the corridor passes straight by, not at its corners.
    let along = noise.between(span * 0.35, span * 0.65);
    open(plan, wall, along, [this, corridor], noise);
}

/// The rooms within the ring.
fn inner(plan: &mut Plan, core: Rect, noise: &mut Noise) {
    let (west, south, east, north) = core;
    let corners = [(west, south), (east, south), (east, north), (west, north)];
    let first = plan.walls.len();
    for (i, name) in ["south", "east", "north", "west"].iter().enumerate() {
        let ((x0, y0), (x1, y1)) = (corners[i], corners[(i + 1) % 4]);
        plan.walls.push(Wall {
            name: format!("core wall {name}"),
            from: vec2(x0, y0),
            to: vec2(x1, y1),
            doors: Vec::new(),
            surface: facing(noise, 0.2, 0.3),
        });
    }
    let count = if east - west > 8.4 { 3 } else { 2 };
    let each = (east - west) / f64::from(count);
    for i in 0..count {
        let this = plan.corridors.len() + plan.rooms.len();
        let (low, high) = (west + each * f64::from(i), west + each * f64::from(i + 1));
        plan.rooms.push(Room {
            name: format!("core room {}", i + 1),
            rect: (low, south, high, north),
            doors: Vec::new(),
        });
        // South or north; the walls run counter-clockwise.
        let at = noise.between(low + FROM_END_M, high - FROM_END_M);
        if noise.unit() < 0.5 {
            open(plan, first, at - west, [this, 0], noise);
        } else {
            open(plan, first + 2, east - at, [this, 1], noise);
        }
        if i > 0 {
            plan.walls.push(Wall {
                name: format!("core partition {i}"),
                from: vec2(low, south),
                to: vec2(low, north),
                doors: Vec::new(),
                surface: facing(noise, 0.1, 0.3),
            });
        }
    }
}
