//! Pages in iceoryx2 shared memory: how wires cross from one process to another.
//!
//! Must never be called from a real-time thread: everything here may allocate, map, open and wait. What
//! real-time threads use afterwards are the [`Writer`](super::Writer)s and [`Reader`](super::Reader)s
//! of a page, which are plain loads and stores.
//!
//! A process that writes wires owns one publish-subscribe service, and publishes one sample on it: its
//! page. The sample stays for as long as the process does and its cells are written in place; late-comers
//! get it as the service's history. Readers map the segment read-only. So a wire costs its writer no
//! system call however many read it, and a reader that dies leaves nothing behind that the writer sees.
#![allow(unsafe_code)] // keeps a pointer into a sample that was sent

use std::fmt;
use std::os::unix::fs::PermissionsExt;
use std::ptr::NonNull;
use std::sync::Arc;
use std::time::Duration;

use iceoryx2::config::Config;
use iceoryx2::port::publisher::{Publisher, PublisherCreateError};
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::service::builder::publish_subscribe::{
    PublishSubscribeOpenError, PublishSubscribeOpenOrCreateError,
};
use iceoryx2::service::ipc_threadsafe;

use super::cell::{Cell, LAYOUT};
use super::page::{Page, WIRES_MAX};
use super::room::{self, SHARED_MEMORY};

/// Version of iceoryx2 that this was built with; two versions do not share memory.
pub const ICEORYX2: &str = "0.10.0";

/// Most processes that may read one page at once: the layers of the largest creature and as many watchers.
pub const READERS_MAX: usize = 64;

/// How long a newcomer waits for a page whose owner is alive.
const ATTACH_WAIT: Duration = Duration::from_secs(2);

/// How long a new owner waits for a former one to be cleaned up, and how often it looks. Measured: up to
/// 272 ms when short of CPU.
const OWN_WAIT: Duration = Duration::from_millis(500);
const OWN_STEP: Duration = Duration::from_millis(10);

// SAFETY: a cell is `repr(C)`, made of atomics, without pointers, and the same in every process built
// for this layout; the type name carries the layout's version.
unsafe impl ZeroCopySend for Cell {
    unsafe fn type_name() -> &'static str {
        const { assert!(LAYOUT == 1, "name the new layout below") };
        "subsumed::Cell/1"
    }
}

/// Why pages could not be shared.
#[derive(Debug)]
pub enum ShareError {
    /// The service name is not one that iceoryx2 takes.
    Name(String),
    /// A process of this name owns the page already and lives.
    Owned(String),
    /// No process of this name owns a page.
    Absent(String),
    /// The page was made by a program with another wire layout or iceoryx2 version.
    Incompatible(String),
    /// The owner did not hand its page over in time.
    Silent(String),
    /// There is too little shared memory left.
    Full {
        /// How many bytes there are.
        free: u64,
        /// How many it takes.
        needed: u64,
    },
    /// iceoryx2 or the host refused; the text says which call.
    Refused(String),
}

impl fmt::Display for ShareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ShareError::Name(name) => write!(f, "{name:?} cannot be part of a shared-memory service name"),
            ShareError::Owned(name) => {
                write!(
                    f,
                    "the wires of {name:?} are owned by a process that is alive: stop it, or choose another name"
                )
            }
            ShareError::Absent(name) => write!(f, "no process shares wires as {name:?}"),
            ShareError::Incompatible(name) => write!(
                f,
                "the wires of {name:?} have another layout than this program's \
                 (wire layout {LAYOUT}, iceoryx2 {ICEORYX2})"
            ),
            ShareError::Silent(name) => {
                write!(f, "the owner of the wires of {name:?} did not answer within 2 s")
            }
            ShareError::Full { free, needed } => write!(
                f,
                "shared memory is full: {} KiB are free in {SHARED_MEMORY}, {} are needed; remove files there, \
                 or mount it larger",
                free >> 10,
                needed >> 10
            ),
            ShareError::Refused(why) => write!(f, "shared memory refused: {why}"),
        }
    }
}

impl std::error::Error for ShareError {}

/// How the file ends in which iceoryx2 0.10 counts the nodes of a domain.
const COUNTER_SUFFIX: &str = "_node.0_10_0.global_mgmt";

type Service = ipc_threadsafe::Service;
type Subscriber = iceoryx2::port::subscriber::Subscriber<Service, [Cell], ()>;
type Sample = iceoryx2::sample::Sample<Service, [Cell], ()>;

/// This process as iceoryx2 knows it. Clean up after dead processes happens when it is made.
#[derive(Debug)]
pub struct Domain {
    node: Node<Service>,
}

