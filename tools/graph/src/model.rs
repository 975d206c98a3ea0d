//! What is drawn: bands of modules, the body's ends, nets and taps, each with what is wrong with it.
//!
//! Must never hold a place or a length: where things stand is decided later.

use ipc::clock::Span;
use ipc::wiring::BODY;
use ipc::wiring::creature::How;

/// Most ends of wires and taps that are drawn; a picture of more would not be read, and routing them would
/// take minutes.
pub const ENDS_MAX: usize = 2000;

/// Everything a picture shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// The creature's name.
    pub name: String,
    /// Layers, lowest level first.
    pub bands: Vec<Band>,
    /// Modules, and the body's sensors and actuators.
    pub nodes: Vec<Node>,
    /// Wires, each from one output to all that hear it.
    pub nets: Vec<Net>,
    /// What is wrong with parts that stand nowhere in the picture.
    pub faults: Vec<String>,
}

/// A layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Its name.
    pub name: String,
    /// Its level.
    pub level: u8,
    /// The process it runs in, if not the daemon's own.
    pub process: Option<String>,
}

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A module of a layer: the index of its band.
    Module(usize),
    /// A sensor of the body.
    Sensor,
    /// An actuator of the body.
    Actuator,
}

/// A module, a sensor or an actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Its name; for the body's ends the port's.
    pub name: String,
    /// What it is.
    pub role: Role,
    /// The kind of module.
    pub kind: String,
    /// What is wrong with it.
    pub fault: Option<String>,
    /// Inputs that something reaches.
    pub inputs: Vec<Port>,
    /// Outputs that something hears or taps.
    pub outputs: Vec<Port>,
}

/// A port of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// Its name.
    pub name: String,
    /// Its taps in the order in which they stand in series along the wire: suppressors from the existing
    /// wire to the module, inhibitors from the module outward. Each is a net and the index of its end.
    pub taps: Vec<(usize, usize)>,
    /// The net that ends here (inputs) or begins here (outputs).
    pub net: Option<usize>,
}

/// An output with all that hears it.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// The wire's name, `module.port`.
    pub name: String,
    /// Node and index of its output.
    pub from: (usize, usize),
    /// Where it leads.
    pub ends: Vec<End>,
}

/// Where a net leads.
#[derive(Clone, Debug, PartialEq)]
pub struct End {
    /// The node.
    pub node: usize,
    /// The port's index among the node's inputs (for an inhibitor: outputs).
    pub port: usize,
    /// The port's full name.
    pub to: String,
    /// A tap, or none for a plain wire.
    pub tap: Option<Tap>,
    /// What is wrong with it.
    pub fault: Option<String>,
}

/// A side-tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Which way it acts.
    pub how: How,
    /// Its time constant, if it is known.
    pub time_constant: Option<Span>,
    /// The level of the layer that declares it.
    pub level: u8,
}

impl Node {
    /// The band of a module.
    pub fn band(&self) -> Option<usize> {
        match self.role {
            Role::Module(band) => Some(band),
            _ => None,
        }
    }
}

impl Net {
    /// Whether anything is wrong with every one of its ends.
    pub fn is_faulty(&self) -> bool {
        !self.ends.is_empty() && self.ends.iter().all(|e| e.fault.is_some())
    }
}

impl Model {
    /// An empty picture of the creature called `name`.
    pub fn new(name: &str) -> Model {
        Model {
            name: name.into(),
            ..Model::default()
        }
    }

    /// Adds a layer above those of lower or the same level; returns its index, which later layers shift.
    pub(crate) fn band(&mut self, band: Band) -> usize {
        self.bands.push(band);
        self.bands.len() - 1
    }

    /// Adds a module to a band.
    pub(crate) fn module(&mut self, band: usize, name: &str, kind: &str, fault: Option<String>) -> usize {
        self.nodes.push(Node {
            name: name.into(),
            role: Role::Module(band),
            kind: kind.into(),
            fault,
            inputs: Vec::new(),
            outputs: Vec::new(),
        });
        self.nodes.len() - 1
    }

    /// The node that a port's module names: a module, or an end of the body, made when first named. A module
    /// that nobody declared becomes a faulty one of `band`.
    fn node(&mut self, module: &str, port: &str, output: bool, band: usize) -> usize {
        if module == BODY {
            let role = if output { Role::Sensor } else { Role::Actuator };
            if let Some(found) = self.nodes.iter().position(|n| n.role == role && n.name == port) {
                return found;
            }
            let made = self.module(band, port, BODY, None);
            self.nodes[made].role = role;
            return made;
        }
        let known = |n: &Node| n.name == module && n.band().is_some();
        if let Some(found) = self.nodes.iter().position(known) {
            return found;
        }
        self.module(band, module, "", Some(format!("there is no module {module:?}")))
    }

