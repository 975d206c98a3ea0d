//! Places: where the ports of a layer are found among its registers and outlets.
//!
//! Must never differ from the order in which [`assemble`](crate::assemble) seats modules.

use std::collections::HashMap;

use ipc::wiring::catalog::RESET;
use ipc::wiring::creature::{How, Layer};

/// The ports of a layer by name: the number of each one's register or outlet, reset lines included.
#[derive(Clone, Debug, Default)]
pub struct Places {
    inputs: HashMap<String, usize>,
    outputs: HashMap<String, usize>,
}

impl Places {
    /// Those of `layer`.
    pub fn of(layer: &Layer) -> Places {
        let mut places = Places::default();
        for module in &layer.modules {
            let inputs = module.declaration.inputs.iter();
            for port in inputs.chain(std::iter::once(&RESET)) {
                let name = format!("{}.{}", module.name, port.name);
                places.inputs.insert(name, places.inputs.len());
            }
            for port in module.declaration.outputs {
                let name = format!("{}.{}", module.name, port.name);
                places.outputs.insert(name, places.outputs.len());
            }
        }
        places
    }

    /// The register behind the input port `name`.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.get(name).copied()
    }

    /// The outlet behind the output port `name`.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.get(name).copied()
    }

    /// Where a tap that acts so on the port `name` is joined.
    pub fn tapped(&self, how: How, name: &str) -> Option<usize> {
        match how {
            How::Suppress => self.input(name),
            How::Inhibit => self.output(name),
        }
    }
}
