//! The reader: MCAP back into messages and beats.
//!
//! Must never take a recording for whole that isn't: one that was cut off is read as far as it goes, and says so.

use std::collections::BTreeMap;
use std::path::Path;

use ipc::clock::{Span, Time};
use ipc::message::{Kind, SONARS, WORDS_MAX, Words};
use ipc::wire::Fate;
use ipc::wiring::creature::How;
use mcap::read::Options;
use serde::Deserialize;

use crate::manifest::{FORMAT, MOTOR, Manifest, Plugged, Tap};
use crate::writer::{CREATURE, LOSSES, METADATA};

/// A recording in memory.
#[derive(Debug)]
pub struct Recording {
    /// What it says of the creature.
    pub manifest: Manifest,
    /// The wires: those of the creature under plug 0, those of attached layers under their numbers.
    pub wires: BTreeMap<(u32, String), Vec<Message>>,
    /// What the body was told, by its input port.
    pub commands: BTreeMap<String, Vec<Message>>,
    /// The beats of each source, oldest first.
    pub beats: Vec<Vec<Beat>>,
    /// Layers that were attached, and when; those attached before it began come first.
    pub plugs: Vec<(Time, Plugged)>,
    /// Layers that left.
    pub unplugs: Vec<(Time, u32)>,
    /// The log: seconds since the daemon began, and the line.
    pub log: Vec<(f64, String)>,
    /// Messages lost, by wire; and beats, by source.
    pub losses: BTreeMap<String, u64>,
    /// Whether its end is there.
    pub whole: bool,
}

/// A message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Message {
    /// Its number on its wire.
    pub number: u64,
    /// When it was written.
    pub stamp: Time,
    /// What it says.
    pub words: Words,
}

/// A beat.
#[derive(Clone, Debug, Deserialize)]
pub struct Beat {
    /// How many came before it.
    #[serde(rename = "beat")]
    pub number: u64,
    /// What its modules were told the time is, in nanoseconds.
    pub step_ns: u64,
    /// When its messages were written, in nanoseconds.
    pub commit_ns: u64,
    /// Whether it is none, but what the source held when the recording began.
    #[serde(default)]
    pub base: bool,
    /// Registers and the messages they took in.
    #[serde(default)]
    pub saw: Vec<(usize, u64)>,
    /// Registers and the messages that suppressors kept out.
    #[serde(default)]
    pub rejected: Vec<(usize, u64)>,
    /// Registers and the messages that were none.
    #[serde(default)]
    pub faults: Vec<(usize, u64)>,
    /// Taps, their messages, stamps, and what became of them: see [`TapMessage`].
    #[serde(default)]
    pub taps: Vec<(u16, u64, u64, u8)>,
    /// Taps that were joined.
    #[serde(default)]
    pub joined: Vec<Joined>,
    /// Layers whose taps were told to go.
    #[serde(default)]
    pub released: Vec<u32>,
    /// Outlets whose message was inhibited.
    #[serde(default)]
    pub dropped: Vec<usize>,
    /// Why the halt gate is closed.
    pub causes: Option<u64>,
}

/// A tap that was joined while the creature ran.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Joined {
    /// The register or outlet.
    pub slot: usize,
    /// The tap's number.
    pub tap: u16,
    /// Which way it acts.
    pub how: How,
    /// The level it comes from.
    pub level: u8,
    /// The layer it belongs to.
    pub plug: u32,
    /// Its time constant.
    pub time_constant_ns: u64,
}

/// A message of a tap that a port took in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapMessage {
    /// The tap's number.
    pub tap: u16,
    /// The message.
    pub number: u64,
    /// When it was written.
    pub stamp: Time,
    /// What became of it.
    pub fate: Fate,
}

impl Beat {
    /// The messages of taps that were taken in.
    pub fn tap_messages(&self) -> impl Iterator<Item = TapMessage> {
        self.taps.iter().map(|&(tap, number, stamp, fate)| TapMessage {
            tap,
            number,
            stamp: Time(stamp),
            fate: match fate {
                0 => Fate::Delivered,
                1 => Fate::Rejected,
                _ => Fate::Fault,
            },
        })
    }

    /// Registers, the messages of their wires that they looked at, and what became of those.
    pub fn looks(&self) -> impl Iterator<Item = (usize, u64, Fate)> {
        let with = |fate| move |&(slot, number): &(usize, u64)| (slot, number, fate);
        let saw = self.saw.iter().map(with(Fate::Delivered));
        let rejected = self.rejected.iter().map(with(Fate::Rejected));
        saw.chain(rejected)
            .chain(self.faults.iter().map(with(Fate::Fault)))
    }
}

#[derive(Deserialize)]
struct MessageText {
    number: u64,
    stamp_ns: u64,
    #[serde(default)]
    value: Option<serde_json::Value>,
    #[serde(default)]
    x: Option<f64>,
    #[serde(default)]
    y: Option<f64>,
    #[serde(default)]
    length: Option<f64>,
    #[serde(default)]
    bearing: Option<f64>,
    #[serde(default)]
    heading: Option<f64>,
    #[serde(default)]
    ranges: Vec<Option<f64>>,
}

