#!/usr/bin/env bash
# The unsafe code that has no system call in it, under Miri: pages in memory with their writers and readers, as
# the contract of wires asks of them, and the traces. Pages in shared memory and the mappings are what Miri cannot run; the
# contract of wires (ipc/tests/contract) tries those on real processes.
#
#   tests/miri.sh
# Needs a nightly toolchain with Miri (`rustup toolchain install nightly -c miri,rust-src`); says so without.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo +nightly miri --version >/dev/null 2>&1 || { echo "skipped: Miri (rustup toolchain install nightly -c miri,rust-src)"; exit 0; }
export MIRIFLAGS=-Zmiri-disable-isolation
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target/miri}
miri() { cargo +nightly miri test --quiet "$@"; }
miri -p ipc --lib
miri -p afsm --lib
cases=$(miri -p ipc --test contract -- --list | sed -n 's/^\(memory::.*\): test$/\1/p')
[ -n "$cases" ] || { echo "FAILED: the contract lists no cases in memory"; exit 1; }
for case in $cases; do
  echo "contract $case"
  miri -p ipc --test contract -- --case "$case"
done
echo "Miri: nothing undefined in $(echo "$cases" | wc -l) cases of the contract"
