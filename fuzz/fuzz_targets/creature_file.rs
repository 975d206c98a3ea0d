//! Any bytes as a creature file: read, checked, and their errors shown.
#![no_main]

#[path = "../../ipc/tests/wiring/kinds.rs"]
mod kinds;

use std::sync::LazyLock;

use ipc::wiring::{Directory, Source, check};
use kinds::Kinds;
use libfuzzer_sys::fuzz_target;

/// The creature that the bytes, as a manifest, want to join.
static HOST: LazyLock<Directory> = LazyLock::new(|| {
    let source = Source::new("cart.toml", include_str!("../../ipc/tests/good/cart.toml"));
    let creature = check::creature(&source, &Kinds).expect("a good file");
    Directory::of(&creature, "cart")
});

fuzz_target!(|bytes: &[u8]| {
    let source = match Source::from_bytes("fuzz.toml", bytes.to_vec()) {
        Ok(source) => source,
        Err(refused) => return drop(refused.to_string()),
    };
    if let Err(refused) = check::creature(&source, &Kinds) {
        assert!(refused.count() > 0);
        drop((refused.to_string(), refused.located()));
    }
    if let Err(refused) = check::manifest(&source, &Kinds, &HOST) {
        drop(refused.to_string());
    }
});
