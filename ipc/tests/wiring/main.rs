//! Creature files and manifests: what is wrong with a file is said, exactly and all at once.

mod golden;
mod kinds;
mod lines;
mod mutation;
mod schema;