    fn net(&mut self, from: &str, band: usize) -> usize {
        let (module, port) = split(from);
        let node = self.node(module, port, true, band);
        let index = output(&mut self.nodes[node], port);
        if let Some(net) = self.nodes[node].outputs[index].net {
            return net;
        }
        self.nets.push(Net {
            name: from.into(),
            from: (node, index),
            ends: Vec::new(),
        });
        self.nodes[node].outputs[index].net = Some(self.nets.len() - 1);
        self.nets.len() - 1
    }

    /// Adds a wire that a layer of `band` declares.
    pub(crate) fn wire(&mut self, band: usize, from: &str, to: &str, fault: Option<String>) {
        let net = self.net(from, band);
        let (module, port) = split(to);
        let node = self.node(module, port, false, band);
        // A second writer of one input is wrong, and gets a place of its own to show it.
        let inputs = &mut self.nodes[node].inputs;
        let index = match inputs.iter().position(|p| p.name == port) {
            Some(index) if inputs[index].net.is_none() => index,
            _ => {
                inputs.push(Port::new(port));
                inputs.len() - 1
            }
        };
        inputs[index].net = Some(net);
        self.nets[net].ends.push(End {
            node,
            port: index,
            to: to.into(),
            tap: None,
            fault,
        });
    }

    /// Adds a tap that a layer of `band` declares.
    pub(crate) fn tap(&mut self, band: usize, from: &str, to: &str, tap: Tap, fault: Option<String>) {
        let net = self.net(from, band);
        let (module, port) = split(to);
        let inhibits = tap.how == How::Inhibit;
        let node = self.node(module, port, inhibits, band);
        let index = if inhibits {
            let target = self.net(to, band);
            self.nets[target].from.1
        } else {
            let inputs = &mut self.nodes[node].inputs;
            inputs.iter().position(|p| p.name == port).unwrap_or_else(|| {
                inputs.push(Port::new(port));
                inputs.len() - 1
            })
        };
        let end = (net, self.nets[net].ends.len());
        self.nets[net].ends.push(End {
            node,
            port: index,
            to: to.into(),
            tap: Some(tap),
            fault,
        });
        let owner = &mut self.nodes[node];
        let ports = if inhibits {
            &mut owner.outputs
        } else {
            &mut owner.inputs
        };
        ports[index].taps.push(end);
    }

    /// Puts layers and taps into their order: by level, then as declared.
    pub(crate) fn finish(mut self) -> Model {
        let mut order: Vec<usize> = (0..self.bands.len()).collect();
        order.sort_by_key(|&b| self.bands[b].level);
        let old = std::mem::take(&mut self.bands);
        self.bands = order.iter().map(|&b| old[b].clone()).collect();
        for node in &mut self.nodes {
            if let Role::Module(band) = &mut node.role {
                *band = order.iter().position(|o| o == band).unwrap_or(0);
            }
            for port in node.inputs.iter_mut().chain(&mut node.outputs) {
                let nets = &self.nets;
                port.taps
                    .sort_by_key(|&(net, end)| nets[net].ends[end].tap.map_or(0, |t| t.level));
            }
        }
        let ends: usize = self.nets.iter().map(|n| n.ends.len()).sum();
        if ends > ENDS_MAX {
            self.nets.clear();
            self.nodes.iter_mut().for_each(|n| {
                n.inputs.clear();
                n.outputs.clear();
            });
            self.nodes.retain(|n| n.band().is_some());
            self.faults.push(format!(
                "{ends} ends of wires and taps are too many to draw: expected at most {ENDS_MAX}"
            ));
        }
        self
    }
}

impl Port {
    fn new(name: &str) -> Port {
        Port {
            name: name.into(),
            taps: Vec::new(),
            net: None,
        }
    }
}

fn output(node: &mut Node, port: &str) -> usize {
    node.outputs
        .iter()
        .position(|p| p.name == port)
        .unwrap_or_else(|| {
            node.outputs.push(Port::new(port));
            node.outputs.len() - 1
        })
}

/// Splits `module.port`.
fn split(name: &str) -> (&str, &str) {
    name.split_once('.').unwrap_or((name, ""))
}
