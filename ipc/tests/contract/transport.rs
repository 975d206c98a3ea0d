//! The two transports behind one face: a page with its owner's side and its readers' side.
//!
//! Must never say which of the two it is: what the suite asks, both answer alike.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use ipc::wire::Page;
use ipc::wire::iceoryx::{Domain, OwnedPage};

/// How many wires the pages of the suite carry.
pub(crate) const WIRES: usize = 8;

/// A page as a transport gives it out.
pub(crate) trait Transport {
    /// The page for those who write it.
    fn owner(&self) -> Arc<Page>;
    /// The page for one who comes to read it.
    fn attach(&self) -> Arc<Page>;
}

/// A page in plain memory.
pub(crate) struct Memory(Arc<Page>);

impl Memory {
    pub(crate) fn new() -> Memory {
        Memory(Page::in_memory(WIRES))
    }
}

impl Transport for Memory {
    fn owner(&self) -> Arc<Page> {
        self.0.clone()
    }
    fn attach(&self) -> Arc<Page> {
        self.0.clone()
    }
}

/// An owned page with a thread that serves it.
pub(crate) struct Served {
    owned: Arc<OwnedPage>,
    stop: Arc<AtomicBool>,
    server: Option<JoinHandle<()>>,
}

impl Served {
    pub(crate) fn new(owned: OwnedPage) -> Served {
        let owned = Arc::new(owned);
        let stop = Arc::new(AtomicBool::new(false));
        let (page, told) = (owned.clone(), stop.clone());
        let server = std::thread::spawn(move || {
            // Relaxed: the flag guards nothing; `join` orders the rest.
            while !told.load(Ordering::Relaxed) {
                page.serve();
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        Served {
            owned,
            stop,
            server: Some(server),
        }
    }

    pub(crate) fn page(&self) -> &Arc<Page> {
        self.owned.page()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.server.take().unwrap().join().unwrap();
    }
}

/// A page in iceoryx2 shared memory: mapped twice, as two processes would.
pub(crate) struct Shared {
    served: Served,
    _owner: Domain,
    reader: Domain,
}

impl Shared {
    pub(crate) fn new() -> Shared {
        let owner = Domain::join("owner").unwrap();
        Shared {
            served: Served::new(owner.own("suite", WIRES).unwrap()),
            _owner: owner,
            reader: Domain::join("reader").unwrap(),
        }
    }
}

impl Transport for Shared {
    fn owner(&self) -> Arc<Page> {
        self.served.page().clone()
    }
    fn attach(&self) -> Arc<Page> {
        self.reader.map("suite").unwrap()
    }
}
