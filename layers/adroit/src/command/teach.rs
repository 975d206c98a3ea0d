//! `adroit teach`: someone whistles before every order, until the whistle alone is obeyed.

use std::fs;
use std::path::PathBuf;

use clap::Args;

use crate::learning::Learner;
use crate::nest::{Layout, Run, generate};

/// A lesson takes this long: the onset of the cue, half a second later the order, then something else.
const LESSON_S: (f64, f64, f64) = (0.5, 1.0, 30.0);
/// Lessons until a teacher gives up.
const LESSONS_MAX: u32 = 50;

#[derive(Args, Clone, Debug)]
pub(super) struct TeachArgs {
    /// Seed of the world
    #[arg(long, default_value_t = 4)]
    seed: u64,
    /// Write the program with what was learned to this file
    #[arg(long)]
    save: Option<PathBuf>,
    /// Have it forget again at the end
    #[arg(long)]
    forget: bool,
}

/// A robot that is taught.
struct Class {
    run: Run,
    learner: Learner,
}

impl Class {
    fn pass(&mut self, seconds: f64) -> Result<Vec<String>, String> {
        let mut learned = Vec::new();
        let end_s = self.run.world.now_s + seconds;
        while self.run.world.now_s < end_s {
            self.run.beat();
            let found = self
                .learner
                .observe(self.run.world.now_s, &self.run.world, &mut self.run.control)
                .map_err(|problems| problems.to_string())?;
            learned.extend(found.map(|found| found.command()));
        }
        Ok(learned)
    }

    /// A whistle, and half a second later an order.
    fn lesson(&mut self) -> Result<Vec<String>, String> {
        let (before_s, together_s, after_s) = LESSON_S;
        self.run.world.whistle = true;
        let mut learned = self.pass(before_s)?;
        self.run.world.order();
        learned.extend(self.pass(together_s)?);
        self.run.world.whistle = false;
        learned.extend(self.pass(after_s)?);
        Ok(learned)
    }

    /// What a whistle alone releases.
    fn whistle(&mut self) -> Result<&'static str, String> {
        self.pass(20.0)?;
        self.run.world.whistle = true;
        self.pass(1.5)?;
        self.run.world.whistle = false;
        Ok(if self.run.active("nest-building") {
            "nest building"
        } else {
            "nothing"
        })
    }
}

pub(super) fn teach(args: &TeachArgs) -> Result<(), String> {
    let mut world = generate(
        args.seed,
        Layout {
            persons: 0,
            ..Layout::default()
        },
    );
    world.cold = false;
    let mut class = Class {
        run: Run::new(world),
        learner: Learner::new(),
    };
    class.pass(60.0)?;
    for lesson in 1..=LESSONS_MAX {
        let learned = class.lesson()?;
        for command in &learned {
            println!("experience {lesson}: applied: {command}");
        }
        if !learned.is_empty() {
            break;
        }
        if let Some(strongest) = class.learner.associations(&class.run.control).first() {
            let what = if strongest.proposed {
                "proposed"
            } else {
                "observed"
            };
            println!(
                "experience {lesson}: {what}: {} (evidence {:.1})",
                strongest.command(),
                strongest.evidence
            );
        }
    }
    if class.run.control.list().is_empty() {
        return Err(format!("nothing was learned in {LESSONS_MAX} lessons"));
    }
    println!("a whistle alone releases {}", class.whistle()?);
    if args.forget {
        let Class { run, learner } = &mut class;
        learner
            .forget("whistle", "nest-building", &mut run.control)
            .map_err(|problems| problems.to_string())?;
        println!("forgotten; a whistle alone releases {}", class.whistle()?);
    }
    if let Some(path) = &args.save {
        fs::write(path, class.run.control.text()).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}
