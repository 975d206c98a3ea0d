//! A drawing: everything with its place, in units of CSS pixels, y downward.
//!
//! Must never know how it is written down: that is `svg`'s work.

use ipc::wiring::creature::How;

/// A point, in pixels.
pub type At = (f64, f64);

/// Radius of a tap's circle, in pixels.
pub const RADIUS: f64 = 9.0;

/// A picture with every place decided.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The creature's name.
    pub name: String,
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
    /// Layers, highest level first.
    pub bands: Vec<Strip>,
    /// Modules and the body's ends.
    pub boxes: Vec<Frame>,
    /// Wires.
    pub wires: Vec<Wire>,
    /// Pieces of line into inputs that only taps reach.
    pub stubs: Vec<[At; 2]>,
    /// Circles.
    pub taps: Vec<Circle>,
    /// Reset lines' circles.
    pub resets: Vec<At>,
    /// What is wrong with parts that stand nowhere in the picture.
    pub faults: Vec<String>,
}

/// A layer's band.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// The layer's name.
    pub name: String,
    /// Its level.
    pub level: u8,
    /// Its process, if it has one of its own.
    pub process: Option<String>,
    /// Upper edge.
    pub top: f64,
    /// Lower edge.
    pub bottom: f64,
}

/// What a box stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A module.
    Module,
    /// A sensor of the body.
    Sensor,
    /// An actuator of the body.
    Actuator,
}

/// A box.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The module's name, or the port of the body.
    pub name: String,
    /// The kind of module.
    pub kind: String,
    /// What it stands for.
    pub shape: Shape,
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
    /// Names of its inputs and the heights at which they stand.
    pub inputs: Vec<(String, f64)>,
    /// What is wrong with it.
    pub fault: Option<String>,
}

/// A wire with its branches.
#[derive(Clone, Debug, PartialEq)]
pub struct Wire {
    /// `module.port`.
    pub name: String,
    /// Its label and the label's left lower corner; none at the body.
    pub label: Option<(String, At)>,
    /// Lines to its ends. An output that only taps act on has one that leads nowhere.
    pub branches: Vec<Line>,
    /// Where branches leave others.
    pub joints: Vec<At>,
}

/// A line to one end.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The port it leads to; empty if it leads nowhere.
    pub to: String,
    /// Corners, from the output or a joint to the end.
    pub points: Vec<At>,
    /// Which way it acts, if it is a tap.
    pub tap: Option<How>,
    /// What is wrong with it.
    pub fault: Option<String>,
}

/// A tap's circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Circle {
    /// Where its messages come from.
    pub from: String,
    /// The port it acts on.
    pub to: String,
    /// Which way it acts.
    pub how: How,
    /// Its middle.
    pub at: At,
    /// Its time constant as it is written beside it.
    pub constant: String,
    /// What is wrong with it.
    pub fault: Option<String>,
}
