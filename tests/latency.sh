#!/usr/bin/env bash
# The short latency report of CI, in about two minutes: the table, and the gate on instruction counts, on
# allocations, page faults and system calls of real-time threads, and on ratios to cyclictest. docs/timing.md says
# what each number means and where the margins come from.
#
#   tests/latency.sh [FOLDER-OF-BINARIES]                   default: target/release
#   tests/latency.sh --show-failing [FOLDER-OF-BINARIES]    plants an allocation, a lock, a delay: each must fail
# Needs cyclictest (rt-tests), valgrind, strace; without SCHED_FIFO it says so and judges instructions alone.
# The report stays in ${LATENCY_REPORT:-latency-report}.
set -euo pipefail
cd "$(dirname "$0")/.."
show=no
[ "${1:-}" = --show-failing ] && { show=yes; shift; }
bin=$(realpath "${1:-${CARGO_TARGET_DIR:-target}/release}")
out=${LATENCY_REPORT:-latency-report}
work=$(mktemp -d)
export SUBSUMED_RUN="$work/run" SUBSUMED_DOMAIN="lab$$"
trap 'rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/iox2_"$SUBSUMED_DOMAIN"_*' EXIT
fail() { echo "FAILED: $*"; exit 1; }
lab() { timeout 300 "$bin/subsumectl" latency "$@"; }
export SUBSUMED_RUN SUBSUMED_DOMAIN

can_fifo() { chrt -f 1 true 2>/dev/null; }

if [ $show = yes ]; then
  can_fifo || fail "the host refuses SCHED_FIFO: nothing can be shown"
  for plant in allocation lock delay; do
    printf '\n== planted: %s\n' "$plant"
    if lab --seconds 0 --against cyclictest --rounds 3 --round-seconds 2 --gate --plant "$plant" --out "$work/$plant" >"$work/log" 2>&1; then
      cat "$work/log"; fail "a planted $plant passed the gate"
    fi
    grep '^gate:' "$work/log" || { cat "$work/log"; fail "a planted $plant failed, but not at the gate"; }
  done
  echo "each planted fault was caught"
  exit 0
fi

tests/instructions.sh "$bin/instructions"
if ! can_fifo; then
  echo "skipped: times, because the host refuses SCHED_FIFO (subsumectl doctor says why)"
  exit 0
fi
command -v cyclictest >/dev/null || fail "cyclictest is not installed (Debian: apt-get install rt-tests)"
lab --seconds 12 --against cyclictest --rounds 4 --round-seconds 2 --gate --out "$out/idle" || fail "the gate, idle"
lab --seconds 12 --load churn --gate --out "$out/churn" || fail "the gate, with churn"
if [ "$(nproc)" -gt 1 ]; then
  lab --seconds 0 --against blackboard --rounds 4 --round-seconds 3 --gate --out "$out/across" || fail "the gate, across processes"
else
  echo "skipped: messages to another process (one processor)"
fi

# System calls: what each beating thread did between its first and its last sleep.
if command -v strace >/dev/null && strace -o /dev/null true 2>/dev/null; then
  timeout 60 strace -f -qq -ttt -o "$work/strace" "$bin/subsumectl" --json latency --seconds 3 --load churn --out "$work/traced" \
    >"$work/traced.json" || fail "the traced run"
  threads=$(tr ',{}[]' '\n' <"$work/traced.json" | sed -n 's/.*"tid": *\([0-9][0-9]*\).*/\1/p')
  [ -n "$threads" ] || fail "the traced run names no threads"
  for t in $threads; do
    grep -E "^$t +" "$work/strace" | grep -nE 'clock_nanosleep' | cut -d: -f1 >"$work/beats"
    first=$(head -1 "$work/beats"); last=$(tail -1 "$work/beats")
    [ "$(wc -l <"$work/beats")" -gt 100 ] || fail "strace saw no beats of thread $t"
    other=$(grep -E "^$t +" "$work/strace" | sed -n "${first},${last}p" | grep -vE 'clock_nanosleep|restart_syscall' | head -3 || true)
    [ -z "$other" ] || fail "a real-time thread called something other than its sleep: $other"
  done
  echo "system calls of real-time threads: none but the sleep ($(echo $threads | wc -w) threads)"
else
  echo "skipped: system calls of real-time threads (no strace, or ptrace is not allowed)"
fi
echo "the latency gate: all held (report in $out)"
