//! What stands about in a generated office: never on a way of the people, but near enough to narrow it.

use super::plan::{Piece, Plan, Rect, Room};
use crate::layout::Surface;
use crate::noise::Noise;
use crate::plane::{Vec2, vec2};

/// Left free on either side of a way through a room, m.
const WAY_M: f64 = 0.55;
/// Left free around the middle of a room, where groups stand, m.
const MIDDLE_M: f64 = 0.85;
/// Half of a wall's thickness and a finger, m.
const OFF_WALL_M: f64 = 0.07;
/// Draws for one piece.
const DRAWS_MAX: usize = 12;

/// Fills rooms and corridors.
pub(crate) fn furnish(plan: &mut Plan, noise: &mut Noise) {
    let mut pieces = Vec::new();
    for room in &plan.rooms {
        let desks = 1 + noise.below(3);
        for _ in 0..desks {
            desk(room, &mut pieces, noise);
        }
        for _ in 0..1 + noise.below(2) {
            let surface = if noise.unit() < 0.3 {
                Surface::Polished
            } else {
                Surface::Plain
            };
            let size = (noise.between(0.7, 1.2), noise.between(0.35, 0.5));
            by_the_wall(room, "cabinet", size, surface, &mut pieces, noise);
        }
        if noise.unit() < 0.5 {
            anywhere(room, "table", (1.2, 0.8), &mut pieces, noise);
        }
        for _ in 0..1 + noise.below(2) {
            anywhere(room, "chair", (0.45, 0.45), &mut pieces, noise);
        }
        if noise.unit() < 0.3 {
            screens(room, &mut pieces, noise);
        }
    }
    for corridor in &plan.corridors {
        for _ in 0..noise.below(3) {
            let size = (noise.between(0.4, 0.9), noise.between(0.3, 0.4));
            by_the_wall(corridor, "box", size, Surface::Plain, &mut pieces, noise);
        }
    }
    plan.pieces = pieces;
}

/// A desk at a wall with a chair before it.
fn desk(room: &Room, pieces: &mut Vec<Piece>, noise: &mut Noise) {
    let size = (noise.between(1.2, 1.6), noise.between(0.6, 0.8));
    let Some(inward) = by_the_wall(room, "desk", size, Surface::Plain, pieces, noise) else {
        return;
    };
    let at = pieces[pieces.len() - 1].at + inward * (size.1 / 2.0 + 0.35);
    let chair = Piece {
        kind: "chair",
        at,
        size: (0.45, 0.45),
        turned: noise.between(0.0, 90.0),
        surface: Surface::Plain,
    };
    if fits(room, &chair, pieces) {
        pieces.push(chair);
    }
}

/// Puts a piece against a wall; says which way is into the room.
fn by_the_wall(
    room: &Room,
    kind: &'static str,
    size: (f64, f64),
    surface: Surface,
    pieces: &mut Vec<Piece>,
    noise: &mut Noise,
) -> Option<Vec2> {
    let (west, south, east, north) = room.rect;
    for _ in 0..DRAWS_MAX {
        let off = OFF_WALL_M + size.1 / 2.0;
        let along_x = noise.between(west + size.0 / 2.0 + 0.1, east - size.0 / 2.0 - 0.1);
        let along_y = noise.between(south + size.0 / 2.0 + 0.1, north - size.0 / 2.0 - 0.1);
        let (at, inward, turned) = match noise.below(4) {
            0 => (vec2(along_x, south + off), vec2(0.0, 1.0), 0.0),
            1 => (vec2(along_x, north - off), vec2(0.0, -1.0), 0.0),
            2 => (vec2(west + off, along_y), vec2(1.0, 0.0), 90.0),
            _ => (vec2(east - off, along_y), vec2(-1.0, 0.0), 90.0),
        };
        let piece = Piece {
            kind,
            at,
            size,
            turned,
            surface,
        };
        if fits(room, &piece, pieces) {
            pieces.push(piece);
            return Some(inward);
        }
    }
    None
}

/// Puts a piece somewhere on the floor, at any angle.
fn anywhere(room: &Room, kind: &'static str, size: (f64, f64), pieces: &mut Vec<Piece>, noise: &mut Noise) {
    for _ in 0..DRAWS_MAX {
        let piece = Piece {
            kind,
            at: somewhere(room.rect, libm::hypot(size.0, size.1) / 2.0 + 0.1, noise),
            size,
            turned: noise.between(0.0, 180.0),
            surface: Surface::Plain,
        };
        if fits(room, &piece, pieces) {
            pieces.push(piece);
            return;
        }
    }
}

