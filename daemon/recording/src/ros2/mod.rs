//! A recording as ROS 2 tools want it: MCAP of the profile `ros2`, messages in CDR, standard types where ROS 2 has one.
//!
//! | recording | export | type |
//! | --- | --- | --- |
//! | `/wires/MODULE.PORT`, `/commands/body.PORT` | `/wires/MODULE/PORT`, `/commands/body/PORT` | by kind: `std_msgs` Empty, Bool, Float64; `geometry_msgs` Vector3Stamped, PoseStamped; `sensor_msgs/LaserScan`; `subsumed_msgs/Polar` |
//! | `/log` | `/rosout` | `rcl_interfaces/Log` |
//! | `/halts`, `/taps`, `/overruns`, `/plugs`, `/losses` | the same | `subsumed_msgs`, defined in the file |
//!
//! The rest of a recording (`/beats`, manifest, creature file) is for replaying it here and stays out.
//!
//! Must never read the live daemon: an export is made of a recording, as often as one likes.

mod messages;

use std::collections::HashMap;
use std::f32::consts::PI;
use std::io::{Seek, Write};

use ipc::message::{Kind, SONARS};
use mcap::records::MessageHeader;
use mcap::{Channel, WriteOptions};
use serde::Serialize;
use serde_json::Value;

use crate::manifest::Manifest;
use crate::reader::{self, Message, kind_of};
use messages::{
    Empty, Halt, Header, LaserScan, Log, Loss, Overrun, Plug, Polar, PoseStamped, Stamp, Tap, Vector3Stamped,
};

/// Before every message: CDR, little-endian.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// The frame of what a sensor on the robot sees, and of where the robot is.
const BODY_FRAME: &str = "base_link";
const WORLD_FRAME: &str = "odom";

/// Writes the recording `bytes` to `out` for ROS 2; returns how many messages.
///
/// # Errors
/// A sentence saying what is wrong with the recording, or that `out` cannot be written to.
pub fn export(bytes: &[u8], out: impl Write + Seek) -> Result<u64, String> {
    let (manifest, ..) = reader::records(bytes)?;
    let options = WriteOptions::new()
        .profile("ros2")
        .library(manifest.program.clone())
        .compression(None);
    let writer = mcap::Writer::with_options(out, options).map_err(unwritten)?;
    let mut export = Export {
        writer,
        manifest,
        channels: HashMap::new(),
        messages: 0,
    };
    let stream = mcap::MessageStream::new_with_options(bytes, mcap::read::Options::IgnoreEndMagic.into())
        .map_err(|e| format!("is no MCAP file: {e}"))?;
    // One that was cut off is read as far as it goes.
    for message in stream.map_while(Result::ok) {
        export.take(&message)?;
    }
    export.writer.finish().map_err(unwritten)?;
    Ok(export.messages)
}

fn unwritten(error: mcap::McapError) -> String {
    format!("cannot be written: {error}")
}

struct Export<W: Write + Seek> {
    writer: mcap::Writer<W>,
    manifest: Manifest,
    channels: HashMap<String, u16>,
    messages: u64,
}

impl<W: Write + Seek> Export<W> {
    fn take(&mut self, message: &mcap::Message<'_>) -> Result<(), String> {
        let topic = message.channel.topic.as_str();
        let wrong = |e: serde_json::Error| format!("has a message on {topic} that cannot be read: {e}");
        let (time, now) = (message.log_time, Stamp::at(message.log_time));
        if topic.starts_with("/wires/") || topic.starts_with("/commands/") {
            let kind = kind_of(&message.channel);
            let told = reader::message(&message.data, kind).map_err(wrong)?;
            let (name, data) = of_wire(kind, &told, now);
            return self.put(
                &ros_name(topic),
                name,
                &message.channel,
                (told.number, time),
                &data,
            );
        }
        if topic.starts_with("/beats/") {
            return Ok(());
        }
        let told: Value = serde_json::from_slice(&message.data).map_err(wrong)?;
        let Some((topic, name, data)) = self.of_rest(topic, &told, now) else {
            return Ok(());
        };
        self.put(topic, name, &message.channel, (0, time), &data)
    }

