//! All that two processes of a creature must agree on.
//!
//! - [`body`]: how a daemon and the process that runs its body find each other
//! - [`clock`]: the only place that tells the time, real or virtual
//! - [`message`]: what travels on a wire
//! - [`control`]: how layer processes and tools speak to a daemon
//! - [`tap`]: suppression and inhibition, as pure functions
//! - [`wire`]: cells, pages, registers and outlets, in plain memory or over iceoryx2
//! - [`wiring`]: creature files and manifests, read and checked
//!
//! Must never know a behaviour or a body.

pub mod body;
pub mod clock;
pub mod control;
pub mod message;
pub mod tap;
pub mod wire;
pub mod wiring;
