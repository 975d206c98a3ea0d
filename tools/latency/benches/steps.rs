//! How long every case takes: `cargo bench -p latency --bench steps`.

use divan::Bencher;
use latency::cases::{CASES, find};

fn main() {
    divan::main();
}

#[divan::bench(args = CASES.iter().map(|c| c.name))]
fn turn(bencher: Bencher, name: &str) {
    let case = find(name).expect("listed");
    bencher.bench_local((case.ready)());
}