    /// Topic, type and encoded text of what is not a wire's.
    fn of_rest(
        &self,
        topic: &str,
        told: &Value,
        stamp: Stamp,
    ) -> Option<(&'static str, &'static str, Vec<u8>)> {
        let text = |field: &str| told[field].as_str().unwrap_or_default();
        let count = |field: &str| told[field].as_u64().unwrap_or(0);
        let layer = text("layer");
        Some(match topic {
            "/log" => {
                let log = Log {
                    stamp,
                    // Foxglove counts 2 for information, 3 for warnings; ROS in tens.
                    level: u8::try_from(count("level") * 10).unwrap_or(20),
                    name: text("name"),
                    msg: text("message"),
                    file: "",
                    function: "",
                    line: 0,
                };
                ("/rosout", messages::LOG, cdr(&log))
            }
            "/halts" => {
                let causes = told["causes"].as_array().into_iter().flatten();
                let causes = causes.filter_map(|c| Some(c.as_str()?.to_string())).collect();
                let halted = told["halted"] == true;
                let halt = Halt {
                    stamp,
                    halted,
                    causes,
                };
                ("/halts", messages::HALT, cdr(&halt))
            }
            "/taps" => {
                let tap = Tap {
                    stamp,
                    until: Stamp::at(count("until_ns").saturating_add_signed(self.manifest.offset_ns)),
                    kind: text("kind"),
                    layer,
                    from: text("from"),
                    to: text("to"),
                };
                ("/taps", messages::TAP, cdr(&tap))
            }
            "/overruns" => {
                let (overruns, skipped) = (count("overruns"), count("skipped"));
                let overrun = Overrun {
                    stamp,
                    layer,
                    overruns,
                    skipped,
                };
                ("/overruns", messages::OVERRUN, cdr(&overrun))
            }
            "/plugs" => {
                let attached = told["attached"] == true;
                (
                    "/plugs",
                    messages::PLUG,
                    cdr(&Plug {
                        stamp,
                        layer,
                        attached,
                    }),
                )
            }
            "/losses" => {
                let (what, lost) = (text("what"), count("lost"));
                ("/losses", messages::LOSS, cdr(&Loss { stamp, what, lost }))
            }
            _ => return None,
        })
    }

    fn put(
        &mut self,
        topic: &str,
        name: &str,
        channel: &Channel<'_>,
        (number, time): (u64, u64),
        data: &[u8],
    ) -> Result<(), String> {
        let channel_id = match self.channels.get(topic) {
            Some(id) => *id,
            None => {
                let schema = messages::schema(name);
                let schema = self.writer.add_schema(name, "ros2msg", schema.as_bytes());
                let id = self
                    .writer
                    .add_channel(schema.map_err(unwritten)?, topic, "cdr", &channel.metadata)
                    .map_err(unwritten)?;
                self.channels.insert(topic.into(), id);
                id
            }
        };
        self.messages += 1;
        let header = MessageHeader {
            channel_id,
            sequence: number as u32,
            log_time: time,
            publish_time: time,
        };
        self.writer
            .write_to_known_channel(&header, data)
            .map_err(unwritten)
    }
}

