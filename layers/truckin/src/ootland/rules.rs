//! The numbers of the game, in cents, minutes and millilitres (Gantchev 2001, 2.1.2).

/// Length of a time slot.
pub const SLOT_MINUTES: i32 = 10;
/// Length of a step between neighbouring corners; trucks drive at 100 km/h.
pub const STEP_KILOMETRES: i32 = 10;
/// Time of a step.
pub const STEP_MINUTES: i32 = 6;
/// Gas of a step; 10 litres for 100 kilometres.
pub const STEP_MILLILITRES: i32 = 1_000;
/// A full tank, which every truck starts with.
pub const TANK_MILLILITRES: i32 = 50_000;
/// Millilitres in the litre that gas is sold by.
pub const LITRE_MILLILITRES: i32 = 1_000;
/// What every truck starts with.
pub const TRUCK_CAPITAL_CENTS: i64 = 50_000;
/// Time of a telephone call to a dealer who trades something.
pub const CALL_MINUTES: i32 = 3;
/// Price of a telephone call to a dealer who trades something.
pub const CALL_CENTS: i64 = 300;
/// Time of a telephone call to a dealer who trades nothing.
pub const FAILED_CALL_MINUTES: i32 = 1;
/// Price of a telephone call to a dealer who trades nothing.
pub const FAILED_CALL_CENTS: i64 = 100;
/// Items in a crate (the example of 1.1.1).
pub const ITEMS_PER_CRATE: i32 = 100;
/// Trucks in a game at most; the largest game of the source has 20.
pub const TRUCKS_MAX: usize = 100;
/// Slots in a game at most, so that minutes fit in 32 bits with room to spare.
pub const SLOTS_MAX: u32 = 10_000_000;
/// Price of an item or a litre at most, in cents: a hundred of them still fit in 32 bits.
pub const UNIT_CENTS_MAX: i32 = 10_000_000;
/// Price of a crate at most, in cents.
pub const CRATE_CENTS_MAX: i32 = 10_000_000;
/// Units of one commodity on a truck at most. The source sets no limit; this one is far beyond what a
/// game of the largest length brings about and keeps sums in 32 bits, values in 64.
pub const LOAD_UNITS_MAX: i32 = 1_000_000_000;
