//! What `subsumed` and `subsumed-body` may be told on their command lines.
//!
//! Must never do anything with it; manual pages and completions are made from this as well.

use std::path::PathBuf;

use clap::Parser;

use crate::recorder::{Settings, flight};

/// Runs a subsumption creature on real-time threads, with its wires in shared memory.
#[derive(Parser, Debug)]
#[command(
    name = "subsumed",
    version,
    after_help = "Examples:\n  \
    subsumed                                the built-in creature Allen in its office\n  \
    subsumed --creature mine.toml           a creature of your own\n  \
    subsumed --headless --seconds 60        one minute, nothing to look at\n  \
    subsumed --name jerry --page-port 0     a second instance beside the first\n  \
    subsumed --body hall                    the body lives in another process: `subsumed-body --name hall`\n  \
    subsumed --record run.mcap              everything that happens, from the first beat on\n  \
    subsumed --metrics-port 9464            numbers for Prometheus\n\n\
    Ctrl-C halts the body, then leaves. SIGHUP checks the creature file again and says what a restart would change.\n\
    Status: 0 after a signal or --seconds; 1 when the host refuses; 2 for bad input."
)]
pub struct Options {
    /// The creature file; without it, Allen
    #[arg(long, value_name = "FILE")]
    pub creature: Option<PathBuf>,
    /// Name of this instance; the creature's own if not given
    #[arg(long)]
    pub name: Option<String>,
    /// Name of the process that runs the body (see `subsumed-body`); without it, this one does
    #[arg(long, value_name = "NAME")]
    pub body: Option<String>,
    /// Port of the live page; 0 for any that is free
    #[arg(long, default_value_t = 4686, value_name = "N")]
    pub page_port: u16,
    /// Address of the live page; any but a loopback one needs --page-token
    #[arg(long, default_value = "127.0.0.1", value_name = "IP")]
    pub page_address: std::net::IpAddr,
    /// File with the token (16 characters or more) that others than this machine have to send to see the live page
    /// and to press its buttons; neither is encrypted
    #[arg(long, value_name = "FILE")]
    pub page_token: Option<PathBuf>,
    /// No live page
    #[arg(long)]
    pub no_page: bool,
    /// Nothing to look at: no page, and only warnings on the terminal
    #[arg(long)]
    pub headless: bool,
    /// Leave after N seconds
    #[arg(long, value_name = "N")]
    pub seconds: Option<f64>,
    /// Seed of everything random, instead of the creature file's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Where the flight recorder keeps the last minute before a halt, or `off`; without it $STATE_DIRECTORY,
    /// $XDG_STATE_HOME/subsumed or ~/.local/state/subsumed
    #[arg(long, value_name = "FOLDER")]
    pub flight_recorder: Option<PathBuf>,
    /// Record everything from the first beat on into an MCAP file
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Take commands to the creature's hierarchy of releasing mechanisms at a Unix socket:
    /// `subsumectl adroit apply|list|undo|save --socket PATH`
    #[arg(long, value_name = "PATH")]
    pub commands: Option<PathBuf>,
    /// Serve metrics (OpenMetrics) at http://127.0.0.1:N/metrics; 0 for any port that is free
    #[arg(long, value_name = "N")]
    pub metrics_port: Option<u16>,
    /// Serve metrics over HTTP on a Unix socket
    #[arg(long, value_name = "PATH")]
    pub metrics_socket: Option<PathBuf>,
}

impl Options {
    /// What is to be recorded of the creature with this file.
    pub fn recorder(&self, file: String) -> Settings {
        let flight = match &self.flight_recorder {
            None => Some(flight::default_folder()),
            Some(off) if off.as_os_str() == "off" => None,
            Some(folder) => Some(folder.clone()),
        };
        Settings {
            file,
            flight,
            record: self.record.clone(),
        }
    }
}

/// Runs a creature's simulated body in a process of its own, beside the daemon.
#[derive(Parser, Debug)]
#[command(
    name = "subsumed-body",
    version,
    after_help = "Examples:\n  \
    subsumed-body --name hall &           Allen's office, as body \"hall\"\n  \
    subsumed --body hall                  the daemon that drives it\n\n\
    The body is halted until a daemon drives it, and whenever the daemon is dead, frozen or hangs.\n\
    Status: 0 after a signal or --seconds; 1 when the host refuses; 2 for bad input."
)]
pub struct BodyOptions {
    /// The creature file whose `body` table is run; without it, Allen's
    #[arg(long, value_name = "FILE")]
    pub creature: Option<PathBuf>,
    /// Name by which the daemon finds it; the creature's own if not given
    #[arg(long)]
    pub name: Option<String>,
    /// Leave after N seconds
    #[arg(long, value_name = "N")]
    pub seconds: Option<f64>,
    /// Seed of everything random, instead of the creature file's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
}
