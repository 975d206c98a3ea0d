//! Allen's ring of twelve ultrasonic range finders, with the ways in which such rings lie.
//!
//! Each transducer hears the nearest echo from its cone. The cone is sampled with seven rays; a ray
//! that meets a flat surface at too small an angle is reflected away like light from a mirror, and
//! is lost or, now and then, comes home by way of other surfaces and reads long. People and robots are
//! round and always answer. A corner in view within the cone answers too, as an edge does. All twelve
//! fire at once, so that one may take a neighbour's echo for its own.

use crate::discs::Disc;
use crate::layout::Surface;
use crate::noise::Noise;
use crate::plane::Vec2;
use crate::space::Space;
use core::f64::consts::TAU;

/// Transducers in the ring, 30 degrees apart (Brooks 1991, "Intelligence without representation", section 6.2).
pub const SONARS: usize = 12;
/// Rays that sample one cone: 5 degrees apart in a cone of 30.
const RAYS: usize = 7;
/// A hair's breadth, m, that keeps a reflected ray off the surface that it leaves, and a corner in
/// sight of its own faces.
const HAIR_M: f64 = 0.002;

/// How well the ring measures: every way in which it lies is a figure that can be set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarModel {
    /// Nearest range that can be told, m; anything nearer reads this. 6 inches: data sheet of the Polaroid
    /// 6500 ranging module.
    pub range_min_m: f64,
    /// Farthest range, m; also the reading when no echo returns. 35 feet: the same data sheet.
    pub range_max_m: f64,
    /// Error of a reading, one sigma, m. The data sheet gives about 1 percent; this is that at two metres.
    pub noise_m: f64,
    /// Probability that a reading is lost whatever is there, and shows the farthest range. That echoes
    /// drop out is in Brooks 1991, section 6.2 ("sonar is extremely noisy"); the figure is our choice.
    pub dropout: f64,
    /// A plain flat surface met at less than this angle between ray and surface reflects the sound away,
    /// degrees. Thirty: Brooks 1991, section 6.2.
    pub specular_deg: f64,
    /// The same angle for polished surfaces and glass, degrees. That smooth walls answer only near the
    /// perpendicular is in Leonard and Durrant-Whyte, "Directed sonar sensing for mobile robot
    /// navigation", 1992; the figure is our choice.
    pub polished_deg: f64,
    /// Probability that sound reflected away is heard after all by way of other surfaces: a ghost,
    /// farther than the thing itself. Return paths by several reflections: Brooks 1991, section 6.2;
    /// the figure is our choice.
    pub ghosts: f64,
    /// Most reflections on a way home; one bounce more and the echo is too faint. Our choice.
    pub bounces: u32,
    /// Probability that a transducer takes a neighbour's echo for its own, when that comes first. Rings
    /// that fire together: Borenstein and Koren, "Error eliminating rapid ultrasonic firing for mobile
    /// robot obstacle avoidance", 1995; the figure is our choice.
    pub cross_talk: f64,
    /// Full width of the cone, degrees: the main lobe of the Polaroid transducer, from the data sheet.
    pub cone_deg: f64,
    /// What is this near is heard by the side lobes as well, m. The data sheet's pattern shows lobes beside
    /// the main one some 15 dB down, enough for what is close by; the distance is our choice.
    pub lobe_m: f64,
    /// How far off the axis the side lobes reach, degrees: from the same pattern.
    pub lobe_deg: f64,
    /// Transducers that are dead, one bit each; a dead one always reads the farthest range.
    pub dead: u16,
}

impl Default for SonarModel {
    fn default() -> Self {
        SonarModel {
            range_min_m: 0.15,
            range_max_m: 10.67,
            noise_m: 0.02,
            dropout: 0.01,
            specular_deg: 30.0,
            polished_deg: 55.0,
            ghosts: 0.3,
            bounces: 3,
            cross_talk: 0.01,
            cone_deg: 30.0,
            lobe_m: 0.4,
            lobe_deg: 40.0,
            dead: 0,
        }
    }
}

impl SonarModel {
    /// A ring with no noise, no dropouts, no ghosts and no cross-talk; flat surfaces still reflect.
    pub fn perfect() -> Self {
        SonarModel {
            range_min_m: 0.0,
            noise_m: 0.0,
            dropout: 0.0,
            ghosts: 0.0,
            cross_talk: 0.0,
            lobe_m: 0.0,
            ..SonarModel::default()
        }
    }
}

/// What the sound travels through.
pub(crate) struct Air<'a> {
    pub(crate) model: &'a SonarModel,
    pub(crate) space: &'a Space,
    /// Everybody, robots first.
    pub(crate) discs: &'a [Disc],
    /// Which of them listens and is not heard.
    pub(crate) own: usize,
}

enum Echo {
    /// The sound came back after this many m.
    Heard(f64),
    /// It left the surface at `at` in direction `onward`, after `gone` m.
    Reflected {
        at: Vec2,
        onward: Vec2,
        gone: f64,
    },
    Nothing,
}