/// Two screens in line with a gap that is too narrow to be sure of.
fn screens(room: &Room, pieces: &mut Vec<Piece>, noise: &mut Noise) {
    for _ in 0..DRAWS_MAX {
        let (gap, at) = (noise.between(0.55, 0.85), somewhere(room.rect, 1.2, noise));
        let turned = noise.between(0.0, 180.0);
        let way = Vec2::at_angle(turned.to_radians());
        let pair = [1.0, -1.0].map(|side| Piece {
            kind: "box",
            at: at + way * (side * (gap / 2.0 + 0.35)),
            size: (0.7, 0.06),
            turned,
            surface: Surface::Plain,
        });
        if pair.iter().all(|piece| fits(room, piece, pieces)) {
            pieces.extend(pair);
            return;
        }
    }
}

fn somewhere((west, south, east, north): Rect, from_wall: f64, noise: &mut Noise) -> Vec2 {
    let between = |low: f64, high: f64, noise: &mut Noise| {
        let draw = noise.unit();
        if low < high {
            low + (high - low) * draw
        } else {
            (low + high) / 2.0
        }
    };
    let x = between(west + from_wall, east - from_wall, noise);
    vec2(x, between(south + from_wall, north - from_wall, noise))
}

/// Whether a piece leaves the ways free and stands on nothing else.
fn fits(room: &Room, piece: &Piece, pieces: &[Piece]) -> bool {
    let (west, south, east, north) = room.rect;
    let corners = corners(piece);
    let inside =
        |c: &Vec2| c.x > west + 0.06 && c.x < east - 0.06 && c.y > south + 0.06 && c.y < north - 0.06;
    if !corners.iter().all(inside) {
        return false;
    }
    let middle = room.middle();
    // In a corridor the way runs along it; its middle is no meeting place.
    let corridor = room.name.starts_with("corridor");
    let spread = if corridor { 0.3 } else { MIDDLE_M };
    let mut ways: Vec<(Vec2, Vec2, f64)> = vec![(middle, middle, spread)];
    if corridor {
        let long = if east - west > north - south {
            vec2(east - west, 0.0)
        } else {
            vec2(0.0, north - south)
        };
        ways.push((middle - long * 0.5, middle + long * 0.5, 0.3));
        ways.extend(room.doors.iter().map(|door| (*door, *door, 1.0)));
    } else {
        ways.extend(room.doors.iter().map(|door| (*door, middle, WAY_M)));
        ways.extend(room.doors.iter().map(|door| (*door, *door, 0.8)));
    }
    let free = ways.iter().all(|(from, to, room)| {
        (0..=16).all(|i| to_piece(*from + (*to - *from) * (f64::from(i) / 16.0), piece) > *room)
    });
    // No two overlap: neither has a corner or an edge's middle within a finger of the other.
    let apart = |other: &Piece| {
        let mine = outline(&corners).all(|c| to_piece(c, other) > 0.03);
        mine && outline(&self::corners(other)).all(|c| to_piece(c, piece) > 0.03)
    };
    free && pieces.iter().all(apart)
}

/// Corners and points between them.
fn outline(corners: &[Vec2; 4]) -> impl Iterator<Item = Vec2> {
    let corners = *corners;
    (0..16).map(move |i| {
        let (from, to) = (corners[i / 4], corners[(i / 4 + 1) % 4]);
        from + (to - from) * ((i % 4) as f64 / 4.0)
    })
}

fn corners(piece: &Piece) -> [Vec2; 4] {
    let along = Vec2::at_angle(piece.turned.to_radians());
    let (u, v) = (along * (piece.size.0 / 2.0), along.left() * (piece.size.1 / 2.0));
    [
        piece.at + u + v,
        piece.at - u + v,
        piece.at - u - v,
        piece.at + u - v,
    ]
}

/// m from a point to a piece.
fn to_piece(at: Vec2, piece: &Piece) -> f64 {
    let (along, to) = (Vec2::at_angle(piece.turned.to_radians()), at - piece.at);
    let x = (libm::fabs(to.dot(along)) - piece.size.0 / 2.0).max(0.0);
    let y = (libm::fabs(to.dot(along.left())) - piece.size.1 / 2.0).max(0.0);
    libm::hypot(x, y)
}