/// Type and text of a wire's message.
fn of_wire(kind: Kind, told: &Message, stamp: Stamp) -> (&'static str, Vec<u8>) {
    let words = &told.words;
    let header = |frame_id| Header { stamp, frame_id };
    match kind {
        Kind::Pulse => {
            let structure_needs_at_least_one_member = 0;
            (
                messages::EMPTY,
                cdr(&Empty {
                    structure_needs_at_least_one_member,
                }),
            )
        }
        Kind::Bit => (messages::BOOL, cdr(&(words[0] != 0.0))),
        Kind::Number => (messages::FLOAT, cdr(&words[0])),
        Kind::Vector => {
            let vector = [words[0], words[1], 0.0];
            let header = header(BODY_FRAME);
            (messages::VECTOR3, cdr(&Vector3Stamped { header, vector }))
        }
        Kind::Polar => {
            let [length, bearing] = [words[0], words[1]];
            let header = header(BODY_FRAME);
            (
                messages::POLAR,
                cdr(&Polar {
                    header,
                    length,
                    bearing,
                }),
            )
        }
        Kind::Map => {
            let step = 2.0 * PI / SONARS as f32;
            let scan = LaserScan {
                header: header(BODY_FRAME),
                angle_min: 0.0,
                angle_max: step * (SONARS - 1) as f32,
                angle_increment: step,
                time_increment: 0.0,
                scan_time: 0.0,
                range_min: 0.0,
                range_max: f32::INFINITY,
                ranges: words[..SONARS].iter().map(|r| *r as f32).collect(),
                intensities: Vec::new(),
            };
            (messages::SCAN, cdr(&scan))
        }
        Kind::Pose => {
            let [x, y, heading] = [words[0], words[1], words[2]];
            let pose = PoseStamped {
                header: header(WORLD_FRAME),
                position: [x, y, 0.0],
                orientation: [0.0, 0.0, (heading / 2.0).sin(), (heading / 2.0).cos()],
            };
            (messages::POSE, cdr(&pose))
        }
    }
}

fn cdr(message: &impl Serialize) -> Vec<u8> {
    let mut bytes = ENCAPSULATION.to_vec();
    let encoded = cdr_encoding::to_vec::<_, byteorder::LittleEndian>(message);
    bytes.extend(encoded.expect("numbers, texts and lists of them can be encoded"));
    bytes
}

/// A topic by the rules of ROS 2: letters, digits and underscores between slashes, no name begins with a digit.
fn ros_name(topic: &str) -> String {
    let mut name = String::with_capacity(topic.len());
    for letter in topic.chars() {
        let letter = match letter {
            '.' => '/',
            l if l.is_ascii_alphanumeric() || l == '/' => l,
            _ => '_',
        };
        if letter.is_ascii_digit() && name.ends_with('/') {
            name.push('_');
        }
        name.push(letter);
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;
    use ipc::clock::Time;

    #[test]
    fn topics_are_names_of_ros() {
        assert_eq!(ros_name("/wires/turn.rate"), "/wires/turn/rate");
        assert_eq!(ros_name("/wires/2nd-arm.x y"), "/wires/_2nd_arm/x_y");
    }

    #[test]
    fn a_message_is_aligned_as_cdr_wants_it() {
        let told = |words: &[f64]| {
            let mut all = [0.0; ipc::message::WORDS_MAX];
            all[..words.len()].copy_from_slice(words);
            Message {
                number: 7,
                stamp: Time(9),
                words: all,
            }
        };
        let stamp = Stamp::at(3_000_000_004);
        assert_eq!(of_wire(Kind::Bit, &told(&[1.0]), stamp).1, [0, 1, 0, 0, 1]);
        let (name, bytes) = of_wire(Kind::Vector, &told(&[1.0, -2.0]), stamp);
        assert_eq!(name, "geometry_msgs/msg/Vector3Stamped");
        let mut wanted = ENCAPSULATION.to_vec();
        wanted.extend([3, 0, 0, 0, 4, 0, 0, 0]);
        wanted.extend([10, 0, 0, 0]);
        wanted.extend(b"base_link\0");
        wanted.extend([0, 0]); // to a multiple of eight, counted after the encapsulation
        for word in [1.0_f64, -2.0, 0.0] {
            wanted.extend(word.to_le_bytes());
        }
        assert_eq!(bytes, wanted);
    }
}
