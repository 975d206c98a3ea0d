//! The writer: items into MCAP, messages as JSON, each topic with its schema.
//!
//! Must never leave out a message of a wire without counting it: the numbers of a wire's messages run without a
//! gap, so what is missing is known, wire by wire, and stands in the recording itself.
//!
//! ```text
//!   /wires/turn.rate   /commands/body.turn   /beats/avoid   /taps   /halts   /overruns   /plugs   /losses   /log
//! ```

mod beat;
mod channel;

use std::collections::{BTreeMap, HashMap};
use std::io::Write;
use std::sync::Arc;

use ipc::clock::{Span, Time};
use ipc::message::Kind;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, McapResult, WriteOptions};
use serde_json::{Value, json};

use channel::{PlugChannels, SourceChannels, WireChannel};

use crate::item::Item;
use crate::manifest::{MOTOR, Manifest, Plugged, Tap};
use crate::schema;
use crate::text::message_text;

/// Name of the metadata record that holds the manifest, and of the one that holds the losses.
pub const METADATA: &str = "subsumed";
/// Name of the metadata record at the end: messages lost, by wire.
pub const LOSSES: &str = "subsumed.losses";
/// Name of the attachment that holds the creature file.
pub const CREATURE: &str = "creature.toml";

/// A recording being written.
pub struct Writer<W: Write> {
    mcap: mcap::Writer<NoSeek<W>>,
    manifest: Arc<Manifest>,
    schemas: HashMap<String, u16>,
    sources: Vec<SourceChannels>,
    plugs: BTreeMap<u32, PlugChannels>,
    taps: HashMap<u16, Tap>,
    rest: HashMap<&'static str, u16>,
    causes: Option<u64>,
    /// The newest beat of the daemon's own.
    newest: Time,
    text: Vec<u8>,
}

/// How far a layer process's message may lie beyond the newest beat that was written.
const FOREIGN_LEAD_MAX: Span = Span::secs(10);

impl<W: Write> Writer<W> {
    /// Begins a recording of the creature that `manifest` describes.
    ///
    /// # Errors
    /// When `out` cannot be written to.
    pub fn new(out: W, manifest: &Arc<Manifest>) -> McapResult<Writer<W>> {
        let options = WriteOptions::new()
            .compression(None)
            .chunk_size(Some(1 << 18))
            .disable_seeking(true)
            .library(manifest.program.clone());
        let mcap = mcap::Writer::with_options(NoSeek::new(out), options)?;
        let mut writer = Writer {
            mcap,
            manifest: manifest.clone(),
            schemas: HashMap::new(),
            sources: Vec::new(),
            plugs: BTreeMap::new(),
            taps: manifest.taps.iter().map(|t| (t.number, t.clone())).collect(),
            rest: HashMap::new(),
            causes: None,
            newest: Time::ZERO,
            text: Vec::new(),
        };
        writer.describe()?;
        for (name, text) in schema::of_rest() {
            writer.schema(name, &text)?;
        }
        for (topic, schema) in [
            ("/taps", schema::TAP),
            ("/halts", schema::HALT),
            ("/overruns", schema::OVERRUN),
            ("/losses", schema::LOSS),
            ("/plugs", schema::PLUG),
            ("/log", schema::LOG),
        ] {
            let id = writer.channel(topic, schema, &BTreeMap::new())?;
            writer.rest.insert(topic, id);
        }
        for source in &manifest.sources {
            let channels = writer.source(source)?;
            writer.sources.push(channels);
        }
        for plugged in &manifest.plugs {
            writer.plugged(Time(manifest.began_ns), plugged)?;
        }
        Ok(writer)
    }

    fn describe(&mut self) -> McapResult<()> {
        let manifest = self.manifest.clone();
        let text = serde_json::to_string(&*manifest).unwrap_or_default();
        self.mcap.write_metadata(&Metadata {
            name: METADATA.into(),
            metadata: BTreeMap::from([
                ("creature".into(), manifest.creature.clone()),
                ("program".into(), manifest.program.clone()),
                ("manifest".into(), text),
            ]),
        })?;
        let time = self.log_time(Time(manifest.began_ns));
        self.mcap.attach(&Attachment {
            log_time: time,
            create_time: time,
            name: CREATURE.into(),
            media_type: "application/toml".into(),
            data: manifest.file.as_bytes().into(),
        })
    }

