//! Attached layers among themselves: taps on each other's ports, and wires that they read of each other.
//!
//! ```text
//!   a tapper comes ──► order to the owner: join        the owner answers ──► the tap stands, an event
//!   a tapper goes ───► order to the owner: release     the owner goes ─────► its taps wait, readers are told
//!   the owner is back ─► waiting taps are checked anew and joined, readers connect to its new page
//! ```
//! Must never believe what an owner says but of its own ports: it is asked for nothing else.

use std::sync::atomic::Ordering;

use afsm::layer::Command;
use ipc::clock::{self, Time};
use ipc::control::{JoinTap, Order, Plug, REFUSAL_MAX};
use ipc::wire::TapCounts;
use ipc::wiring::directory::Listed;

use super::{Attached, AttachedTap, Plugs, State};
use crate::policy::has_port;

impl State {
    /// Orders the attached layer that has the port of a tap to join it; nobody is asked if there is none, and the
    /// tap waits.
    pub(super) fn have_joined(&self, number: u32, plug: &Plug, tap: &mut AttachedTap, now: Time) {
        tap.joined = false;
        let Some(owner) = self.attached.iter().find(|a| has_port(&a.plug, &tap.tap)) else {
            return;
        };
        tap.at = Some(owner.plug.layer.clone());
        tap.before = tap.gauge.counts();
        let mut outputs = plug.outputs.iter();
        let from = outputs.find(|o| o.name == tap.tap.from).expect("checked");
        let join = JoinTap {
            tap: tap.gauge.number(),
            plug: number,
            level: plug.level,
            from: Listed {
                plug: number,
                ..from.clone()
            },
            how: tap.tap.how,
            to: tap.tap.to.clone(),
            time_constant: tap.tap.time_constant,
        };
        owner.orders.give(Order::Join(join), now);
    }

    /// Tells the `taps` of layer `number` to go, wherever they are.
    pub(super) fn release(&mut self, number: u32, taps: &[AttachedTap], now: Time) {
        for hand in &mut self.hands {
            // A full ring belongs to a layer that does not beat: its taps run out by themselves.
            let _ = hand.commands.push(Command::Release(number));
        }
        for owner in &self.attached {
            if taps.iter().any(|t| t.at.as_ref() == Some(&owner.plug.layer)) {
                owner.orders.give(Order::Release { plug: number }, now);
            }
        }
    }

    /// Layer `plug` has gone: taps on its ports wait, and who reads its wires is told. What is to be noted of it: the
    /// tapper, the port, the words.
    pub(super) fn miss(&mut self, plug: &Plug, now: Time) -> Vec<(String, String, String)> {
        let mut notes = Vec::new();
        for other in &mut self.attached {
            let name = other.plug.layer.clone();
            for tap in other.taps.iter_mut() {
                if tap.at.as_ref() == Some(&plug.layer) {
                    tap.joined = false;
                    let text = format!("{} waits for layer {}", told(&name, tap), plug.layer);
                    notes.push((name.clone(), tap.tap.to.clone(), text));
                }
            }
            if reads(&other.plug, plug).next().is_some() {
                let layer = plug.layer.clone();
                other.orders.give(Order::Lost { layer }, now);
            }
        }
        notes
    }
}

impl Plugs {
    /// The newest of the attached layers has come: taps that waited for it are joined, whoever reads its wires is
    /// connected to them, and so is it to those that came while it looked around.
    pub(super) fn introduce(&self, state: &mut State, now: Time) {
        let Some((newcomer, others)) = state.attached.split_last() else {
            return;
        };
        let mut returning = Vec::new();
        for (index, other) in others.iter().enumerate() {
            connect(newcomer, other, now);
            if !newcomer.plug.neighbours.contains(&other.number) {
                connect(other, newcomer, now);
            }
            let waiting = |t: &&AttachedTap| !t.joined && has_port(&newcomer.plug, &t.tap);
            for tap in other.taps.iter().filter(waiting) {
                let reasons = self.policy.reasons_against_rejoining(
                    &other.plug,
                    &tap.tap,
                    (newcomer.number, &newcomer.plug),
                );
                if reasons.is_empty() {
                    returning.push((index, tap.gauge.number()));
                } else {
                    let layer = &other.plug.layer;
                    let text = format!("{} is not joined again: {}", told(layer, tap), reasons.join("; "));
                    self.events.note("layer", Some(layer), text);
                }
            }
        }
        for (index, number) in returning {
            // Out of the list for a moment, as the list is searched for the owner.
            let mut taps = std::mem::take(&mut state.attached[index].taps);
            let other = &state.attached[index];
            for tap in taps.iter_mut().filter(|t| t.gauge.number() == number) {
                state.have_joined(other.number, &other.plug, tap, now);
            }
            state.attached[index].taps = taps;
        }
    }

