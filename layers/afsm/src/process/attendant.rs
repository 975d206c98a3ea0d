//! The attendant: an ordinary thread of a layer process that does what the daemon says of other layers.
//!
//! ```text
//!   join a tap ───► map the other layer's page, read-only ─► command to the beating thread ─► obeyed
//!   release ──────► command to the beating thread; windows run out by themselves ───────────► obeyed
//!   connect ──────► map the page that is shared anew ─► command to the beating thread ──────► obeyed
//! ```
//! What it counts at the taps of others it tells the daemon a few times a second: only this process sees it.
//!
//! Must never make the beating thread wait, nor join a tap to a port that its manifest does not open.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use ipc::clock::{self, Span};
use ipc::control::{Connection, JoinTap, Order, REFUSAL_MAX, Reply, Request, timed_out};
use ipc::message::Kind;
use ipc::wire::iceoryx::Domain;
use ipc::wire::{Page, Room, TapCounts, TapEnd, TapGauge};
use ipc::wiring::creature::{How, Layer};
use ipc::wiring::directory::Listed;

use crate::layer::{Command, Hand};
use crate::places::Places;

/// How long it waits for the daemon to say something before it looks after the rest.
const LISTEN: Duration = Duration::from_millis(20);

/// How long the daemon may take to hear an answer.
const ANSWER_TIME: Duration = Duration::from_secs(5);

/// How often counts are told, if there is anything new.
const COUNTS: Span = Span::millis(200);

/// How long the beating thread may take to take up commands before an order is refused: a beat of the slowest
/// sensible layer.
const TAKE_UP: Span = Span::secs(1);

/// How long it waits for room in the ring of commands.
const STEP: Duration = Duration::from_millis(5);

/// A tap of another layer on a port of this one.
struct Held {
    tap: u16,
    plug: u32,
    gauge: Arc<TapGauge>,
    told: TapCounts,
}

/// The page of another layer, by the number of its coming; or why it could not be mapped, so that its other taps
/// need not wait for that again.
type Mapped = (u32, Result<Arc<Page>, String>);

pub(super) struct Attendant {
    connection: Connection,
    domain: Arc<Domain>,
    hand: Hand,
    layer: Layer,
    places: Places,
    /// Ports that its manifest opens.
    open: Vec<String>,
    pages: Vec<Mapped>,
    taps: Vec<Held>,
}

impl Attendant {
    /// The attendant of `layer`, which opens its ports `open`.
    ///
    /// # Errors
    /// When the socket takes no time-out.
    pub(super) fn new(
        connection: Connection,
        domain: Arc<Domain>,
        hand: Hand,
        layer: &Layer,
        open: Vec<String>,
    ) -> std::io::Result<Attendant> {
        connection.socket().set_read_timeout(Some(LISTEN))?;
        connection.socket().set_write_timeout(Some(ANSWER_TIME))?;
        Ok(Attendant {
            connection,
            domain,
            hand,
            places: Places::of(layer),
            layer: layer.clone(),
            open,
            pages: Vec::new(),
            taps: Vec::new(),
        })
    }

    /// Does what the daemon says until the layer is `gone`, or the daemon is; then both are.
    pub(super) fn serve(mut self, gone: &AtomicBool) {
        let mut told = clock::monotonic();
        while !gone.load(Ordering::Relaxed) {
            let heard = match self.connection.receive::<Reply>() {
                Ok(Some(Reply::Order { number, order })) => {
                    let refused = self.obey(order, gone).err();
                    let refused = refused.map(|reason| reason.chars().take(REFUSAL_MAX).collect());
                    self.connection.send(&Request::Obeyed {
                        order: number,
                        refused,
                    })
                }
                Ok(Some(_)) => Ok(()),
                Ok(None) => break,
                Err(e) if timed_out(&e) => Ok(()),
                Err(e) => Err(e),
            };
            while self.hand.returned.pop().is_ok() {}
            let now = clock::monotonic();
            let counted = if now.since(told) >= COUNTS {
                told = now;
                self.tell_counts()
            } else {
                Ok(())
            };
            if heard.and(counted).is_err() {
                break;
            }
        }
        // If the daemon is gone already there is nobody to tell.
        let _ = self.connection.send(&Request::Unplug);
        gone.store(true, Ordering::Relaxed);
        let _ = self.connection.socket().shutdown(std::net::Shutdown::Both);
    }