    fn schema(&mut self, name: &str, schema: &Value) -> McapResult<u16> {
        if let Some(&id) = self.schemas.get(name) {
            return Ok(id);
        }
        let id = self
            .mcap
            .add_schema(name, "jsonschema", schema.to_string().as_bytes())?;
        self.schemas.insert(name.into(), id);
        Ok(id)
    }

    fn channel(&mut self, topic: &str, schema: &str, more: &BTreeMap<String, String>) -> McapResult<u16> {
        let schema = self.schemas.get(schema).copied().unwrap_or(0);
        self.mcap.add_channel(schema, topic, "json", more)
    }

    fn wire(&mut self, name: &str, kind: Kind, more: &BTreeMap<String, String>) -> McapResult<WireChannel> {
        let id = self.message_channel(&format!("/wires/{name}"), kind, more)?;
        Ok(WireChannel::new(name, id, kind))
    }

    fn message_channel(
        &mut self,
        topic: &str,
        kind: Kind,
        more: &BTreeMap<String, String>,
    ) -> McapResult<u16> {
        let (schema, text) = schema::of_message(kind);
        self.schema(&schema, &text)?;
        self.channel(topic, &schema, more)
    }

    fn source(&mut self, source: &crate::manifest::Source) -> McapResult<SourceChannels> {
        let beats = self.channel(&format!("/beats/{}", source.name), schema::BEAT, &BTreeMap::new())?;
        let about = |unit: &str| {
            BTreeMap::from([
                ("unit".into(), unit.into()),
                ("layer".into(), source.name.clone()),
            ])
        };
        let mut outputs = Vec::new();
        for output in &source.outputs {
            outputs.push(self.wire(&output.name, output.kind, &about(&output.unit))?);
        }
        let mut commands = Vec::new();
        for input in source.inputs.iter().filter(|_| source.name == MOTOR) {
            let topic = format!("/commands/{}", input.name);
            commands.push((
                self.message_channel(&topic, input.kind, &about(&input.unit))?,
                input.kind,
            ));
        }
        Ok(SourceChannels {
            beats,
            outputs,
            commands,
        })
    }

    /// Writes an item down.
    ///
    /// # Errors
    /// When the recording cannot be written to any more.
    pub fn write(&mut self, item: &Item) -> McapResult<()> {
        match item {
            Item::Beat { source, words } => self.beat(usize::from(*source), words),
            Item::Base(base) => self.base(base),
            Item::Wire {
                plug,
                index,
                kind,
                reading,
            } => self.foreign(
                *plug,
                *index,
                reading.number,
                reading.stamp,
                &reading.words[..kind.words()],
            ),
            Item::Plugged(time, plugged) => self.plugged(*time, plugged),
            Item::Unplugged(time, number) => self.unplugged(*time, *number),
            Item::Overrun {
                source,
                time,
                overruns,
                skipped,
            } => {
                let layer = self.manifest.sources[usize::from(*source)].name.clone();
                let text = json!({"layer": layer, "overruns": overruns, "skipped": skipped});
                self.rest("/overruns", *time, &text)
            }
            Item::Lost { source, time, beats } => {
                let what = self.manifest.sources[usize::from(*source)].name.clone();
                self.rest("/losses", *time, &json!({"what": what, "lost": beats}))
            }
            Item::Log(time, event) => {
                let log_time = self.log_time(*time);
                let text = json!({
                    "timestamp": {"sec": log_time / 1_000_000_000, "nsec": log_time % 1_000_000_000},
                    "level": if event.kind == "layer" { 2 } else { 3 }, "message": event.text,
                    "name": event.layer.as_deref().unwrap_or("daemon"), "file": "", "line": 0,
                    "kind": event.kind, "number": event.number, "time_s": event.time_s,
                });
                self.rest("/log", *time, &text)
            }
        }
    }