    /// Layer `number` has answered an order.
    pub fn obeyed(&self, number: u32, order: u64, refused: Option<String>) {
        let mut state = self.lock();
        let Some(owner) = state.attached.iter().find(|a| a.number == number) else {
            return;
        };
        let layer = owner.plug.layer.clone();
        let Some(order) = owner.orders.answered(order, clock::monotonic()) else {
            owner.dismissed.store(true, Ordering::Relaxed);
            let text = format!("policy breach: layer {layer} answered an order that it was never given");
            drop(state);
            self.events.note("policy", Some(&layer), text);
            return;
        };
        let refused = refused.map(|reason| reason.chars().take(REFUSAL_MAX).collect::<String>());
        let outcome = |done: &str, not: &str| match &refused {
            None => done.to_string(),
            Some(reason) => format!("{not}: {reason}"),
        };
        let (about, ports, text) = match order {
            Order::Join(join) => {
                let tapper = state.attached.iter_mut().find(|a| a.number == join.plug);
                let Some(tapper) = tapper else { return };
                let name = tapper.plug.layer.clone();
                let mut taps = tapper.taps.iter_mut();
                let Some(tap) = taps.find(|t| t.gauge.number() == join.tap) else {
                    return;
                };
                tap.joined = refused.is_none();
                let outcome = outcome("joined", "refused");
                (
                    name.clone(),
                    vec![join.to.clone()],
                    format!("{} {outcome} at layer {layer}", told(&name, tap)),
                )
            }
            Order::Release { .. } => {
                let outcome = outcome("released", "did not release");
                (
                    layer.clone(),
                    Vec::new(),
                    format!("layer {layer} {outcome} the taps of a layer that has gone"),
                )
            }
            Order::Connect { owner, wires } => {
                let outcome = outcome("reads", "does not read");
                (
                    layer.clone(),
                    wires.into_iter().map(|w| w.name).collect(),
                    format!("layer {layer} {outcome} the wires of {owner} again"),
                )
            }
            Order::Lost { .. } => return,
        };
        drop(state);
        self.events.note_wires("layer", Some(&about), &ports, text);
    }

    /// Layer `number` tells what it counted at the taps of others on its ports.
    pub fn counted(&self, number: u32, counts: &[(u16, TapCounts)]) {
        let state = self.lock();
        let Some(owner) = state.attached.iter().find(|a| a.number == number) else {
            return;
        };
        let here = |t: &&AttachedTap| t.joined && t.at.as_ref() == Some(&owner.plug.layer);
        for tap in state.attached.iter().flat_map(|a| &a.taps).filter(here) {
            if let Some((_, counts)) = counts
                .iter()
                .find(|(tap_number, _)| *tap_number == tap.gauge.number())
            {
                tap.gauge.take_over(tap.before + *counts);
            }
        }
    }
}

/// Has `reader` connect to the wires of `writer` that it reads, if it reads any.
fn connect(writer: &Attached, reader: &Attached, now: Time) {
    let wires: Vec<Listed> = reads(&reader.plug, &writer.plug)
        .map(|wire| Listed {
            plug: writer.number,
            ..wire.clone()
        })
        .collect();
    if !wires.is_empty() {
        let owner = writer.plug.owner.clone();
        reader.orders.give(Order::Connect { owner, wires }, now);
    }
}

/// The wires of `writer` that `reader` reads and may read.
fn reads<'p>(reader: &'p Plug, writer: &'p Plug) -> impl Iterator<Item = &'p Listed> {
    let open = |l: &&Listed| {
        writer
            .open_reads
            .as_ref()
            .is_none_or(|open| open.contains(&l.name))
    };
    let reads = |l: &&Listed| reader.wires.iter().any(|(from, _)| *from == l.name);
    writer.outputs.iter().filter(open).filter(reads)
}

/// A tap of `layer` in words.
fn told(layer: &str, tap: &AttachedTap) -> String {
    format!("tap {} > {} of layer {layer}", tap.tap.from, tap.tap.to)
}
