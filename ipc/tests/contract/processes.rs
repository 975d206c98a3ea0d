//! What processes that share wires may do to each other: nothing, however they end.
//!
//! A *role* is what a process started by a case plays: it says one line when it is ready and leaves in good
//! order when its standard input ends, unless it is killed before.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use iceoryx2::config::Config;
use iceoryx2::prelude::{
    FileName, LogLevel, NodeBuilder, Path, SemanticString, ipc_threadsafe, set_log_level,
};
use ipc::clock::Time;
use ipc::message::{Kind, WORDS_MAX};
use ipc::wire::iceoryx::{Domain, READERS_MAX, ShareError, service_of};

use crate::suite::{pour, wade};
use crate::transport::Served;

type Case = fn();

/// Every case by name.
pub(crate) const CASES: &[(&str, Case)] = &[
    ("a_second_owner_is_refused", second_owner),
    ("an_absent_owner_is_named_so", absent),
    ("another_layout_is_incompatible", other_layout),
    ("names_that_cannot_be_are_refused", bad_names),
    ("a_silent_owner_is_given_up", silent),
    ("an_owner_that_left_is_absent_and_can_be_followed", owner_leaves),
    ("a_killed_reader_disturbs_nobody", killed_reader),
    ("killed_readers_do_not_use_up_the_places", killed_readers),
    ("a_killed_owner_leaves_its_last_word", killed_owner),
    ("a_killed_owner_can_be_followed_at_once", killed_owner_followed),
    ("a_flooding_process_neither_tears_nor_detains_a_read", flood),
];

const WIRES: usize = 4;

/// A process playing a role; killed at the latest when it is dropped.
struct Player {
    child: Child,
    said: String,
}

impl Player {
    fn start(role: &str, owner: &str) -> Player {
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--role", role, owner])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut said)
            .unwrap();
        let said = said.trim_end().to_owned();
        Player { child, said }
    }

    fn ready(role: &str, owner: &str) -> Player {
        let player = Player::start(role, owner);
        assert_eq!(player.said, "ready");
        player
    }

    fn leave(mut self) {
        drop(self.child.stdin.take());
        assert!(self.child.wait().unwrap().success());
    }