    fn foreign(
        &mut self,
        plug: u32,
        index: usize,
        number: u64,
        stamp: Time,
        words: &[f64],
    ) -> McapResult<()> {
        let wire = self.plugs.get_mut(&plug).and_then(|p| p.outputs.get_mut(index));
        let Some(wire) = wire else { return Ok(()) };
        if !wire.takes(number) {
            return Ok(());
        }
        let (id, kind) = (wire.id, wire.kind);
        message_text(&mut self.text, kind, number, stamp, words);
        self.send(id, number, self.believable(stamp))
    }

    /// When a message of a layer process is logged: at its stamp, if that can be. The process may write any stamp; one
    /// from before the daemon, or from the future, would stretch the recording's time line over centuries.
    fn believable(&self, stamp: Time) -> Time {
        let began = Time(self.manifest.began_ns);
        stamp.clamp(began, self.newest.max(began) + FOREIGN_LEAD_MAX)
    }

    fn plugged(&mut self, time: Time, plugged: &Plugged) -> McapResult<()> {
        if self.plugs.contains_key(&plugged.number) {
            return Ok(());
        }
        let mut outputs = Vec::new();
        for output in &plugged.plug.outputs {
            let about = BTreeMap::from([
                ("unit".into(), output.unit.clone()),
                ("layer".into(), plugged.plug.layer.clone()),
                ("plug".into(), plugged.number.to_string()),
            ]);
            outputs.push(self.wire(&output.name, output.kind, &about)?);
        }
        let layer = plugged.plug.layer.clone();
        self.taps.extend(plugged.taps().map(|t| (t.number, t)));
        let text = json!({"layer": layer, "attached": true, "number": plugged.number, "plugged": plugged});
        self.plugs.insert(plugged.number, PlugChannels { layer, outputs });
        self.rest("/plugs", time, &text)
    }

    fn unplugged(&mut self, time: Time, number: u32) -> McapResult<()> {
        let layer = self.plugs.get(&number).map(|p| p.layer.clone());
        self.rest(
            "/plugs",
            time,
            &json!({"layer": layer, "attached": false, "number": number}),
        )
    }

    fn message(&mut self, id: u16, kind: Kind, number: u64, stamp: Time, words: &[f64]) -> McapResult<()> {
        message_text(&mut self.text, kind, number, stamp, words);
        self.send(id, number, stamp)
    }

    fn rest(&mut self, topic: &'static str, time: Time, text: &Value) -> McapResult<()> {
        self.text.clear();
        self.text.extend(text.to_string().as_bytes());
        self.send(self.rest[topic], 0, time)
    }

    fn send(&mut self, channel_id: u16, number: u64, time: Time) -> McapResult<()> {
        let log_time = self.log_time(time);
        let header = MessageHeader {
            channel_id,
            sequence: number as u32,
            log_time,
            publish_time: log_time,
        };
        self.mcap.write_to_known_channel(&header, &self.text)
    }

    fn log_time(&self, time: Time) -> u64 {
        time.0.saturating_add_signed(self.manifest.offset_ns)
    }

    /// Hands over what was written so far.
    ///
    /// # Errors
    /// When the recording cannot be written to any more.
    pub fn flush(&mut self) -> McapResult<()> {
        self.mcap.flush()
    }

    /// Ends the recording, after noting what is missing from it; gives the number of messages lost.
    ///
    /// # Errors
    /// When the recording cannot be written to any more.
    pub fn finish(mut self) -> McapResult<u64> {
        let own = self.sources.iter().flat_map(|s| &s.outputs);
        let theirs = self.plugs.values().flat_map(|p| &p.outputs);
        let lost: BTreeMap<String, u64> = own
            .chain(theirs)
            .filter(|w| w.written > 0 && w.lost() > 0)
            .map(|w| (w.name.clone(), w.lost()))
            .collect();
        let all = lost.values().sum();
        let mut metadata = BTreeMap::from([("messages".to_string(), format!("{all}"))]);
        metadata.extend(
            lost.iter()
                .map(|(wire, n)| (format!("/wires/{wire}"), n.to_string())),
        );
        self.mcap.write_metadata(&Metadata {
            name: LOSSES.into(),
            metadata,
        })?;
        self.mcap.finish()?;
        Ok(all)
    }
}
