//! The page with a made-up creature behind it, to look at the page without a daemon.
//!
//! `cargo run -p page --example demo -- [port] [speed]`; the address is printed.

mod floor;
mod graph;
mod moving;

use std::net::SocketAddr;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use page::{Source, serve};
use serde_json::{Value, json};

/// What the two buttons change.
struct Buttons {
    halted: bool,
    halted_at_s: f64,
    cause: &'static str,
    resets: u32,
    stood_s: f64,
}

/// A creature that is a function of the time.
struct Demo {
    begun: Instant,
    speed: f64,
    buttons: Mutex<Buttons>,
}

impl Demo {
    fn time_s(&self) -> f64 {
        self.begun.elapsed().as_secs_f64() * self.speed
    }

    fn halt_state(&self, buttons: &Buttons, time_s: f64) -> Value {
        let causes: Vec<&str> = if buttons.halted {
            vec![buttons.cause]
        } else {
            Vec::new()
        };
        json!({
            "halted": buttons.halted, "causes": causes,
            "since_s": buttons.halted_at_s, "latched": buttons.halted && buttons.cause == "operator",
            "now_s": time_s,
        })
    }
}

impl Source for Demo {
    fn plan(&self) -> String {
        json!({
            "creature": "allen", "body": "office", "floor": floor::plan(), "robot_radius_m": 0.2,
            "graph": graph::graph(),
        })
        .to_string()
    }

    fn state(&self) -> String {
        let time_s = self.time_s();
        let Ok(buttons) = self.buttons.lock() else {
            return "{}".to_owned();
        };
        let stood_s = buttons.stood_s
            + if buttons.halted {
                time_s - buttons.halted_at_s
            } else {
                0.0
            };
        let mut state = moving::state(time_s, time_s - stood_s, buttons.halted);
        if let Some(fields) = state.as_object_mut() {
            fields.insert("halt".to_owned(), self.halt_state(&buttons, time_s));
        }
        state.to_string()
    }

    fn timeline(&self, after: u64) -> String {
        moving::timeline(self.time_s(), after)
    }

    fn halt(&self) {
        let time_s = self.time_s();
        if let Ok(mut buttons) = self.buttons.lock()
            && !buttons.halted
        {
            buttons.halted = true;
            buttons.halted_at_s = time_s;
            buttons.cause = "operator";
        }
    }

    fn reset(&self) -> Result<(), String> {
        let time_s = self.time_s();
        let Ok(mut buttons) = self.buttons.lock() else {
            return Err("broken".to_owned());
        };
        buttons.resets += 1;
        if !buttons.halted {
            return Err("the creature is not halted".to_owned());
        }
        if buttons.resets % 3 == 2 {
            return Err("the emergency stop button is still pressed: pull it out, then reset".to_owned());
        }
        buttons.halted = false;
        buttons.stood_s += time_s - buttons.halted_at_s;
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let port: u16 = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let speed: f64 = arguments.next().map_or(Ok(1.0), |text| text.parse())?;
    let halted = arguments.next().is_some_and(|word| word == "halted");
    let demo = Demo {
        begun: Instant::now(),
        speed,
        buttons: Mutex::new(Buttons {
            halted,
            halted_at_s: 0.0,
            cause: "start",
            resets: 0,
            stood_s: 0.0,
        }),
    };
    let server = serve(SocketAddr::from(([127, 0, 0, 1], port)), Arc::new(demo))?;
    println!("http://{}/", server.address());
    loop {
        std::thread::sleep(Duration::from_secs(3600));
    }
}
