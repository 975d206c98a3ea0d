//! Who is at the other end of a socket.
//!
//! Must never believe what the other end says of itself: the kernel knows.

use std::io;
use std::os::unix::net::UnixStream;

/// Who is at the other end of a Unix socket, as the kernel knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peer {
    /// Its process.
    pub pid: i32,
    /// Its user.
    pub user: u32,
    /// Its group.
    pub group: u32,
}

impl Peer {
    /// Who connected to, or listens at, the other end of `stream` (`SO_PEERCRED`).
    ///
    /// # Errors
    /// When the kernel does not say.
    pub fn of(stream: &UnixStream) -> io::Result<Peer> {
        let credentials = rustix::net::sockopt::socket_peercred(stream)?;
        Ok(Peer {
            pid: credentials.pid.as_raw_nonzero().get(),
            user: credentials.uid.as_raw(),
            group: credentials.gid.as_raw(),
        })
    }

    /// Whether it is this process's user, or root, who may do everything to this process anyway.
    pub fn is_us(self) -> bool {
        self.user == rustix::process::geteuid().as_raw() || self.user == 0
    }
}
