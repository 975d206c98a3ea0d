//! From a checked layer to a running one: registers joined to wires, outlets to cells, taps in series.
//!
//! Must never run on a real-time thread; it allocates everything that the layer will ever need.

use std::sync::Arc;

use ipc::wire::{Outlet, Page, Reader, Register, Room, TapEnd, TapGauge};
use ipc::wiring::creature::{How, Layer, PortName, Tap};
use ipc::wiring::{Declaration, catalog};

use crate::kind::{Kinds, Settings};
use crate::layer::{Hand, RunningLayer};

/// A tap of the creature file, with the level it comes from and where it is counted.
#[derive(Clone, Debug)]
pub struct FiledTap {
    /// The tap.
    pub tap: Tap,
    /// Level of the layer that declares it.
    pub level: u8,
    /// Where what happens at it is counted.
    pub gauge: Arc<TapGauge>,
}

/// What a layer needs to know of the wires around it.
pub trait Wires {
    /// A reading end of the wire of an output port, in this process or another.
    fn reader(&self, output: &PortName) -> Option<Reader>;
}

/// Builds `layer`. Its outputs are the wires of `page` from `first` on, in the order of the declaration;
/// `taps` are all those of the creature, those on this layer's ports are joined.
///
/// # Panics
/// When the layer was not checked against `kinds` and these wires.
pub fn assemble(
    layer: &Layer,
    kinds: &Kinds,
    page: &Arc<Page>,
    first: usize,
    wires: &dyn Wires,
    taps: &[FiledTap],
    seed: u64,
) -> (RunningLayer, Hand) {
    let (mut running, hand) = RunningLayer::new();
    let ports = |of: fn(&Declaration) -> usize| layer.modules.iter().map(|m| of(m.declaration)).sum();
    running.reserve(
        layer.modules.len(),
        ports(|d| inputs(d).count()),
        ports(|d| d.outputs.len()),
    );
    let mut cell = first;
    for module in &layer.modules {
        let declaration = module.declaration;
        let kind = kinds
            .find(declaration.name)
            .expect("a checked module is of a known kind");
        let machine = (kind.build)(&Settings::new(
            declaration,
            &module.settings,
            seed_of(seed, &module.name),
        ));
        let mut reset = false;
        let registers = inputs(declaration)
            .map(|port| {
                let name = PortName {
                    module: module.name.clone(),
                    port: port.name.into(),
                };
                let wire = layer.wires.iter().find(|w| w.to == name);
                let wire = wire.map(|w| wires.reader(&w.from).expect("a checked wire has a writer"));
                let mut register = Register::new(port.limits(), wire.clone());
                let joined = join(taps, How::Suppress, &name, wires, |end| register.suppress(end));
                reset |= port.name == catalog::RESET.name && (wire.is_some() || joined);
                register
            })
            .collect();
        let outlets = declaration
            .outputs
            .iter()
            .map(|port| {
                let name = PortName {
                    module: module.name.clone(),
                    port: port.name.into(),
                };
                let mut outlet = Outlet::new(page.writer(cell, port.kind).expect("a wire has one writer"));
                cell += 1;
                join(taps, How::Inhibit, &name, wires, |end| outlet.inhibit(end));
                outlet
            })
            .collect();
        running.seat(&module.name, kind, machine, registers, outlets, reset);
    }
    (running, hand)
}

fn inputs(declaration: &Declaration) -> impl Iterator<Item = &'static catalog::Port> {
    declaration.inputs.iter().chain(std::iter::once(&catalog::RESET))
}

/// Joins every filed tap on `name`; says whether there was one.
pub fn join(
    taps: &[FiledTap],
    how: How,
    name: &PortName,
    wires: &dyn Wires,
    mut place: impl FnMut(TapEnd) -> Result<(), TapEnd>,
) -> bool {
    let mut any = false;
    for filed in taps.iter().filter(|t| t.tap.how == how && t.tap.to == *name) {
        let end = TapEnd {
            reader: wires.reader(&filed.tap.from).expect("a checked tap has a source"),
            time_constant: filed.tap.time_constant,
            level: filed.level,
            plug: 0,
            gauge: filed.gauge.clone(),
            room: Room::none(),
        };
        place(end).expect("the checker keeps taps within their bound");
        any = true;
    }
    any
}

/// The seed of one module: the creature's, mixed with the module's name (FNV-1a), so that adding a module
/// leaves the others' randomness as it was.
pub fn seed_of(seed: u64, module: &str) -> u64 {
    let start = 0xcbf2_9ce4_8422_2325 ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    module.bytes().fold(start, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
