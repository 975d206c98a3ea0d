#!/usr/bin/env bash
# The executor from outside: what scheduler, priority and processor every thread really has, groups on one thread,
# spinning and its bound, refusals.
#
#   tests/executor.sh [FOLDER-OF-BINARIES]      default: target/release
# Where SCHED_FIFO is refused it says what it skipped.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$(realpath "${1:-${CARGO_TARGET_DIR:-target}/release}")
work=$(mktemp -d)
export SUBSUMED_DOMAIN="exec$$" SUBSUMED_RUN="$work/run"
export XDG_STATE_HOME="$work/state"; unset STATE_DIRECTORY
daemon=""
clean() {
  [ -n "$daemon" ] && kill -9 "$daemon" 2>/dev/null || true
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
fail() { echo "FAILED: $*"; cat "$work"/*.log 2>/dev/null | tail -20; exit 1; }
can_fifo() { chrt -f 1 true 2>/dev/null; }
ctl() { "$bin/subsumectl" --creature outside "$@"; }

# A file with this executor table and these lines for the layers.
creature() { # NAME EXECUTOR LAYER-LINES
  sed -e "s/^seed = 1\$/seed = 1\n\n[executor]\n$2/" -e "s/^period = \"10ms\"\$/period = \"10ms\"\n$3/" layers/allen/allen.toml >"$work/$1.toml"
}
up() { # ARGS... ; the daemon runs and answers
  "$@" --name outside --headless >"$work/daemon.log" 2>&1 &
  daemon=$!
  for _ in $(seq 100); do ctl status >/dev/null 2>&1 && return; kill -0 $daemon 2>/dev/null || break; sleep 0.1; done
  fail "the daemon did not come up: $*"
}
down() { kill -TERM $daemon; wait $daemon || fail "SIGTERM must end with status 0"; daemon=""; }
# Scheduler (0 other, 1 fifo, 6 deadline), priority and processors of the thread called $1.
thread() { for t in /proc/$daemon/task/*; do if [ "$(cat "$t/comm")" = "$1" ]; then
  echo "$(awk '{sub(/.*\) /, ""); print $39, $38}' "$t/stat") $(awk '/^Cpus_allowed_list/{print $2}' "$t/status")"; fi; done; }

set +e
creature greedy 'spin_share_max = 0.01' 'wake = "spin"\nspin = "500us"'
"$bin/subsumed" --creature "$work/greedy.toml" --headless --seconds 1 >"$work/greedy.log" 2>&1; [ $? -eq 2 ] || fail "spinning beyond the share must be refused with status 2"
grep -q 'greedy.toml:[0-9]*:[0-9]*' "$work/greedy.log" || fail "the refusal must name its place"
set -e
if ! can_fifo; then echo "skipped: schedulers of threads (the host refuses SCHED_FIFO)"; exit 0; fi

# Rate-monotonic: the layer of 10 ms below the motor unit; every helper thread ordinary, even if we are not.
creature plain '' ''
up chrt -f 10 "$bin/subsumed" --creature "$work/plain.toml"
[ "$(thread avoid | cut -d' ' -f1,2)" = "1 79" ] || fail "avoid must be SCHED_FIFO 79, is $(thread avoid)"
[ "$(thread motor | cut -d' ' -f1,2)" = "1 80" ] || fail "motor must be SCHED_FIFO 80, is $(thread motor)"
for t in /proc/$daemon/task/*; do
  name=$(cat "$t/comm")
  case $name in
  avoid|motor|watchdog)
    # Bit 14 is SIGTERM, bit 16 SIGCHLD, bit 6 SIGBUS, which a thread raises itself.
    blocked=$((16#$(awk '/^SigBlk/{print $2}' "$t/status")))
    [ $((blocked >> 14 & 1)) = 1 ] && [ $((blocked >> 16 & 1)) = 1 ] || fail "$name must leave signals to other threads"
    [ $((blocked >> 6 & 1)) = 0 ] || fail "$name must not block the signals of its own faults" ;;
  *)
    [ "$(awk '{sub(/.*\) /, ""); print $39}' "$t/stat")" = 0 ] || fail "helper thread $name inherited a real-time policy" ;;
  esac
  [ "$name" = avoid ] && [ "$(cat "/proc/$daemon/task/${t##*/}/timerslack_ns" 2>/dev/null || echo 1)" -gt 1 ] && fail "timer slack of $name is not set"
done
down

# Bound to a processor by its number, and spinning: both are shown, and the share is what was asked for.
creature spins '' 'cpu = 1\nwake = "spin"\nspin = "200us"'
if [ -d /sys/devices/system/cpu/cpu1 ]; then
  up "$bin/subsumed" --creature "$work/spins.toml"
  [ "$(thread avoid | cut -d' ' -f3)" = 1 ] || fail "avoid must be bound to processor 1, is $(thread avoid)"
  sleep 1.2
  grep -q '"wake": *"spin 200us"' <<<"$(ctl --json status)" || fail "status must say how a layer waits"
  given=$(awk '/^Cpus_allowed_list/{print $2}' /proc/self/status)
  if [ "$(nproc)" -gt 1 ]; then
    [ "$(thread motor | cut -d' ' -f3)" = "$given" ] || fail "a real-time thread without cpu may run anywhere ($given), motor is $(thread motor)"
    for t in /proc/$daemon/task/*; do
      case $(cat "$t/comm") in avoid|motor|watchdog) continue ;; esac
      mask=$((16#$(awk '/^Cpus_allowed:/{gsub(",", "", $2); print substr($2, length($2))}' "$t/status")))
      [ $((mask >> 1 & 1)) = 0 ] || fail "helper thread $(cat "$t/comm") must keep off processor 1, which a layer is bound to"
    done
  fi
  down
fi

# SCHED_DEADLINE where it is asked for and granted.
creature deadline 'policy = "deadline"' ''
up "$bin/subsumed" --creature "$work/deadline.toml"
sleep 1
if grep -q 'sched_setattr(SCHED_DEADLINE.*refused' <<<"$(ctl --json status)"; then echo "skipped: SCHED_DEADLINE (refused here)"; else
  [ "$(thread avoid | cut -d' ' -f1)" = 6 ] || fail "avoid must be SCHED_DEADLINE, is $(thread avoid)"
fi
beats=$(ctl --json status | tr ',{}' '\n\n\n' | sed -n 's/^ *"beats": *//p' | head -1)
[ "$beats" -gt 50 ] || fail "a SCHED_DEADLINE layer must beat, did so $beats times"
down

# Without privileges: refused to start if best effort is not wanted, marked if it is.
if command -v capsh >/dev/null; then
  creature strict 'best_effort = "refuse"' ''
  chmod -R a+rX "$work"
  set +e
  capsh --drop=cap_sys_nice,cap_ipc_lock,cap_sys_resource -- -c "ulimit -r 0; '$bin/subsumed' --creature '$work/strict.toml' --name outside --headless --seconds 2" >"$work/strict.log" 2>&1
  status=$?
  set -e
  [ $status -eq 1 ] || fail "a refusal without best effort must end with status 1, not $status"
  grep -q 'sched_setscheduler(SCHED_FIFO.*EPERM' "$work/strict.log" || fail "the refused call must be named"
fi
echo "the executor from outside: all held"
