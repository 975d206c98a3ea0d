//! The plane: vectors, bearings and poses, taken apart and put together.
pub mod cartesian;
pub mod join;
pub mod nearest;
pub mod polar;
pub mod split;
