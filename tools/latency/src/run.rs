//! A run: the creature under a load, then paired rounds under the same load, until the time or patience is over.
//!
//! Must never lose what was measured: an interruption ends the run early and everything is still reported.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use daemon::executor::host;
use indicatif::{ProgressBar, ProgressStyle};
use ipc::clock::Span;
use ipc::wiring::creature::Wake;

use crate::across::{self, Heard};
use crate::churn::Churn;
use crate::command::Reference;
use crate::company::{Company, intervals};
use crate::compare;
use crate::creature::{self, Alive, Kept};
use crate::gate::{Compared, Verdict};
use crate::load::{Load, Loaded};
use crate::neighbour::Neighbour;
use crate::pair::{self, CONTESTS, Contest, Round};
use crate::plant::Plant;
use crate::track::Track;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Asked {
    /// What else the processor has to do.
    pub load: Load,
    /// How long the creature is measured.
    pub length: Duration,
    /// The processor under test.
    pub cpu: usize,
    /// Another one, for whatever is not measured; the same where there is only one.
    pub other_cpu: usize,
    /// SCHED_FIFO priority in paired rounds.
    pub priority: u8,
    /// Time between two beats.
    pub period: Span,
    /// How long is spun before a beat where it is.
    pub spin: Span,
    /// Whether the creature spins.
    pub creature_spins: bool,
    /// What is measured against, if anything.
    pub against: Option<Reference>,
    /// Paired rounds of each contest.
    pub rounds: usize,
    /// Whether rounds are added, up to [`ROUNDS_MORE`] times as many, while a limit is not kept.
    pub to_the_end_of_doubt: bool,
    /// How long each is.
    pub round: Duration,
    /// What is planted.
    pub plant: Option<Plant>,
}

/// What was measured.
#[derive(Debug)]
pub struct Outcome {
    /// When it began.
    pub began: SystemTime,
    /// The creature's layers, then both sides of every contest.
    pub tracks: Vec<Track>,
    /// What the host counted of the threads.
    pub kept: Vec<Kept>,
    /// The rounds against cyclictest.
    pub rounds: Vec<Round>,
    /// The rounds across processes.
    pub across: Vec<across::Round>,
    /// Rounds across processes whose listener was kept from listening.
    pub unheard: usize,
    /// Who came and went in each interval of the creature's tracks.
    pub company: Vec<Company>,
    /// Who came, left or was killed.
    pub churn_events: u64,
    /// What the host refused.
    pub refusals: Vec<String>,
    /// Whether it was interrupted.
    pub interrupted: bool,
}

/// How many times the asked-for rounds are added at most where a limit is not kept.
pub const ROUNDS_MORE: usize = 2;

/// Seconds that a round takes beyond its length: both sides begin at a full second.
const ROUND_EXTRA: Duration = Duration::from_millis(2500);

