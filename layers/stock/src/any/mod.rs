//! Messages of any type: where they come from, kept, delayed, chosen between.
pub mod change;
pub mod constant;
pub mod delay;
pub mod given;
pub mod hold;
pub mod latch;
pub mod pulse;
pub mod repeat;
pub mod select;
pub mod source;
