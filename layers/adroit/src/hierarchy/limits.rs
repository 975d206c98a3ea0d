//! Every bound of a hierarchy, each with where its number comes from.

/// Most RMs in one hierarchy; an index into the arenas is 16 bits wide, the rest is room for the eye.
pub const MECHANISMS_MAX: usize = 4096;

/// Most RMs at one level: the conflicts of a level are one 64-bit word for each RM.
pub const WIDTH_MAX: usize = 64;

/// Most levels one above another, subroutines included; bounds the recursion and so the stack.
pub const DEPTH_MAX: usize = 16;

/// Most inputs of one RM.
pub const INPUTS_MAX: usize = 64;

/// Most MCUs put to work by one evaluation; more than one only where equal outputs do not conflict.
pub const OUTPUTS_MAX: usize = 8;
