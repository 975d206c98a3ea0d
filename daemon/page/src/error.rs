//! Why the page could not be opened, in words that say what to change.

use std::fmt;
use std::io;
use std::net::SocketAddr;

/// Why [`serve`](crate::serve) did not start.
#[derive(Debug)]
#[non_exhaustive]
pub enum ServeError {
    /// Another program already listens there.
    PortTaken {
        /// The address that was asked for.
        address: SocketAddr,
    },
    /// The address can be reached from other machines, and there is no token.
    NotLoopback {
        /// The address that was asked for.
        address: SocketAddr,
    },
    /// The system refused the address for another reason.
    Listen {
        /// The address that was asked for.
        address: SocketAddr,
        /// What the system said.
        source: io::Error,
    },
    /// The system refused a thread to answer with.
    Thread {
        /// What the system said.
        source: io::Error,
    },
}

impl fmt::Display for ServeError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PortTaken { address } => write!(
                out,
                "the live page cannot use port {} on {}: another program already listens there; \
                 choose another port with --page-port N (0 takes any free one)",
                address.port(),
                address.ip(),
            ),
            Self::NotLoopback { address } => write!(
                out,
                "the live page cannot be served on {}, which others can reach, without a token: \
                 give one with --page-token FILE, or use 127.0.0.1 or [::1]",
                address.ip(),
            ),
            Self::Listen { address, source } => write!(
                out,
                "the live page cannot listen on {address}: {source}; \
                 choose another port with --page-port N (0 takes any free one)",
            ),
            Self::Thread { source } => {
                write!(out, "the live page cannot start its threads: {source}")
            }
        }
    }
}

impl std::error::Error for ServeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Listen { source, .. } | Self::Thread { source } => Some(source),
            Self::PortTaken { .. } | Self::NotLoopback { .. } => None,
        }
    }
}
