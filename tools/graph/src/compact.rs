//! From lines that are counted to lengths: what nobody uses takes no room.
//!
//! First all that has a place from left to right, then, with those places known, from top to bottom. Must never
//! change the order in which lines lie, for that is what keeps wires apart.

use std::collections::HashMap;

use crate::drawing::RADIUS;
use crate::maze::Point;
use crate::measure::width;
use crate::model::{Model, Node, Port};
use crate::pieces::Path;
use crate::place::{Place, Places};

/// Sizes of text in pixels: names of modules, ports, wires and time constants.
pub(crate) const NAME: f64 = 13.0;
/// See [`NAME`].
pub(crate) const PORT: f64 = 10.0;
/// See [`NAME`].
pub(crate) const LABEL: f64 = 10.5;
/// See [`NAME`].
pub(crate) const CONSTANT: f64 = 9.5;
/// From a box's upper edge to its first port, and from its last port to its lower edge.
pub(crate) const HEAD: f64 = 32.0;
/// See [`HEAD`].
pub(crate) const FOOT: f64 = 11.0;
/// Half the height of a sensor or an actuator.
pub(crate) const PILL: f64 = 11.0;
/// From the left edge of a reset line's circle, with some room, to the box.
pub(crate) const RESET: f64 = 2.0 * RADIUS + 8.0;
/// Half the room of a line.
pub(crate) const LANE: f64 = 6.0;

/// Lengths for what stands on the grid.
pub(crate) struct Lengths {
    /// Left and right edge of each column.
    pub(crate) columns: Vec<(f64, f64)>,
    /// Upper and lower edge of each band.
    pub(crate) bands: Vec<(f64, f64)>,
    pub(crate) x: HashMap<(usize, Point), f64>,
    pub(crate) y: HashMap<(usize, Point), f64>,
    /// Heights of port lines in rows, and of the body's ends.
    pub(crate) slots: HashMap<(usize, usize), f64>,
    /// Places of circles.
    pub(crate) circles: HashMap<Point, f64>,
}

impl Lengths {
    /// Where a corner of a net lies.
    pub(crate) fn at(&self, net: usize, p: Point) -> (f64, f64) {
        (self.x[&(net, p)], self.y[&(net, p)])
    }

    /// The height of a node's port line.
    pub(crate) fn slot(&self, column: Slot, y: usize) -> f64 {
        self.slots[&(column as usize, y)]
    }

    /// Where a circle lies from left to right.
    pub(crate) fn circle(&self, p: Point) -> f64 {
        self.circles[&p]
    }
}

/// Which lines of ports belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    /// Those of a row of modules.
    Row = 0,
    /// Those of sensors.
    Sensor = 1,
    /// Those of actuators.
    Actuator = 2,
}

impl Slot {
    pub(crate) fn of(node: &Node) -> Slot {
        match node.role {
            crate::model::Role::Module(_) => Slot::Row,
            crate::model::Role::Sensor => Slot::Sensor,
            crate::model::Role::Actuator => Slot::Actuator,
        }
    }
}

/// The time constant of a tap as it is written.
pub(crate) fn constant(model: &Model, (net, end): (usize, usize)) -> String {
    let tap = model.nets[net].ends[end].tap;
    let known = tap.and_then(|t| t.time_constant);
    known.map_or("?".into(), |t| spell(&t.to_string()))
}

/// `2s` as `2 s`.
fn spell(span: &str) -> String {
    let at = span.find(|c: char| !c.is_ascii_digit()).unwrap_or(span.len());
    format!("{} {}", &span[..at], span[at..].replace("us", "µs"))
}

/// Width of a node's box.
pub(crate) fn box_width(node: &Node) -> f64 {
    let name = width(&node.name, NAME) * 1.06 + 22.0;
    if node.band().is_none() {
        return name;
    }
    let ports = node.inputs.iter().map(|p| width(&p.name, PORT) + 24.0);
    ports.fold(name.max(76.0), f64::max)
}

/// Decides all lengths.
pub(crate) fn measure(model: &Model, columns: &[usize], places: &Places, paths: &[Path]) -> Lengths {
    let mut lengths = Lengths {
        columns: Vec::new(),
        bands: Vec::new(),
        x: HashMap::new(),
        y: HashMap::new(),
        slots: HashMap::new(),
        circles: HashMap::new(),
    };
    crate::widths::from_left_to_right(model, columns, places, paths, &mut lengths);
    crate::heights::from_top_to_bottom(model, columns, places, paths, &mut lengths);
    lengths
}

/// Every input or output with its node and place.
pub(crate) fn each_port<'m>(
    model: &'m Model,
    places: &'m Places,
    outputs: bool,
) -> impl Iterator<Item = (usize, &'m Port, &'m Place)> {
    let of = if outputs { &places.outputs } else { &places.inputs };
    model
        .nodes
        .iter()
        .zip(of)
        .enumerate()
        .flat_map(move |(node, (n, places))| {
            let ports = if outputs { &n.outputs } else { &n.inputs };
            ports
                .iter()
                .zip(places)
                .map(move |(port, place)| (node, port, place))
        })
}
