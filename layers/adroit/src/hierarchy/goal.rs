//! Goal parameters: what a goal selection mechanism found and hands down.

use serde::Serialize;

/// Goal parameters, a plain value handed from an RM to what it controls (source: *Goal selection mechanism
/// operation*). The hierarchy copies it and never looks inside; its meaning belongs to the body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Goal {
    /// The goal object; zero when the goal is no object.
    pub thing: u32,
    /// Place of the goal, metres.
    pub x_m: f64,
    /// Place of the goal, metres.
    pub y_m: f64,
    /// What else the body needs: a direction in radians, a length in metres.
    pub value: f64,
}

impl Goal {
    /// No goal: what the top level is given.
    pub const NONE: Self = Self {
        thing: 0,
        x_m: 0.0,
        y_m: 0.0,
        value: 0.0,
    };

    /// A goal at a place, in metres.
    #[must_use]
    pub const fn at(x_m: f64, y_m: f64) -> Self {
        Self {
            thing: 0,
            x_m,
            y_m,
            value: 0.0,
        }
    }

    /// A goal object at a place, in metres.
    #[must_use]
    pub const fn object(thing: u32, x_m: f64, y_m: f64) -> Self {
        Self {
            thing,
            x_m,
            y_m,
            value: 0.0,
        }
    }

    /// The same goal with another value.
    #[must_use]
    pub const fn with_value(self, value: f64) -> Self {
        Self { value, ..self }
    }
}
