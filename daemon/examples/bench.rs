//! A body process in a few lines: a bench that has Allen's ports, and shows instead of obeying.
//!
//! `cargo run -p daemon --example bench`, then `subsumed --body bench`. A driver of real hardware looks the
//! same: its `tick` writes `motion` to the device and `tell`s what the device measured. While the daemon is
//! gone, frozen or hangs, `motion` reads zero.

use daemon::body::process::{self, Body};
use daemon::body::{World, WorldEnd, office};
use ipc::clock::{Span, Time};

struct Bench;

impl World for Bench {
    fn tick(&mut self, _now: Time, link: &mut WorldEnd) {
        println!(
            "turn {:+.2} rad/s, forward {:+.2} m/s",
            link.motion(1)[0],
            link.motion(2)[0]
        );
    }
}

fn main() -> std::process::ExitCode {
    process::main(Body {
        name: "bench".into(),
        kind: &office::KIND,
        period: Span::millis(20),
        world: Box::new(Bench),
        limit: None,
    })
}