    /// Sends SIGKILL.
    fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Plays `role` towards the page of `owner`.
pub(crate) fn play(role: &str, owner: &str) {
    let domain = Domain::join(role).unwrap();
    match role {
        "owner" => match domain.own(owner, WIRES) {
            Ok(owned) => {
                let served = Served::new(owned);
                let mut writer = served.page().writer(0, Kind::Number).unwrap();
                for n in 1..=3 {
                    writer.write(Time(n), &[n as f64; WORDS_MAX]);
                }
                stay();
            }
            Err(ShareError::Owned(_)) => println!("owned"),
            Err(why) => println!("{why}"),
        },
        "reader" => {
            let page = domain.map(owner).unwrap();
            assert!(page.reader(0, Kind::Number).unwrap().read().is_some());
            stay();
        }
        "flood" => {
            let served = Served::new(domain.own(owner, WIRES).unwrap());
            let mut writer = served.page().writer(0, Kind::Map).unwrap();
            let stop = AtomicBool::new(false);
            std::thread::scope(|threads| {
                threads.spawn(|| pour(&mut writer, &stop));
                stay();
                stop.store(true, std::sync::atomic::Ordering::Relaxed);
            });
        }
        role => panic!("no role {role:?}"),
    }
}

fn stay() {
    println!("ready");
    let _ = std::io::stdin().read_to_end(&mut Vec::new());
}

fn newest(page: &std::sync::Arc<ipc::wire::Page>) -> f64 {
    let reader = page.reader(0, Kind::Number).unwrap();
    reader.read().unwrap().words[0]
}

fn second_owner() {
    let first = Player::ready("owner", "allen");
    let here = Domain::join("here").unwrap();
    assert!(matches!(here.own("allen", 1), Err(ShareError::Owned(name)) if name == "allen"));
    assert_eq!(Player::start("owner", "allen").said, "owned");
    assert_eq!(newest(&here.map("allen").unwrap()), 3.0, "the first still serves");
    let other = here.own("herbert", 1).unwrap();
    assert!(
        matches!(here.own("herbert", 1), Err(ShareError::Owned(_))),
        "nor twice in one process"
    );
    drop(other);
    assert!(here.own("herbert", 2).is_ok(), "a name given back is free");
    first.leave();
}

fn absent() {
    let domain = Domain::join("here").unwrap();
    assert!(matches!(domain.map("nobody"), Err(ShareError::Absent(name)) if name == "nobody"));
    let _owned = domain.own("somebody", 1).unwrap();
    assert!(matches!(domain.map("nobody"), Err(ShareError::Absent(_))));
}

fn other_layout() {
    set_log_level(LogLevel::Fatal);
    let name = std::env::var("SUBSUMED_DOMAIN").unwrap();
    let mut config = Config::global_config().clone();
    config.global.prefix = FileName::new(format!("iox2_{name}_").as_bytes()).unwrap();
    let root = format!("/tmp/iceoryx2-{name}/");
    config.global.set_root_path(&Path::new(root.as_bytes()).unwrap());
    let node = NodeBuilder::new()
        .config(&config)
        .create::<ipc_threadsafe::Service>()
        .unwrap();
    let service_name = service_of("stranger").as_str().try_into().unwrap();
    let _service = node
        .service_builder(&service_name)
        .publish_subscribe::<[u64]>()
        .create()
        .unwrap();
    let domain = Domain::join("here").unwrap();
    let refused = domain.map("stranger").unwrap_err();
    assert!(matches!(refused, ShareError::Incompatible(_)), "{refused:?}");
    let refused = domain.own("stranger", 1).unwrap_err();
    assert!(matches!(refused, ShareError::Incompatible(_)), "{refused:?}");
}

fn bad_names() {
    let domain = Domain::join("here").unwrap();
    let long = "a".repeat(1000);
    assert!(matches!(domain.own(&long, 1), Err(ShareError::Name(_))));
    assert!(matches!(domain.map(&long), Err(ShareError::Name(_))));
}

fn silent() {
    let domain = Domain::join("here").unwrap();
    let owned = domain.own("allen", 1).unwrap();
    let begun = Instant::now();
    assert!(matches!(domain.map("allen"), Err(ShareError::Silent(_))));
    assert!(begun.elapsed() < Duration::from_secs(10));
    owned.serve();
}

fn owner_leaves() {
    let here = Domain::join("here").unwrap();
    for _ in 0..3 {
        let owner = Player::ready("owner", "allen");
        let page = here.map("allen").unwrap();
        owner.leave();
        assert_eq!(newest(&page), 3.0, "what was mapped stays");
        assert!(
            matches!(here.map("allen"), Err(ShareError::Absent(_))),
            "though a reader is left"
        );
        let next = Player::ready("owner", "allen");
        assert_eq!(newest(&here.map("allen").unwrap()), 3.0);
        next.leave();
        drop(page);
        assert!(matches!(here.map("allen"), Err(ShareError::Absent(_))));
    }
}

fn killed_reader() {
    let domain = Domain::join("here").unwrap();
    let served = Served::new(domain.own("allen", WIRES).unwrap());
    let mut writer = served.page().writer(0, Kind::Number).unwrap();
    writer.write(Time(1), &[1.0; WORDS_MAX]);
    let steady = domain.map("allen").unwrap();
    for n in 2..10 {
        let reader = Player::ready("reader", "allen");
        reader.kill();
        writer.write(Time(n), &[n as f64; WORDS_MAX]);
        assert_eq!(newest(&steady), n as f64);
        assert_eq!(newest(&domain.map("allen").unwrap()), n as f64);
    }
    domain.clean();
}

fn killed_readers() {
    let domain = Domain::join("here").unwrap();
    let served = Served::new(domain.own("allen", WIRES).unwrap());
    let mut writer = served.page().writer(0, Kind::Number).unwrap();
    writer.write(Time(1), &[1.0; WORDS_MAX]);
    for _ in 0..READERS_MAX + 2 {
        Player::ready("reader", "allen").kill();
    }
    assert_eq!(newest(&domain.map("allen").unwrap()), 1.0);
    domain.clean();
}

fn killed_owner() {
    let here = Domain::join("here").unwrap();
    let owner = Player::ready("owner", "allen");
    let page = here.map("allen").unwrap();
    let reader = page.reader(0, Kind::Number).unwrap();
    owner.kill();
    for _ in 0..2 {
        let reading = reader.read().unwrap();
        assert_eq!((reading.number, reading.words[0]), (3, 3.0));
        assert_eq!(reader.newer_than(3), None);
        assert!(
            matches!(here.map("allen"), Err(ShareError::Absent(_))),
            "nobody owns it now"
        );
    }
}

fn killed_owner_followed() {
    let here = Domain::join("here").unwrap();
    for readers in [true, false] {
        let owner = Player::ready("owner", "allen");
        let old = readers.then(|| here.map("allen").unwrap());
        owner.kill();
        let next = Player::ready("owner", "allen");
        let page = here.map("allen").unwrap();
        assert_eq!(newest(&page), 3.0);
        if let Some(old) = old {
            assert_eq!(newest(&old), 3.0, "the old page stays as it was");
        }
        assert_eq!(Player::start("owner", "allen").said, "owned");
        next.leave();
    }
}

fn flood() {
    let here = Domain::join("here").unwrap();
    let flooding = Player::ready("flood", "allen");
    let page = here.map("allen").unwrap();
    let reader = page.reader(0, Kind::Map).unwrap();
    while reader.number() == Some(0) {
        std::thread::yield_now();
    }
    wade(&reader, Duration::from_millis(500));
    flooding.kill();
    // It may have died in the midst of a message: then there is nothing to read, and nothing torn.
    let last = reader.read();
    assert!(last.is_none_or(|r| r.words == [r.number as f64; WORDS_MAX]));
    assert_eq!(reader.read(), last);
    here.clean();
}
