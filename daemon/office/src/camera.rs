//! The range camera: a fan of twelve free distances over sixty degrees, for a free-space finder.
//!
//! What a stereo pair gives after matching, one distance for each strip of the picture. It sees walls at
//! any angle, where sonar is blind, and misses glass, where sonar is not.

use crate::discs::Disc;
use crate::layout::Surface;
use crate::noise::Noise;
use crate::plane::{Vec2, wrapped};
use crate::sonar::Air;

/// Strips of the picture, left to right.
pub const STRIPS: usize = 12;
/// Rays that look into one strip.
const RAYS: usize = 2;
/// Panes looked through before the sight is taken for blocked: two glass walls of one room.
const PANES_MAX: usize = 3;
/// What keeps a ray off the pane that it leaves, m: more than a pane is thick.
const PANE_M: f64 = 0.12;

/// How well the camera measures. That a stereo pair's error grows with the square of the distance is plain
/// triangulation; the figures are our choice, of the size of a 10 cm base line and a picture 500 wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraModel {
    /// Width of the whole fan, degrees.
    pub fan_deg: f64,
    /// Farthest distance that can be told, m; also the reading where nothing is seen.
    pub range_max_m: f64,
    /// Error of a distance at one metre, one sigma, m; it grows with the square of the distance.
    pub noise_m: f64,
    /// Probability that a strip finds no match (a bare wall) and reads the distance of its neighbour.
    pub unmatched: f64,
    /// Probability that a pane of glass is seen.
    pub glass_seen: f64,
}

impl Default for CameraModel {
    fn default() -> Self {
        CameraModel {
            fan_deg: 60.0,
            range_max_m: 10.0,
            noise_m: 0.004,
            unmatched: 0.03,
            glass_seen: 0.6,
        }
    }
}

impl CameraModel {
    /// Bearing of strip `index`, rad counter-clockwise from straight ahead; the first is the leftmost.
    pub fn bearing(&self, index: usize) -> f64 {
        let fan = self.fan_deg.to_radians();
        wrapped(fan / 2.0 - fan * (index as f64 + 0.5) / STRIPS as f64)
    }
}

/// Twelve free distances, m from the robot's middle, leftmost first.
pub(crate) fn fan(
    air: &Air<'_>,
    model: &CameraModel,
    robot: Disc,
    heading: f64,
    noise: &mut Noise,
) -> [f64; STRIPS] {
    let strip = model.fan_deg.to_radians() / STRIPS as f64;
    let mut distances = [0.0; STRIPS];
    for index in 0..STRIPS {
        let unmatched = noise.unit() < model.unmatched;
        let seen = noise.unit() < model.glass_seen;
        let error = noise.gauss();
        let mut nearest = model.range_max_m;
        for ray in 0..RAYS {
            let off = strip * ((ray as f64 + 0.5) / RAYS as f64 - 0.5);
            let direction = Vec2::at_angle(heading + model.bearing(index) + off);
            nearest = nearest.min(sight(air, robot.at, direction, model.range_max_m, seen));
        }
        let told = nearest + error * model.noise_m * nearest * nearest;
        distances[index] = if unmatched && index > 0 {
            distances[index - 1]
        } else {
            told.clamp(0.0, model.range_max_m)
        };
    }
    distances
}

/// m to what is seen along one ray.
fn sight(air: &Air<'_>, from: Vec2, direction: Vec2, reach: f64, glass_seen: bool) -> f64 {
    let disc = air.disc(from, direction);
    let mut gone = 0.0;
    for _ in 0..PANES_MAX {
        let Some(hit) = air.space.ray(from + direction * gone, direction, reach - gone) else {
            return disc.min(reach);
        };
        let at = gone + hit.distance;
        if glass_seen || hit.surface != Surface::Glass || disc < at {
            return disc.min(at);
        }
        gone = at + PANE_M;
    }
    disc.min(gone).min(reach)
}
