//! Any bytes on a control socket: both ends read them as lines.
#![no_main]

use std::io::Write as _;
use std::os::unix::net::UnixStream;
use std::time::Duration;

use ipc::control::{Connection, Reply, Request};
use libfuzzer_sys::fuzz_target;
use serde::de::DeserializeOwned;

/// Reads documents until the bytes are used up or make no sense.
fn hear<T: DeserializeOwned>(bytes: &[u8]) {
    let (mut ours, theirs) = UnixStream::pair().expect("a pair of sockets");
    let timeout = Some(Duration::from_secs(5));
    theirs.set_read_timeout(timeout).expect("a time-out");
    let bytes = bytes.to_vec();
    let speaker = std::thread::spawn(move || drop(ours.write_all(&bytes)));
    let mut connection = Connection::over(theirs).expect("a connection");
    while let Ok(Some(_)) = connection.receive::<T>() {}
    drop(connection);
    speaker.join().expect("the speaker ends");
}

fuzz_target!(|bytes: &[u8]| {
    hear::<Request>(bytes);
    hear::<Reply>(bytes);
});