impl Domain {
    /// Joins the shared-memory domain of this host as `name`, and removes what dead processes left there.
    ///
    /// `SUBSUMED_DOMAIN`, if set, names a domain of its own (letters, digits, `-`, `_`): its files have
    /// their own prefix and processes of other domains do not see it. Without it, iceoryx2's own files lie in
    /// the folder `iceoryx2` of the run directory if there is one, else in `/tmp/iceoryx2`.
    ///
    /// # Errors
    /// [`ShareError::Full`] when there is too little of it, [`ShareError::Refused`] when it cannot be used.
    pub fn join(name: &str) -> Result<Domain, ShareError> {
        // First of all: reading the configuration would speak up already.
        set_log_level(LogLevel::Fatal);
        room_for(0)?;
        let config = config()?;
        let name = NodeName::new(name).map_err(|_| ShareError::Name(name.into()))?;
        let node = NodeBuilder::new()
            .name(&name)
            .config(&config)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Service>()
            .map_err(|e| ShareError::Refused(format!("creating an iceoryx2 node: {e}")))?;
        // iceoryx2 makes everything else for this user alone, but its counter of nodes for all to write: whoever
        // cut that short would end every process of the domain.
        for counter in counters(&config) {
            let _ = std::fs::set_permissions(counter, std::fs::Permissions::from_mode(0o600));
        }
        let domain = Domain { node };
        domain.clean();
        Ok(domain)
    }

    /// The node behind it, for services of other kinds in the same domain.
    pub fn node(&self) -> &Node<Service> {
        &self.node
    }

    /// Removes what dead processes left in shared memory; puts it off while that is full, since iceoryx2 makes
    /// files there to do so.
    pub fn clean(&self) {
        if !room::for_upkeep() {
            return;
        }
        let _ = self.node.try_cleanup_dead_nodes();
    }

    /// Leaves the domain, and takes along the one file that iceoryx2 keeps for the domain itself (its counter
    /// of nodes) if nobody else is left in it. Pages must have been dropped before.
    pub fn leave(self) {
        self.clean();
        let config = self.node.config().clone();
        drop(self.node);
        let mut others = false;
        let listed = Node::<Service>::list(&config, |_| {
            others = true;
            CallbackProgression::Stop
        });
        if listed.is_err() || others {
            return;
        }
        for counter in counters(&config) {
            let _ = std::fs::remove_file(counter);
        }
    }

    /// Makes the page of `wires` wires that this process owns under `name`.
    ///
    /// # Errors
    /// [`ShareError::Owned`] when a living process owns that name, [`ShareError::Incompatible`] when
    /// readers of a former owner still hold pages of another layout, [`ShareError::Full`] when there is no room,
    /// [`ShareError::Refused`] otherwise.
    pub fn own(&self, name: &str, wires: usize) -> Result<OwnedPage, ShareError> {
        assert!(wires <= WIRES_MAX, "at most {WIRES_MAX} wires in a page");
        room_for(wires)?;
        let service_name = service_name(name)?;
        self.clean();
        // The service outlives an owner for as long as readers of its page live, so it being there says
        // nothing. Its one publisher is what makes an owner.
        let service = self
            .node
            .service_builder(&service_name)
            .publish_subscribe::<[Cell]>()
            .max_publishers(1)
            .max_subscribers(READERS_MAX)
            .max_nodes(READERS_MAX + 1)
            .history_size(1)
            .subscriber_max_buffer_size(1)
            .enable_safe_overflow(true)
            .open_or_create()
            .map_err(|e| match e {
                PublishSubscribeOpenOrCreateError::PublishSubscribeOpenError(
                    PublishSubscribeOpenError::IncompatibleTypes,
                ) => ShareError::Incompatible(name.into()),
                other => ShareError::Refused(format!("creating the service {service_name}: {other}")),
            })?;
        let slots = wires.max(1);
        let mut patience = OWN_WAIT.as_millis() / OWN_STEP.as_millis();
        let publisher = loop {
            let builder = service.publisher_builder().initial_max_slice_len(slots);
            match builder.create() {
                Ok(publisher) => break publisher,
                // A dead owner may just be under clean-up by another process.
                Err(PublisherCreateError::ExceedsMaxSupportedPublishers) if patience > 0 => {
                    patience -= 1;
                    std::thread::sleep(OWN_STEP);
                    self.clean();
                }
                Err(PublisherCreateError::ExceedsMaxSupportedPublishers) => {
                    return Err(ShareError::Owned(name.into()));
                }
                Err(other) => {
                    return Err(ShareError::Refused(format!(
                        "creating a publisher on {service_name}: {other}"
                    )));
                }
            }
        };
        let sample = publisher
            .loan_slice_uninit(slots)
            .map_err(|e| ShareError::Refused(format!("loaning the page of {service_name}: {e}")))?;
        let sample = sample.write_from_fn(|_| Cell::new());
        let cells = NonNull::from(sample.payload());
        sample
            .send()
            .map_err(|e| ShareError::Refused(format!("publishing the page of {service_name}: {e}")))?;
        let publisher = Arc::new(publisher);
        // SAFETY: the sample is the only one ever sent, so the service's history of one keeps it from being
        // reused for as long as the publisher lives, and the publisher keeps its segment mapped for
        // writing. The cells were initialised above and are atomics.
        let page = unsafe { Page::over(cells, Box::new(publisher.clone()), true) };
        Ok(OwnedPage {
            page,
            publisher,
            _service: service,
        })
    }

