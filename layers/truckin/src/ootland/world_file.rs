//! A world in TOML.
