//! The ROS 2 messages of an export: their fields for the encoder, and their definitions for whoever reads them.
//!
//! Must never differ from the definitions of ROS 2's own packages (common_interfaces, rcl_interfaces): a reader may
//! use its own in place of those in the file.

use serde::Serialize;

/// builtin_interfaces/msg/Time: a time of day.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Stamp {
    sec: i32,
    nanosec: u32,
}

impl Stamp {
    pub(super) fn at(time_of_day_ns: u64) -> Stamp {
        Stamp {
            sec: i32::try_from(time_of_day_ns / 1_000_000_000).unwrap_or(i32::MAX),
            nanosec: (time_of_day_ns % 1_000_000_000) as u32,
        }
    }
}

/// std_msgs/msg/Header.
#[derive(Serialize)]
pub(super) struct Header<'a> {
    pub(super) stamp: Stamp,
    pub(super) frame_id: &'a str,
}

/// std_msgs/msg/Empty; in CDR a structure has at least one member.
#[derive(Serialize)]
pub(super) struct Empty {
    pub(super) structure_needs_at_least_one_member: u8,
}

/// geometry_msgs/msg/Vector3Stamped.
#[derive(Serialize)]
pub(super) struct Vector3Stamped<'a> {
    pub(super) header: Header<'a>,
    pub(super) vector: [f64; 3],
}

/// subsumed_msgs/msg/Polar, ours: ROS 2 has none.
#[derive(Serialize)]
pub(super) struct Polar<'a> {
    pub(super) header: Header<'a>,
    pub(super) length: f64,
    pub(super) bearing: f64,
}

/// sensor_msgs/msg/LaserScan.
#[derive(Serialize)]
pub(super) struct LaserScan<'a> {
    pub(super) header: Header<'a>,
    pub(super) angle_min: f32,
    pub(super) angle_max: f32,
    pub(super) angle_increment: f32,
    pub(super) time_increment: f32,
    pub(super) scan_time: f32,
    pub(super) range_min: f32,
    pub(super) range_max: f32,
    pub(super) ranges: Vec<f32>,
    pub(super) intensities: Vec<f32>,
}

/// geometry_msgs/msg/PoseStamped: position, then the quaternion x, y, z, w.
#[derive(Serialize)]
pub(super) struct PoseStamped<'a> {
    pub(super) header: Header<'a>,
    pub(super) position: [f64; 3],
    pub(super) orientation: [f64; 4],
}

/// rcl_interfaces/msg/Log.
#[derive(Serialize)]
pub(super) struct Log<'a> {
    pub(super) stamp: Stamp,
    pub(super) level: u8,
    pub(super) name: &'a str,
    pub(super) msg: &'a str,
    pub(super) file: &'a str,
    pub(super) function: &'a str,
    pub(super) line: u32,
}

/// subsumed_msgs/msg/Halt.
#[derive(Serialize)]
pub(super) struct Halt {
    pub(super) stamp: Stamp,
    pub(super) halted: bool,
    pub(super) causes: Vec<String>,
}

/// subsumed_msgs/msg/Tap.
#[derive(Serialize)]
pub(super) struct Tap<'a> {
    pub(super) stamp: Stamp,
    pub(super) until: Stamp,
    pub(super) kind: &'a str,
    pub(super) layer: &'a str,
    pub(super) from: &'a str,
    pub(super) to: &'a str,
}

/// subsumed_msgs/msg/Overrun.
#[derive(Serialize)]
pub(super) struct Overrun<'a> {
    pub(super) stamp: Stamp,
    pub(super) layer: &'a str,
    pub(super) overruns: u64,
    pub(super) skipped: u64,
}

/// subsumed_msgs/msg/Plug.
#[derive(Serialize)]
pub(super) struct Plug<'a> {
    pub(super) stamp: Stamp,
    pub(super) layer: &'a str,
    pub(super) attached: bool,
}

/// subsumed_msgs/msg/Loss.
#[derive(Serialize)]
pub(super) struct Loss<'a> {
    pub(super) stamp: Stamp,
    pub(super) what: &'a str,
    pub(super) lost: u64,
}