/// Runs what was asked for.
///
/// # Errors
/// When something cannot be started.
pub fn run(asked: &Asked) -> Result<Outcome, String> {
    let leave = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register(signal, leave.clone()).map_err(|e| e.to_string())?;
    }
    if asked.against == Some(Reference::Blackboard) && asked.cpu == asked.other_cpu {
        return Err("--against blackboard: expected two processors, one for each process".into());
    }
    let contests = match asked.against {
        Some(Reference::Cyclictest) => CONTESTS.len(),
        Some(Reference::Blackboard) => 1,
        None => 0,
    };
    let paired = (asked.round + ROUND_EXTRA) * (asked.rounds * contests) as u32;
    let progress = Progress::new(asked.length + paired);
    let mut outcome = Outcome {
        began: SystemTime::now(),
        tracks: Vec::new(),
        kept: Vec::new(),
        rounds: Vec::new(),
        across: Vec::new(),
        unheard: 0,
        company: Vec::new(),
        churn_events: 0,
        refusals: Vec::new(),
        interrupted: false,
    };
    let load = Loaded::start(asked.load, asked.cpu).map_err(|e| format!("starting a load: {e}"))?;
    if asked.length > Duration::ZERO {
        measure_creature(asked, &leave, &progress, &mut outcome)?;
        // Whoever is started from here on is bound by what it is told, not by what the creature kept off.
        host::roam();
    }
    let setting = pair::Setting {
        cpu: asked.cpu,
        main_cpu: asked.other_cpu,
        priority: asked.priority,
        period: asked.period,
        spin: asked.spin,
        round: asked.round,
        plant: asked.plant,
    };
    let looking = || {
        progress.tick();
        leave.load(Ordering::Relaxed)
    };
    for n in 0..asked.rounds * (1 + ROUNDS_MORE) {
        if n >= asked.rounds && !(asked.to_the_end_of_doubt && in_doubt(&outcome)) {
            break;
        }
        let round = format!("round {} of {}", n + 1, asked.rounds.max(n + 1));
        let say = |what: &str| progress.say(&format!("{round}: {what}"));
        let goes_on = match asked.against {
            Some(Reference::Cyclictest) => {
                round_of_pairs(&setting, n % 2 == 1, &looking, &say, &mut outcome)?
            }
            Some(Reference::Blackboard) => {
                say("to another process");
                outcome.keep_across(across::round(&setting, &looking)?, asked.round)
            }
            None => false,
        };
        if !goes_on {
            break;
        }
    }
    drop(load);
    progress.end();
    outcome.interrupted = leave.load(Ordering::Relaxed);
    Ok(outcome)
}

/// Whether some limit is not kept by the rounds so far.
fn in_doubt(outcome: &Outcome) -> bool {
    let kept = |c: &Compared| c.verdict().is_none_or(|v| v == Verdict::Passes);
    !compare::rounds(outcome).iter().all(kept)
}

/// Every contest once; says whether there is time for the next round.
fn round_of_pairs(
    setting: &pair::Setting,
    swapped: bool,
    looking: &dyn Fn() -> bool,
    say: &dyn Fn(&str),
    outcome: &mut Outcome,
) -> Result<bool, String> {
    for contest in CONTESTS {
        say(contest.sides().0);
        match pair::round(setting, contest, swapped, looking).map_err(|e| e.to_string())? {
            Some(round) => outcome.keep(round, setting.round),
            None => return Ok(false),
        }
    }
    Ok(true)
}

fn measure_creature(
    asked: &Asked,
    leave: &AtomicBool,
    progress: &Progress,
    outcome: &mut Outcome,
) -> Result<(), String> {
    let wake = if asked.creature_spins {
        Wake::Spin(asked.spin)
    } else {
        Wake::Sleep
    };
    let mut alive = Alive::start(&creature::Setting {
        cpu: asked.cpu,
        period: asked.period,
        wake,
    })?;
    outcome.refusals = alive.refusals();
    let churning = asked.load == Load::Churn;
    let neighbour = churning.then(|| Neighbour::start(asked.other_cpu, asked.period));
    let neighbour = neighbour.transpose()?;
    let intervals = intervals(asked.length, churning);
    let piece = asked.length / intervals;
    progress.say(&format!(
        "the creature {} under load {}",
        alive.name,
        asked.load.name()
    ));
    for n in 0..intervals {
        let end = Instant::now() + piece;
        let company = match churning {
            true => Company::TURNS[n as usize % Company::TURNS.len()],
            false => Company::Nobody,
        };
        let host = match company {
            Company::Nobody => None,
            Company::Elsewhere => neighbour.as_ref().map(|n| &n.name),
            Company::Here => Some(&alive.name),
        };
        let mut churn = host.map(|name| Churn::new(name, asked.other_cpu));
        while Instant::now() < end && !leave.load(Ordering::Relaxed) {
            if let Some(churn) = &mut churn {
                churn.tick().map_err(|e| format!("churn: {e}"))?;
            }
            alive.drain();
            progress.tick();
            std::thread::sleep(Duration::from_millis(20));
        }
        alive.look(true);
        outcome.company.push(company);
        if let Some(ended) = churn {
            if company == Company::Here {
                outcome.churn_events += ended.events();
            }
            drop(ended);
            // Those killed at the end are cleaned up in nobody's interval.
            std::thread::sleep(Duration::from_millis(100));
            alive.look(false);
        }
        if leave.load(Ordering::Relaxed) {
            break;
        }
    }
    let (tracks, kept) = alive.finish();
    outcome.tracks = tracks;
    outcome.kept = kept;
    Ok(())
}

