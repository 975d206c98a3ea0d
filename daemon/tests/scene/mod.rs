//! The scene: the stage on which real processes are tried, with panics in the place of errors, and the daemon's own
//! programs on it.
#![allow(dead_code)] // each test file uses its part of it

use std::path::{Path, PathBuf};
use std::process::ExitStatus;

use ipc::control::{Reply, Request};
use rustix::process::Signal;
use serde_json::Value;

/// A test's own domain and run directory.
pub(crate) struct Scene(stage::Stage);

impl std::ops::Deref for Scene {
    type Target = stage::Stage;

    fn deref(&self) -> &stage::Stage {
        &self.0
    }
}

impl Scene {
    pub(crate) fn new(test: &str) -> Scene {
        let stage = stage::Stage::new(&format!("{test}{}", std::process::id()));
        Scene(stage.unwrap_or_else(|e| panic!("{e}")))
    }

    /// The one that this process was started on; none if it was not.
    pub(crate) fn inherited() -> Option<Scene> {
        stage::Stage::inherited().map(Scene)
    }

    /// Starts a program.
    pub(crate) fn start(&self, program: impl AsRef<Path>, arguments: &[&str]) -> Player {
        self.start_with(program, arguments, &[])
    }

    /// The same with further variables.
    pub(crate) fn start_with(
        &self,
        program: impl AsRef<Path>,
        arguments: &[&str],
        variables: &[(&str, &str)],
    ) -> Player {
        let player = self.0.start_with(program, arguments, variables);
        Player(player.unwrap_or_else(|e| panic!("{e}")))
    }

    /// A daemon with Allen, level 0; ends by itself after two minutes.
    pub(crate) fn daemon(&self, name: &str, arguments: &[&str]) -> Player {
        let mut all = vec!["--name", name, "--headless", "--seconds", "120"];
        all.extend(arguments);
        let player = self.start(env!("CARGO_BIN_EXE_subsumed"), &all);
        wait_for(&format!("daemon {name} answers"), || {
            self.ask(name, &Request::Status).is_some()
        });
        player
    }

    /// A body process with Allen's office.
    pub(crate) fn body(&self, name: &str) -> Player {
        let program = env!("CARGO_BIN_EXE_subsumed-body");
        self.start(program, &["--name", name, "--seconds", "120"])
    }

    /// Level 1 of Allen as a process.
    pub(crate) fn wander(&self, creature: &str) -> Player {
        let beside = Path::new(env!("CARGO_BIN_EXE_subsumed"))
            .parent()
            .expect("it lies in a directory");
        // As an example of this package, or as the layer's own package builds it.
        let built = [beside.join("examples/wander"), beside.join("allen-wander")];
        let program = built.iter().find(|p| p.exists());
        let program = program.expect("build it first: cargo build -p daemon --example wander");
        self.start(program, &["--creature", creature])
    }

    /// A daemon's status, which it has to give.
    pub(crate) fn status(&self, creature: &str) -> Value {
        match self.ask(creature, &Request::Status) {
            Some(Reply::Status(status)) => status,
            other => panic!("{creature} answers {other:?} instead of its status"),
        }
    }
}

/// A process on the scene; killed at the latest when it is dropped.
pub(crate) struct Player(stage::Player);

impl Player {
    pub(crate) fn signal(&self, signal: Signal) {
        self.0.signal(signal);
    }

    pub(crate) fn pid(&self) -> u32 {
        self.0.pid()
    }

    /// Sends SIGKILL and waits for the end.
    pub(crate) fn kill(&mut self) {
        self.ended_by(Signal::KILL);
    }

    /// Sends SIGTERM and waits for the end.
    pub(crate) fn leave(&mut self) -> ExitStatus {
        self.ended_by(Signal::TERM)
    }

    fn ended_by(&mut self, signal: Signal) -> ExitStatus {
        self.0.end_by(signal).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Waits for the end.
    pub(crate) fn end(&mut self) -> ExitStatus {
        self.0.end().unwrap_or_else(|e| panic!("{e}"))
    }

    pub(crate) fn said(&self) -> Vec<String> {
        self.0.said()
    }

    /// Waits until it has said `what` for the `times`-th time.
    pub(crate) fn says(&self, what: &str, times: usize) {
        self.0.says(what, times).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Runs `test` in a process of its own whose domain and run directory are those of a stage, so that it can
/// share wires there. The stage, if this is that process.
pub(crate) fn on_stage(test: &str, short: &str) -> Option<Scene> {
    if let Some(stage) = Scene::inherited() {
        return Some(stage);
    }
    let stage = Scene::new(short);
    let ourselves = std::env::current_exe().expect("this program has a path");
    let status = stage
        .command(ourselves)
        .args([test, "--exact", "--nocapture"])
        .status()
        .expect("this program starts");
    assert!(status.success(), "{test} on its stage: {status}");
    None
}

/// Waits until `there`; a hang ends the test.
pub(crate) fn wait_for(what: &str, there: impl FnMut() -> bool) {
    stage::wait_for(what, there).unwrap_or_else(|e| panic!("{e}"));
}

/// The segments in which pages of wires lie.
pub(crate) fn segments(scene: &Scene) -> Vec<PathBuf> {
    let mut found = scene.segments();
    found.retain(|f| f.extension().is_some_and(|e| e == "data"));
    found.sort();
    found
}