const TIME: &str = "int32 sec\nuint32 nanosec\n";
const HEADER: &str = "builtin_interfaces/Time stamp\nstring frame_id\n";
const STAMPED: &[(&str, &str)] = &[("std_msgs/Header", HEADER), ("builtin_interfaces/Time", TIME)];
const TIMED: &[(&str, &str)] = &[("builtin_interfaces/Time", TIME)];

/// A message's own definition, and the definitions that it needs.
type Definition = (&'static str, &'static [(&'static str, &'static str)]);

/// The definition of a message by its full name.
fn definition(name: &str) -> Definition {
    const VECTOR: &str = "float64 x\nfloat64 y\nfloat64 z\n";
    match name {
        EMPTY => ("", &[]),
        BOOL => ("bool data\n", &[]),
        FLOAT => ("float64 data\n", &[]),
        VECTOR3 => (
            "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n",
            &[
                ("std_msgs/Header", HEADER),
                ("builtin_interfaces/Time", TIME),
                ("geometry_msgs/Vector3", VECTOR),
            ],
        ),
        POLAR => (
            "# Metres or the unit of the wire; radians, counter-clockwise from straight ahead\n\
             std_msgs/Header header\nfloat64 length\nfloat64 bearing\n",
            STAMPED,
        ),
        SCAN => (
            "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
             float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n\
             float32[] ranges\nfloat32[] intensities\n",
            STAMPED,
        ),
        POSE => (
            "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
            &[
                ("std_msgs/Header", HEADER),
                ("builtin_interfaces/Time", TIME),
                (
                    "geometry_msgs/Pose",
                    "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
                ),
                ("geometry_msgs/Point", VECTOR),
                (
                    "geometry_msgs/Quaternion",
                    "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
                ),
            ],
        ),
        LOG => (
            "byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\n\
             builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n\
             string function\nuint32 line\n",
            TIMED,
        ),
        HALT => (
            "builtin_interfaces/Time stamp\nbool halted\nstring[] causes\n",
            TIMED,
        ),
        TAP => (
            "# A tap's message that took effect, and when its window runs out\n\
             builtin_interfaces/Time stamp\nbuiltin_interfaces/Time until\nstring kind\nstring layer\n\
             string from\nstring to\n",
            TIMED,
        ),
        OVERRUN => (
            "builtin_interfaces/Time stamp\nstring layer\nuint64 overruns\nuint64 skipped\n",
            TIMED,
        ),
        PLUG => (
            "builtin_interfaces/Time stamp\nstring layer\nbool attached\n",
            TIMED,
        ),
        LOSS => ("builtin_interfaces/Time stamp\nstring what\nuint64 lost\n", TIMED),
        other => unreachable!("no message {other} is written"),
    }
}

pub(super) const EMPTY: &str = "std_msgs/msg/Empty";
pub(super) const BOOL: &str = "std_msgs/msg/Bool";
pub(super) const FLOAT: &str = "std_msgs/msg/Float64";
pub(super) const VECTOR3: &str = "geometry_msgs/msg/Vector3Stamped";
pub(super) const POLAR: &str = "subsumed_msgs/msg/Polar";
pub(super) const SCAN: &str = "sensor_msgs/msg/LaserScan";
pub(super) const POSE: &str = "geometry_msgs/msg/PoseStamped";
pub(super) const LOG: &str = "rcl_interfaces/msg/Log";
pub(super) const HALT: &str = "subsumed_msgs/msg/Halt";
pub(super) const TAP: &str = "subsumed_msgs/msg/Tap";
pub(super) const OVERRUN: &str = "subsumed_msgs/msg/Overrun";
pub(super) const PLUG: &str = "subsumed_msgs/msg/Plug";
pub(super) const LOSS: &str = "subsumed_msgs/msg/Loss";

/// The definition as it stands in an MCAP schema of encoding `ros2msg`: the message, then all that it needs.
pub(super) fn schema(name: &str) -> String {
    let (own, needed) = definition(name);
    let mut text = own.to_string();
    for (name, definition) in needed {
        text.push_str(&"=".repeat(80));
        text.push_str(&format!("\nMSG: {name}\n{definition}"));
    }
    text
}