impl MessageText {
    fn message(&self, kind: Kind) -> Message {
        let mut words = [0.0; WORDS_MAX];
        let mut put = |numbers: &[Option<f64>]| {
            for (word, number) in words.iter_mut().zip(numbers) {
                *word = number.unwrap_or(f64::NAN);
            }
        };
        match kind {
            Kind::Pulse => {}
            Kind::Bit => put(&[Some(f64::from(self.value == Some(true.into())))]),
            Kind::Number => put(&[self.value.as_ref().and_then(serde_json::Value::as_f64)]),
            Kind::Vector => put(&[self.x, self.y]),
            Kind::Polar => put(&[self.length, self.bearing]),
            Kind::Map => put(&self.ranges[..self.ranges.len().min(SONARS)]),
            Kind::Pose => put(&[self.x, self.y, self.heading]),
        }
        Message {
            number: self.number,
            stamp: Time(self.stamp_ns),
            words,
        }
    }
}

/// A message of a wire from its text.
pub(crate) fn message(text: &[u8], kind: Kind) -> serde_json::Result<Message> {
    Ok(serde_json::from_slice::<MessageText>(text)?.message(kind))
}

/// Reads the recording at `path`.
///
/// # Errors
/// A sentence saying what is wrong with it.
pub fn read(path: &Path) -> Result<Recording, String> {
    let shown = path.display();
    let bytes = std::fs::read(path).map_err(|e| format!("{shown}: cannot be read: {e}"))?;
    parse(&bytes).map_err(|e| format!("{shown}: {e}"))
}

/// Reads a recording from memory.
///
/// # Errors
/// A sentence saying what is wrong with it.
pub fn parse(bytes: &[u8]) -> Result<Recording, String> {
    let (manifest, losses, whole) = records(bytes)?;
    let mut recording = Recording {
        beats: vec![Vec::new(); manifest.sources.len()],
        plugs: manifest
            .plugs
            .iter()
            .map(|p| (Time(manifest.began_ns), p.clone()))
            .collect(),
        manifest,
        wires: BTreeMap::new(),
        commands: BTreeMap::new(),
        unplugs: Vec::new(),
        log: Vec::new(),
        losses,
        whole,
    };
    let stream = mcap::MessageStream::new_with_options(bytes, Options::IgnoreEndMagic.into())
        .map_err(|e| format!("is no MCAP file: {e}"))?;
    for message in stream {
        match message {
            Ok(message) => recording.take(&message)?,
            Err(_) if !recording.whole => break,
            Err(e) => return Err(format!("is damaged: {e}")),
        }
    }
    recording.sort();
    Ok(recording)
}

/// The manifest, the losses, and whether the file has an end.
pub(crate) fn records(bytes: &[u8]) -> Result<(Manifest, BTreeMap<String, u64>, bool), String> {
    let (mut manifest, mut file, mut losses, mut whole) = (None, String::new(), BTreeMap::new(), false);
    let reader = mcap::read::LinearReader::new_with_options(bytes, Options::IgnoreEndMagic.into())
        .map_err(|_| "is no MCAP file; expected one that `subsumectl record` wrote".to_string())?;
    for record in reader {
        match record {
            Ok(mcap::records::Record::Metadata(m)) if m.name == METADATA => {
                let text = m.metadata.get("manifest").ok_or("has no manifest")?;
                let read: Manifest = serde_json::from_str(text)
                    .map_err(|e| format!("was made by another version of subsumed ({e})"))?;
                manifest = Some(read);
            }
            Ok(mcap::records::Record::Metadata(m)) if m.name == LOSSES => {
                let counts = m.metadata.iter().filter(|(name, _)| name.starts_with('/'));
                losses.extend(counts.filter_map(|(name, n)| Some((name.clone(), n.parse().ok()?))));
            }
            Ok(mcap::records::Record::Attachment { header, data, .. }) if header.name == CREATURE => {
                file = String::from_utf8_lossy(&data).into_owned();
            }
            Ok(mcap::records::Record::Footer(_)) => whole = true,
            Ok(_) => {}
            Err(_) => break,
        }
    }
    let mut manifest = manifest.ok_or("is no recording of a creature: it has no manifest of subsumed")?;
    if manifest.format != FORMAT {
        return Err(format!(
            "has format {}; this program reads format {FORMAT}",
            manifest.format
        ));
    }
    manifest.file = file;
    Ok((manifest, losses, whole))
}

