//! ADROIT: releasing mechanisms, and the language that assembles them (Friedman 1969).
//!
//! - [`hierarchy`]: the elements and the one recursive evaluation
//! - [`language`]: the text that assembles them, and commands to a running hierarchy
//! - [`nest`]: the nest-building robot and its world
//! - [`drives`]: what drives a robot that levels of state machines keep safe
//! - [`planning`] and [`learning`]: what the source announces
//! - [`live`]: commands to a running hierarchy, from another process
//! - [`draw`]: the hierarchy as a picture
//! - [`figures`] and [`command`]: measuring, and the commands of the tool
//!
//! Must never: know of wires, layers or the daemon. Where each element stands in the source, and how an ADROIT
//! hierarchy sits on layers of state machines, is told in the README.

pub mod command;
pub mod draw;
pub mod drives;
pub mod figures;
pub mod hierarchy;
pub mod language;
pub mod learning;
pub mod live;
pub mod nest;
pub mod planning;