    /// Maps the page that another process owns under `name`, read-only.
    ///
    /// # Errors
    /// [`ShareError::Absent`], [`ShareError::Incompatible`], [`ShareError::Silent`], [`ShareError::Full`].
    pub fn map(&self, name: &str) -> Result<Arc<Page>, ShareError> {
        room_for(0)?;
        let service_name = service_name(name)?;
        self.clean();
        let service = self
            .node
            .service_builder(&service_name)
            .publish_subscribe::<[Cell]>()
            .open()
            .map_err(|e| match e {
                PublishSubscribeOpenError::DoesNotExist => ShareError::Absent(name.into()),
                PublishSubscribeOpenError::IncompatibleTypes => ShareError::Incompatible(name.into()),
                other => ShareError::Refused(format!("opening the service {service_name}: {other}")),
            })?;
        // Other readers of an owner that is gone keep its service in being.
        if service.dynamic_config().number_of_publishers() == 0 {
            return Err(ShareError::Absent(name.into()));
        }
        let subscriber = service
            .subscriber_builder()
            .create()
            .map_err(|e| ShareError::Refused(format!("creating a subscriber on {service_name}: {e}")))?;
        let step = Duration::from_millis(5);
        for _ in 0..ATTACH_WAIT.as_millis() / step.as_millis() {
            match subscriber.receive() {
                Ok(Some(sample)) => return Ok(mapped(subscriber, sample)),
                Ok(None) => std::thread::sleep(step),
                Err(e) => {
                    return Err(ShareError::Refused(format!(
                        "receiving the page of {service_name}: {e}"
                    )));
                }
            }
        }
        Err(ShareError::Silent(name.into()))
    }
}

fn room_for(wires: usize) -> Result<(), ShareError> {
    room::for_newcomer(wires).map_err(|(free, needed)| ShareError::Full { free, needed })
}

/// The files in which iceoryx2 counts the nodes of a domain.
fn counters(config: &Config) -> Vec<std::path::PathBuf> {
    let prefix = config.global.prefix.to_string();
    let is_counter = |name: &str| {
        let rest = name.strip_prefix(&prefix);
        let hash = rest.and_then(|rest| rest.strip_suffix(COUNTER_SUFFIX));
        hash.is_some_and(|hash| hash.len() == 40 && hash.bytes().all(|b| b.is_ascii_hexdigit()))
    };
    let entries = std::fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten();
    entries
        .filter(|entry| is_counter(&entry.file_name().to_string_lossy()))
        .map(|entry| entry.path())
        .collect()
}

fn mapped(subscriber: Subscriber, sample: Sample) -> Arc<Page> {
    let cells = NonNull::from(sample.payload());
    // SAFETY: the sample keeps the segment mapped (read-only) and the owner never reuses it; the cells are
    // atomics, so the owner's writes race with nothing.
    unsafe { Page::over(cells, Box::new((sample, subscriber)), false) }
}

/// The page this process owns, with what serves it to others.
#[derive(Debug)]
pub struct OwnedPage {
    page: Arc<Page>,
    publisher: Arc<Publisher<Service, [Cell], ()>>,
    _service: iceoryx2::service::port_factory::publish_subscribe::PortFactory<Service, [Cell], ()>,
}

impl OwnedPage {
    /// The page itself.
    pub fn page(&self) -> &Arc<Page> {
        &self.page
    }

    /// Hands the page to processes that came since the last call, unless shared memory is full. Call it every few
    /// milliseconds.
    pub fn serve(&self) {
        if !room::for_upkeep() {
            return;
        }
        // A reader that is half gone is not our trouble; it is tried again at the next call.
        let _ = self.publisher.update_connections();
    }
}

/// The iceoryx2 service that carries the wires of `owner`.
pub fn service_of(owner: &str) -> String {
    format!("subsumed/{owner}/wires")
}

fn service_name(owner: &str) -> Result<ServiceName, ShareError> {
    service_of(owner)
        .as_str()
        .try_into()
        .map_err(|_| ShareError::Name(owner.into()))
}

/// The folder `iceoryx2` of the run directory, if the operator made one: services then need no common `/tmp`.
fn system_root() -> Option<String> {
    let root = crate::control::run_dir().join("iceoryx2");
    root.is_dir().then(|| format!("{}/", root.display()))
}

fn config() -> Result<Config, ShareError> {
    let mut config = Config::global_config().clone();
    if let Ok(domain) = std::env::var("SUBSUMED_DOMAIN") {
        let sound = !domain.is_empty()
            && domain.len() <= 32
            && domain
                .bytes()
                .all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_');
        if !sound {
            return Err(ShareError::Name(domain));
        }
        let prefix = format!("iox2_{domain}_");
        let root = format!("/tmp/iceoryx2-{domain}/");
        config.global.prefix =
            FileName::new(prefix.as_bytes()).map_err(|_| ShareError::Name(domain.clone()))?;
        config
            .global
            .set_root_path(&Path::new(root.as_bytes()).map_err(|_| ShareError::Name(domain.clone()))?);
    } else if let Some(root) = system_root() {
        let path = Path::new(root.as_bytes()).map_err(|_| ShareError::Name(root.clone()))?;
        config.global.set_root_path(&path);
    }
    Ok(config)
}