impl Outcome {
    /// The track of this name and metric, a new one if need be.
    fn track(&mut self, name: &str, metric: &'static str) -> &mut Track {
        let known = self
            .tracks
            .iter()
            .position(|t| t.of == name && t.metric == metric);
        let place = known.unwrap_or_else(|| {
            self.tracks.push(Track::new(name, metric));
            self.tracks.len() - 1
        });
        &mut self.tracks[place]
    }

    /// When a round of this length that has just ended began.
    fn since_began(&self, length: Duration) -> Duration {
        let now = SystemTime::now().duration_since(self.began).unwrap_or_default();
        now.saturating_sub(length)
    }

    /// Keeps what a round across processes came to; says whether there is time for the next.
    fn keep_across(&mut self, heard: Heard, length: Duration) -> bool {
        let round = match heard {
            Heard::All(round) => round,
            Heard::TooLittle => {
                self.unheard += 1;
                return true;
            }
            Heard::Left => return false,
        };
        let began = self.since_began(length);
        for (means, ages) in across::MEANS.iter().zip(round.iter()) {
            self.track(means.name(), "to-process")
                .add(began, length, ages.clone());
        }
        self.across.push(*round);
        true
    }

    fn keep(&mut self, round: Round, length: Duration) {
        let began = self.since_began(length);
        let (ours, other) = round.contest.sides();
        for (name, side) in [(ours, &round.sides[0]), (other, &round.sides[1])] {
            for (metric, h) in [
                ("wake-up", &side.wake_up),
                ("period-error", &side.period_error),
                ("response", &side.response),
            ] {
                // The reference has no step; its response is its wake-up.
                if metric == "response" && name.starts_with("cyclictest") {
                    continue;
                }
                self.track(name, metric).add(began, length, h.clone());
            }
        }
        for refusal in &round.refusals {
            if !self.refusals.contains(refusal) {
                self.refusals.push(refusal.clone());
            }
        }
        let thread = format!("probe ({})", ours);
        let known = self.kept.iter().position(|k| k.thread == thread);
        let place = known.unwrap_or_else(|| {
            self.kept.push(Kept {
                thread,
                tid: 0,
                beats: 0,
                missed: 0,
                missed_in_row_max: 0,
                skipped: 0,
                identity_faults: 0,
                faults: 0,
                sleeps: 0,
            });
            self.kept.len() - 1
        });
        let kept = &mut self.kept[place];
        kept.beats += round.beats;
        kept.faults += round.host.faults;
        kept.sleeps += round.host.sleeps;
        self.rounds.push(round);
    }

    /// The rounds of one contest.
    pub fn rounds_of(&self, contest: Contest) -> impl Iterator<Item = &Round> {
        self.rounds.iter().filter(move |r| r.contest == contest)
    }
}

/// A bar with the time that is left, on a terminal.
struct Progress {
    bar: ProgressBar,
    began: Instant,
    length: Duration,
}

impl Progress {
    fn new(length: Duration) -> Progress {
        let bar = ProgressBar::new(length.as_millis() as u64);
        let style = ProgressStyle::with_template("{bar:32} {percent:>3} %  {eta} left  {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Progress {
            bar,
            began: Instant::now(),
            length,
        }
    }

    fn say(&self, text: &str) {
        self.bar.set_message(text.to_string());
        self.tick();
    }

    fn tick(&self) {
        let passed = self.began.elapsed().min(self.length);
        self.bar.set_position(passed.as_millis() as u64);
    }

    fn end(&self) {
        self.bar.finish_and_clear();
    }
}
