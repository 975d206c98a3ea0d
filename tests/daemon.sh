#!/usr/bin/env bash
# The daemon from outside, as a user and as strace see it: layers and watchers come and go, one is killed, and
# the real-time threads make no system call but their sleep, allocate nothing and take no page fault.
#
#   tests/daemon.sh [FOLDER-OF-BINARIES]      default: target/release
# Needs strace (ptrace allowed) for the system calls, chromium for the page; says what it skipped.
set -euo pipefail
bin=$(realpath "${1:-target/release}")
work=$(mktemp -d)
export SUBSUMED_DOMAIN="outside$$" SUBSUMED_RUN="$work/run"
daemon="" wander=""
clean() {
  [ -n "$wander" ] && kill -9 "$wander" 2>/dev/null || true
  [ -n "$daemon" ] && kill -9 "$daemon" 2>/dev/null || true
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
state() {
  [ -n "$daemon" ] || { echo "the daemon has left"; return; }
  if kill -0 "$daemon" 2>/dev/null; then echo "the daemon lives"; else wait "$daemon" 2>/dev/null; echo "the daemon ended with status $?"; fi
}
fail() { echo "FAILED: $*"; state || true; tail -n 20 "$work"/*.log; exit 1; }
ctl() { "$bin/subsumectl" --creature outside "$@"; }
field() { ctl status --json | tr ',{}[]' '\n' | grep -m1 "^\"$1\":" | cut -d: -f2- | tr -d '"'; }

# Bad input first: it needs no daemon.
set +e
"$bin/subsumed" --creature "$work/none.toml" 2>"$work/bad.log"; [ $? -eq 2 ] || fail "a missing creature file must end with status 2"
printf 'creature = "x"\n[[layer]]\nname = \n' >"$work/bad.toml"
"$bin/subsumed" --creature "$work/bad.toml" 2>"$work/bad.log"; [ $? -eq 2 ] || fail "broken TOML must end with status 2"
grep -q 'bad.toml:3:' "$work/bad.log" || fail "broken TOML must be placed in line 3"
ctl status 2>"$work/bad.log"; [ $? -eq 1 ] || fail "status without a daemon must end with status 1"
grep -q 'no daemon runs' "$work/bad.log" || fail "status without a daemon must say so"
set -e

"$bin/subsumed" --name outside --page-port 0 --seed 7 --flight-recorder "$work/flight" >"$work/daemon.log" 2>&1 &
daemon=$!
for _ in $(seq 100); do ctl status >/dev/null 2>&1 && break; sleep 0.1; done
ctl status >/dev/null || fail "the daemon did not come up"
[ "$(field halted)" = false ] || { sleep 1; [ "$(field halted)" = false ] || fail "the body must be free once level 0 beats"; }

# Threads that are real-time by name: layers, the motor unit and the watchdog.
threads() { for t in /proc/$daemon/task/*; do case $(cat "$t/comm") in avoid|motor|watchdog) basename "$t";; esac; done; }
faults() { local sum=0; for t in $(threads); do sum=$((sum + $(awk '{print $10 + $12}' "/proc/$daemon/task/$t/stat"))); done; echo $sum; }
sleep 1
before=$(faults)
if command -v strace >/dev/null && strace -o /dev/null true 2>/dev/null; then
  for t in $(threads); do timeout 10 strace -qq -p "$t" -o "$work/strace.$t" & done
else
  echo "skipped: system calls of real-time threads (no strace, or ptrace is not allowed)"
fi
for round in 1 2; do
  "$bin/allen-wander" --creature outside >"$work/wander.log" 2>&1 & wander=$!
  ctl watch sonar.map --seconds 2 >"$work/watch.log" &
  ctl record -o "$work/record$round.mcap" --seconds 2 >"$work/record.log" &
  sleep 2.5
  grep -q 'wander .*attached' <<<"$(ctl status)" || fail "the wander layer is not attached in round $round"
  ctl wires >/dev/null
  kill -9 $wander; wait $wander 2>/dev/null || true
  sleep 0.7
  grep -q 'wander .*attached' <<<"$(ctl status)" && fail "a killed layer must be gone"
  ctl events >"$work/events.log"; grep -q 'layer wander (pid [0-9]*) died' "$work/events.log" || fail "the death of a layer must be logged with its name"
done
grep -q '#' "$work/watch.log" || fail "watching a wire must show messages"
sleep 4
wait $(jobs -p | grep -v "^$daemon$") 2>/dev/null || true
after=$(faults)
[ "$before" = "$after" ] || fail "page faults on real-time threads: $before before, $after after"
[ "$(field real_time_allocations)" = 0 ] || fail "allocations on real-time threads: $(field real_time_allocations)"
for trace in "$work"/strace.*; do
  [ -e "$trace" ] || continue
  [ "$(grep -c clock_nanosleep "$trace")" -gt 100 ] || fail "strace saw no beats in $trace"
  other=$(grep -vE '^(clock_nanosleep|strace:|<\.\.\. clock_nanosleep|restart_syscall)' "$trace" | head -3 || true)
  [ -z "$other" ] || fail "system calls of a real-time thread other than its sleep: $other"
done

ctl record -o "$work/while.mcap" --seconds 1 >/dev/null || fail "recording must be possible while layers come and go"
ctl halt >/dev/null; sleep 0.5
[ "$(field halted)" = true ] || fail "halt must halt"
ctl reset >/dev/null; sleep 0.5
grep -q '^halt: emergency' <<<"$(ctl status)" && fail "reset must end an emergency stop"

port=$(sed -n 's#.*http://127.0.0.1:\([0-9]*\)/#\1#p' "$work/daemon.log")
if command -v chromium >/dev/null; then
  timeout 60 chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --user-data-dir="$work/chromium" --window-size=1400,900 \
    --virtual-time-budget=4000 --screenshot="${SCREENSHOT:-$work/page.png}" --dump-dom "http://127.0.0.1:$port/" >"$work/dom.html" 2>"$work/chromium.log" \
    || fail "chromium failed"
  grep -q 'data-connected="true"' "$work/dom.html" || fail "the page does not reach the daemon"
  grep -q 'data-module="collide"' "$work/dom.html" || fail "the page does not show the wiring"
  grep -q 'data-wire="sonar.map"[^>]*aria-label' "$work/dom.html" || fail "the page does not bring the wires to life"
else
  echo "skipped: the page in a browser (no chromium)"
fi
set +e
"$bin/subsumed" --name other --page-port "$port" >"$work/taken.log" 2>&1; [ $? -eq 1 ] || fail "a taken port must end with status 1"
grep -q -- '--page-port' "$work/taken.log" || fail "a taken port must name the option"
"$bin/subsumed" --name outside >"$work/twice.log" 2>&1; [ $? -eq 1 ] || fail "a second daemon of one name must be refused"
set -e

# Ctrl-C first, on a daemon of its own; SIGTERM on the one that was watched.
"$bin/subsumed" --name ctrlc --no-page --flight-recorder off >"$work/ctrlc.log" 2>&1 & second=$!
for _ in $(seq 100); do "$bin/subsumectl" --creature ctrlc status >/dev/null 2>&1 && break; sleep 0.1; done
kill -INT $second; wait $second || fail "Ctrl-C must end with status 0"
grep -q 'the body is halted: .*shutdown' "$work/ctrlc.log" || fail "the body must be halted before Ctrl-C ends the daemon"
kill -TERM $daemon; wait $daemon || fail "SIGTERM must end with status 0"
daemon=""
grep -q 'the body is halted: .*shutdown' "$work/daemon.log" || fail "the body must be halted before the daemon leaves"
left=$(ls /dev/shm | grep "^iox2_${SUBSUMED_DOMAIN}_" || true)
[ -z "$left" ] || fail "left in /dev/shm: $left"
echo "the daemon from outside: all held (page faults $after, allocations 0)"