    fn obey(&mut self, order: Order, gone: &AtomicBool) -> Result<(), String> {
        match order {
            Order::Join(join) => self.join(&join, gone),
            Order::Release { plug } => {
                self.pages.retain(|(number, _)| *number != plug);
                self.taps.retain(|held| held.plug != plug);
                self.command(Command::Release(plug), gone)
            }
            Order::Connect { owner, wires } => {
                let page = self.domain.map(&owner).map_err(|e| e.to_string())?;
                wires.iter().try_for_each(|wire| self.connect(&page, wire, gone))
            }
            Order::Lost { layer } => {
                eprintln!("layer {layer} is gone; its wires are silent until it is back");
                Ok(())
            }
        }
    }

    /// Joins another layer's tap to a port of this one.
    fn join(&mut self, join: &JoinTap, gone: &AtomicBool) -> Result<(), String> {
        let to = &join.to;
        if !self.open.contains(to) {
            return Err(format!("{to} is not open to taps"));
        }
        let port = self.places.tapped(join.how, to);
        let port = port.ok_or_else(|| format!("there is no such port {to} to tap"))?;
        if join.how == How::Suppress && self.takes(to) != Some(join.from.kind) {
            return Err(format!("{} does not carry what {to} takes", join.from.name));
        }
        if join.level <= self.layer.level || join.time_constant == Span::ZERO {
            return Err(format!("{to} is not for a tap of level {}", join.level));
        }
        let page = self.page(join.plug, &join.from.owner)?;
        let reader = page.reader(join.from.index, join.from.kind);
        let gauge = Arc::new(TapGauge::numbered(join.tap));
        let end = TapEnd {
            reader: reader.ok_or_else(|| format!("{} is not among the wires shared", join.from.name))?,
            time_constant: join.time_constant,
            level: join.level,
            plug: join.plug,
            gauge: gauge.clone(),
            room: Room::full(join.from.kind),
        };
        self.command(Command::join(join.how, port, end), gone)?;
        self.taps.push(Held {
            tap: join.tap,
            plug: join.plug,
            gauge,
            told: TapCounts::default(),
        });
        Ok(())
    }

    /// Connects every input that reads `wire` to it as it is shared now.
    fn connect(&mut self, page: &Arc<Page>, wire: &Listed, gone: &AtomicBool) -> Result<(), String> {
        let inputs = self.layer.wires.iter();
        let inputs: Vec<String> = inputs
            .filter(|w| w.from.to_string() == wire.name)
            .map(|w| w.to.to_string())
            .collect();
        for to in inputs {
            let place = self
                .places
                .input(&to)
                .filter(|_| self.takes(&to) == Some(wire.kind));
            let reader = page.reader(wire.index, wire.kind);
            let (Some(place), Some(reader)) = (place, reader) else {
                return Err(format!("{} no longer carries what {to} takes", wire.name));
            };
            self.command(Command::Connect(place, reader), gone)?;
        }
        Ok(())
    }

    /// What an input takes.
    fn takes(&self, input: &str) -> Option<Kind> {
        let (module, port) = input.split_once('.')?;
        let module = self.layer.modules.iter().find(|m| m.name == module)?;
        let (_, port) = module.declaration.input(port)?;
        Some(port.kind)
    }

    /// The page of the layer that came as number `plug` and shares its wires as `owner`.
    fn page(&mut self, plug: u32, owner: &str) -> Result<Arc<Page>, String> {
        if let Some((_, page)) = self.pages.iter().find(|(number, _)| *number == plug) {
            return page.clone();
        }
        let page = self.domain.map(owner).map_err(|e| e.to_string());
        self.pages.push((plug, page.clone()));
        page
    }

    /// Hands a command to the beating thread.
    fn command(&mut self, mut command: Command, gone: &AtomicBool) -> Result<(), String> {
        let began = clock::monotonic();
        while let Err(rtrb::PushError::Full(kept)) = self.hand.commands.push(command) {
            if gone.load(Ordering::Relaxed) || clock::monotonic().since(began) > TAKE_UP {
                return Err("its layer does not take up taps; is it beating?".into());
            }
            command = kept;
            std::thread::sleep(STEP);
        }
        Ok(())
    }

    /// Tells what was counted since it was last told.
    fn tell_counts(&mut self) -> std::io::Result<()> {
        let new = self.taps.iter_mut().filter_map(|held| {
            let counts = held.gauge.counts();
            let changed = std::mem::replace(&mut held.told, counts) != counts;
            changed.then_some((held.tap, counts))
        });
        let taps: Vec<(u16, TapCounts)> = new.collect();
        if taps.is_empty() {
            return Ok(());
        }
        self.connection.send(&Request::Counts { taps })
    }
}