impl Recording {
    fn take(&mut self, message: &mcap::Message<'_>) -> Result<(), String> {
        let topic = message.channel.topic.as_str();
        let wrong = |e: serde_json::Error| format!("has a message on {topic} that cannot be read: {e}");
        if let Some(name) = topic.strip_prefix("/wires/") {
            let plug = message
                .channel
                .metadata
                .get("plug")
                .and_then(|p| p.parse().ok())
                .unwrap_or(0);
            let message = self::message(&message.data, kind_of(&message.channel)).map_err(wrong)?;
            self.wires.entry((plug, name.into())).or_default().push(message);
        } else if let Some(name) = topic.strip_prefix("/commands/") {
            let message = self::message(&message.data, kind_of(&message.channel)).map_err(wrong)?;
            self.commands.entry(name.into()).or_default().push(message);
        } else if let Some(name) = topic.strip_prefix("/beats/") {
            let beat: Beat = serde_json::from_slice(&message.data).map_err(wrong)?;
            if let Some(source) = self.manifest.source(name) {
                self.beats[source].push(beat);
            }
        } else {
            let text: serde_json::Value = serde_json::from_slice(&message.data).map_err(wrong)?;
            let time = Time(message.log_time.saturating_add_signed(-self.manifest.offset_ns));
            self.take_rest(topic, time, text).map_err(wrong)?;
        }
        Ok(())
    }

    fn take_rest(&mut self, topic: &str, time: Time, text: serde_json::Value) -> serde_json::Result<()> {
        match topic {
            "/plugs" if text["attached"] == true => {
                let plugged: Plugged = serde_json::from_value(text["plugged"].clone())?;
                if self.plugs.iter().all(|(_, p)| p.number != plugged.number) {
                    self.plugs.push((time, plugged));
                }
            }
            "/plugs" => self
                .unplugs
                .push((time, text["number"].as_u64().unwrap_or(0) as u32)),
            "/losses" => {
                let what = text["what"].as_str().unwrap_or_default().to_string();
                self.losses.insert(what, text["lost"].as_u64().unwrap_or(0));
            }
            "/log" => {
                let message = text["message"].as_str().unwrap_or_default().to_string();
                self.log.push((text["time_s"].as_f64().unwrap_or(0.0), message));
            }
            _ => {}
        }
        Ok(())
    }

    fn sort(&mut self) {
        for messages in self.wires.values_mut() {
            messages.sort_by_key(|m| m.number);
            messages.dedup_by_key(|m| m.number);
        }
        for messages in self.commands.values_mut() {
            messages.sort_by_key(|m| m.stamp);
        }
        for beats in &mut self.beats {
            beats.sort_by_key(|b| b.number);
        }
    }

    /// Every tap there ever was, with the number of the layer it belongs to; 0 for the creature file's.
    pub fn taps(&self) -> impl Iterator<Item = (u32, Tap)> {
        let filed = self.manifest.taps.iter().map(|t| (0, t.clone()));
        filed.chain(
            self.plugs
                .iter()
                .flat_map(|(_, p)| p.taps().map(|t| (p.number, t))),
        )
    }

    /// The attached layer that has the module of `port` at the moment `at`: its newest coming, and whether it has
    /// gone again. None if no attached layer ever had it.
    pub fn owner_of(&self, port: &str, at: Time) -> Option<(&Plugged, bool)> {
        let (module, _) = port.split_once('.')?;
        let has = |p: &Plugged| p.plug.modules.iter().any(|m| m.name == module);
        let mut plugs = self.plugs.iter().rev();
        let (_, owner) = plugs.find(|(time, p)| *time <= at && has(p))?;
        let gone = self
            .unplugs
            .iter()
            .any(|(time, p)| *p == owner.number && *time <= at);
        Some((owner, gone))
    }

    /// Message `number` of a wire.
    pub fn message(&self, plug: u32, wire: &str, number: u64) -> Option<&Message> {
        let messages = self.wires.get(&(plug, wire.to_string()))?;
        let index = messages.binary_search_by_key(&number, |m| m.number).ok()?;
        messages.get(index)
    }

    /// The moments between which it tells what happened.
    pub fn stretch(&self) -> Option<(Time, Time)> {
        let real = || self.beats.iter().flatten().filter(|b| !b.base);
        let first = real().map(|b| b.step_ns).min()?;
        let last = real().map(|b| b.commit_ns).max()?;
        Some((Time(first), Time(last)))
    }

    /// Whether it begins with the creature's first beats.
    pub fn from_the_beginning(&self) -> bool {
        self.beats
            .iter()
            .all(|beats| beats.first().is_none_or(|b| b.number == 0 && !b.base))
    }

    /// How many beats are missing between the first and the last of each source.
    pub fn beats_missing(&self) -> u64 {
        let missing = |beats: &Vec<Beat>| {
            let (Some(first), Some(last)) = (beats.first(), beats.last()) else {
                return 0;
            };
            last.number + 1 - first.number - beats.len() as u64
        };
        self.beats.iter().map(missing).sum()
    }

    /// How long it is.
    pub fn span(&self) -> Span {
        self.stretch()
            .map_or(Span::ZERO, |(first, last)| last.since(first))
    }

    /// The index of the motor unit among the sources.
    pub fn motor(&self) -> Option<usize> {
        self.manifest.source(MOTOR)
    }
}

/// The kind of message on a channel: the end of its schema's name.
pub(crate) fn kind_of(channel: &mcap::Channel<'_>) -> Kind {
    let name = channel.schema.as_ref().map_or("", |s| s.name.as_str());
    let kind = ipc::message::KINDS
        .into_iter()
        .find(|k| name.strip_prefix("subsumed.") == Some(k.name()));
    kind.unwrap_or(Kind::Pulse)
}