impl Air<'_> {
    /// All twelve readings, m from the robot's rim. Every reading draws the same number of random
    /// values, so that what one transducer sees never changes what another draws.
    pub(crate) fn ring(&self, robot: Disc, heading: f64, noise: &mut Noise) -> [f64; SONARS] {
        let mut crossed = [false; SONARS];
        let mut heard: [f64; SONARS] = core::array::from_fn(|i| {
            let axis = heading + TAU * i as f64 / SONARS as f64;
            let ghost = noise.unit() < self.model.ghosts;
            let lost = noise.unit() < self.model.dropout;
            crossed[i] = noise.unit() < self.model.cross_talk;
            let error = self.model.noise_m * noise.gauss();
            let from = robot.at + Vec2::at_angle(axis) * robot.radius;
            let dead = self.model.dead >> i & 1 == 1;
            match self.reading(from, axis, ghost) {
                Some(range) if !lost && !dead => {
                    (range + error).clamp(self.model.range_min_m, self.model.range_max_m)
                }
                _ => self.model.range_max_m,
            }
        });
        let own = heard;
        for i in (0..SONARS).filter(|&i| crossed[i] && self.model.dead >> i & 1 == 0) {
            heard[i] = own[i]
                .min(own[(i + 1) % SONARS])
                .min(own[(i + SONARS - 1) % SONARS]);
        }
        heard
    }

    /// The nearest echo, m, if there is one within range.
    fn reading(&self, from: Vec2, axis: f64, ghost: bool) -> Option<f64> {
        let reach = self.model.range_max_m;
        let cone = self.model.cone_deg.to_radians();
        let mut nearest = f64::INFINITY;
        for i in 0..RAYS {
            let angle = axis + cone * (i as f64 / (RAYS - 1) as f64 - 0.5);
            let mut echo = self.cast(from, Vec2::at_angle(angle), reach);
            for _ in 0..self.model.bounces {
                let (true, Echo::Reflected { at, onward, gone }) = (ghost, &echo) else {
                    break;
                };
                let (at, onward, gone) = (*at + *onward * HAIR_M, *onward, *gone);
                echo = match self.cast(at, onward, reach - gone) {
                    Echo::Heard(more) => Echo::Heard(gone + more),
                    Echo::Reflected {
                        at,
                        onward,
                        gone: more,
                    } => Echo::Reflected {
                        at,
                        onward,
                        gone: gone + more,
                    },
                    Echo::Nothing => Echo::Nothing,
                };
            }
            if let Echo::Heard(distance) = echo {
                nearest = nearest.min(distance);
            }
        }
        let ahead = Vec2::at_angle(axis);
        if self.model.lobe_m > 0.0 {
            let lobe = self.model.lobe_deg.to_radians();
            for angle in [axis - lobe, axis + lobe] {
                if let Echo::Heard(distance) = self.cast(from, Vec2::at_angle(angle), self.model.lobe_m) {
                    nearest = nearest.min(distance);
                }
            }
            let within = nearest.min(self.model.lobe_m);
            if let Some(corner) = self.nearest_corner(from, ahead, libm::cos(lobe), within) {
                nearest = corner;
            }
        }
        self.nearest_corner(from, ahead, libm::cos(cone / 2.0), nearest.min(reach))
            .or((nearest <= reach).then_some(nearest))
    }

    /// What becomes of the sound along one ray.
    fn cast(&self, from: Vec2, direction: Vec2, reach: f64) -> Echo {
        let wall = self.space.ray(from, direction, reach);
        let person = self.disc(from, direction);
        let wall_at = wall.as_ref().map_or(f64::INFINITY, |hit| hit.distance);
        if person < wall_at {
            return if person <= reach {
                Echo::Heard(person)
            } else {
                Echo::Nothing
            };
        }
        let Some(hit) = wall else { return Echo::Nothing };
        let facing = direction.dot(hit.normal);
        let mirror_deg = match hit.surface {
            Surface::Plain => self.model.specular_deg,
            Surface::Polished | Surface::Glass => self.model.polished_deg,
        };
        if libm::fabs(facing) >= libm::sin(mirror_deg.to_radians()) {
            return Echo::Heard(hit.distance);
        }
        let onward = direction - hit.normal * (2.0 * facing);
        Echo::Reflected {
            at: from + direction * hit.distance,
            onward,
            gone: hit.distance,
        }
    }

    /// m to the nearest disc on the ray, a person or another robot.
    pub(crate) fn disc(&self, from: Vec2, direction: Vec2) -> f64 {
        let mut nearest = f64::INFINITY;
        for (_, disc) in self.discs.iter().enumerate().filter(|(i, _)| *i != self.own) {
            let to = disc.at - from;
            let (along, across) = (to.dot(direction), to.dot(direction.left()));
            let inside = disc.radius * disc.radius - across * across;
            if inside >= 0.0 && along > 0.0 {
                nearest = nearest.min((along - libm::sqrt(inside)).max(0.0));
            }
        }
        nearest
    }

    /// m to the nearest corner in sight within the cone and nearer than `within`.
    fn nearest_corner(&self, from: Vec2, axis: Vec2, cos_half_cone: f64, within: f64) -> Option<f64> {
        let mut nearest = within;
        let mut found = None;
        for &corner in self.space.corners() {
            let to = corner - from;
            // The square spares most corners the root.
            if to.dot(to) >= nearest * nearest {
                continue;
            }
            let distance = to.length();
            if distance >= nearest || to.dot(axis) < distance * cos_half_cone || distance < HAIR_M {
                continue;
            }
            let direction = to * (1.0 / distance);
            let hidden = self.space.ray(from, direction, distance - HAIR_M).is_some()
                || self.disc(from, direction) < distance;
            if !hidden {
                nearest = distance;
                found = Some(distance);
            }
        }
        found
    }
}
