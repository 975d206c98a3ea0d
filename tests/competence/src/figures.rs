//! What one trial comes to: one robot, one seed, so many simulated hours.
//!
//! Plain numbers; nothing here runs a creature.

use serde::Serialize;

/// A contact of the robot's own making: enough to find it again, since every trial can be repeated.
#[derive(Clone, Debug, Serialize)]
pub struct Caused {
    /// Which robot, counted from 1.
    pub robot: usize,
    /// When, s of simulated time since the trial began.
    pub time_s: f64,
    /// Name of the thing or person, as the office has it.
    pub other: String,
    /// The robot's own speed towards it, m/s.
    pub approach_m_s: f64,
    /// Where the robot truly was, m.
    pub at: (f64, f64),
}

/// The figures of one robot in one trial. Rates are for each hour.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Figures {
    /// The trial's seed.
    pub seed: u64,
    /// Simulated hours.
    pub hours: f64,
    /// Contacts that the robot caused: its own speed towards the thing was above 1 cm/s.
    pub caused: f64,
    /// What they were with, when and how fast.
    pub caused_with: Vec<Caused>,
    /// Contacts in all.
    pub contacts: f64,
    /// Halts of a robot that moved.
    pub halts: f64,
    /// Metres gone.
    pub distance_m: f64,
    /// Floor that the robot's middle was on, m², in squares of half a metre.
    pub area_m2: f64,
    /// Rooms and stretches of corridor that it was in.
    pub rooms: f64,
    /// Places set out for.
    pub chosen: f64,
    /// Those reached: the robot says so, and truly is within a metre of the place.
    pub reached: f64,
    /// Seconds from setting out to reaching, summed over those reached.
    pub reaching_s: f64,
    /// Seconds in which it had kept within a quarter of a metre for half a minute.
    pub stuck_s: f64,
    /// Farthest from where it began, m.
    pub drift_m: f64,
    /// Messages of taps that were no message, and were refused.
    pub refused: f64,
    /// Times it ran out of charge, and charges begun; only with a battery.
    pub flat: f64,
    /// Charges begun.
    pub charges: f64,
}

/// A column of the table.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its heading.
    pub title: &'static str,
    /// What it counts, in one line.
    pub about: &'static str,
    /// One trial's figure, and by what it is divided: the column's value is the sum over the sum.
    pub of: fn(&Figures) -> (f64, f64),
    /// Decimals that mean something.
    pub decimals: usize,
}

/// Every column, left to right.
pub const COLUMNS: &[Column] = &[
    Column {
        title: "caused/h",
        about: "contacts with the robot's own speed towards the thing above 1 cm/s",
        of: |f| (f.caused, f.hours),
        decimals: 2,
    },
    Column {
        title: "contacts/h",
        about: "contacts in all, those of people who walk into the robot included",
        of: |f| (f.contacts, f.hours),
        decimals: 1,
    },
    Column {
        title: "halts/h",
        about: "halts by the reflex while the robot moved",
        of: |f| (f.halts, f.hours),
        decimals: 0,
    },
    Column {
        title: "distance m/h",
        about: "way truly gone",
        of: |f| (f.distance_m, f.hours),
        decimals: 0,
    },
    Column {
        title: "area m2",
        about: "floor that its middle was on, in squares of half a metre",
        of: |f| (f.area_m2, 1.0),
        decimals: 1,
    },
    Column {
        title: "rooms",
        about: "rooms and stretches of corridor that it was in",
        of: |f| (f.rooms, 1.0),
        decimals: 1,
    },
    Column {
        title: "chosen/h",
        about: "distant places set out for",
        of: |f| (f.chosen, f.hours),
        decimals: 1,
    },
    Column {
        title: "reached/h",
        about: "those reached, to within a metre in truth",
        of: |f| (f.reached, f.hours),
        decimals: 1,
    },
    Column {
        title: "reached %",
        about: "share of the places set out for that were reached",
        of: |f| (100.0 * f.reached, f.chosen),
        decimals: 1,
    },
    Column {
        title: "time s",
        about: "mean time from setting out to reaching",
        of: |f| (f.reaching_s, f.reached),
        decimals: 0,
    },
    Column {
        title: "stuck %",
        about: "share of the time in which it had kept within 25 cm for 30 s",
        of: |f| (100.0 * f.stuck_s, 3600.0 * f.hours),
        decimals: 1,
    },
    Column {
        title: "charges/h",
        about: "times it came home to charge",
        of: |f| (f.charges, f.hours),
        decimals: 1,
    },
    Column {
        title: "flat/h",
        about: "times it ran out of charge",
        of: |f| (f.flat, f.hours),
        decimals: 2,
    },
    Column {
        title: "farthest m",
        about: "farthest from where it began",
        of: |f| (f.drift_m, 1.0),
        decimals: 2,
    },
];

/// The column called `title`.
///
/// # Panics
/// If there is none.
pub fn column(title: &str) -> &'static Column {
    let found = COLUMNS.iter().find(|c| c.title == title);
    found.unwrap_or_else(|| panic!("there is no column {title:?}"))
}
