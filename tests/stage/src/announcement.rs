//! An announcement: what a layer with one wire and one tap says to be let in.
//!
//! Must never ask for more than any creature grants the same user.

use ipc::clock::Span;
use ipc::control::{Plug, PlugTap};
use ipc::message::Kind;
use ipc::wiring::creature::How;
use ipc::wiring::directory::Listed;

/// What layer `layer` of level 1 announces to the daemon of `creature`, which runs Allen: a wire `LAYER.heading`,
/// written every `period`, that suppresses `turn.heading` for `time_constant`. The page of that wire is the only
/// one of the owner it names.
pub fn announcement(creature: &str, layer: &str, period: Span, time_constant: Span) -> Plug {
    let port = format!("{layer}.heading");
    let owner = format!("{creature}/{layer}");
    Plug {
        layer: layer.into(),
        level: 1,
        period,
        pid: std::process::id(),
        owner: owner.clone(),
        outputs: vec![Listed {
            name: port.clone(),
            kind: Kind::Polar,
            unit: String::new(),
            level: Some(1),
            owner,
            index: 0,
            plug: 0,
        }],
        taps: vec![PlugTap {
            how: How::Suppress,
            from: port,
            to: "turn.heading".into(),
            time_constant,
        }],
        ..Plug::default()
    }
}
