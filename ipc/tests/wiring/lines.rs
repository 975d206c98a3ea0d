//! Lines that no program would send: both ends of the control protocol refuse them and go on living.

use std::io::Write as _;
use std::os::unix::net::UnixStream;

use ipc::control::{Connection, Reply, Request, Versions};
use serde::de::DeserializeOwned;

use crate::mutation::Dice;

/// How many texts are sent to each end.
const ROUNDS: usize = 1_000;

fn sound() -> Vec<Vec<u8>> {
    let hello = Request::Hello {
        versions: Versions::ours(),
        program: "test".into(),
    };
    let reply = Reply::Directory(crate::golden::host());
    let requests = [
        hello,
        Request::Status,
        Request::Events { after: 3 },
        Request::Unplug,
    ];
    let mut lines: Vec<Vec<u8>> = requests
        .iter()
        .map(|r| serde_json::to_vec(r).expect("JSON"))
        .collect();
    lines.push(serde_json::to_vec(&reply).expect("JSON"));
    lines.push(b"[".repeat(1 << 20));
    lines.push(b"{\"ask\":".repeat(100_000));
    lines
}

/// How many documents are understood before the first that is not.
fn heard<T: DeserializeOwned>(bytes: &[u8]) -> usize {
    let (mut ours, theirs) = UnixStream::pair().expect("a pair of sockets");
    let bytes = bytes.to_vec();
    let speaker = std::thread::spawn(move || drop(ours.write_all(&bytes)));
    let mut connection = Connection::over(theirs).expect("a connection");
    let mut count = 0;
    while let Ok(Some(_)) = connection.receive::<T>() {
        count += 1;
    }
    drop(connection);
    speaker.join().expect("the speaker ends");
    count
}

#[test]
fn no_line_makes_either_end_panic() {
    let sound = sound();
    let mut dice = Dice(0x11e5);
    for round in 0..ROUNDS {
        let mut bytes = sound[round % sound.len()].clone();
        bytes.push(b'\n');
        bytes.extend(sound[dice.roll(sound.len())].iter().chain(b"\n"));
        for _ in 0..dice.roll(4) {
            let at = dice.roll(bytes.len());
            match dice.roll(3) {
                0 => bytes[at] ^= 1 << dice.roll(8),
                1 => bytes.truncate(at.max(1)),
                _ => drop(bytes.drain(at..(at + 9).min(bytes.len()))),
            }
        }
        assert!(heard::<Request>(&bytes) <= 2);
        assert!(heard::<Reply>(&bytes) <= 2);
    }
}

#[test]
fn sound_lines_are_heard_whole() {
    let mut bytes = Vec::new();
    for line in &sound()[..4] {
        bytes.extend(line.iter().chain(b"\n"));
    }
    assert_eq!(heard::<Request>(&bytes), 4);
    assert_eq!(heard::<Reply>(&bytes), 0);
}
