#!/usr/bin/env bash
# The story of incremental building, as a user would live it: a daemon with level 0 of Allen, level 1 plugged in as a
# process, level 2 plugged in as a process on top of that; each is killed, all live; and every time it is asked whose
# message drives the wheels.
#
#   tests/story.sh [FOLDER-OF-BINARIES]      default: target/release
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$(realpath "${1:-target/release}")
work=$(mktemp -d)
export SUBSUMED_DOMAIN="story$$" SUBSUMED_RUN="$work/run" XDG_STATE_HOME="$work/state"
daemon="" wander="" explore=""
clean() {
  for pid in $explore $wander $daemon; do kill -9 "$pid" 2>/dev/null || true; done
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
ctl() { "$bin/subsumectl" --creature allen "$@"; }
fail() {
  echo "FAILED: $*"
  ctl status || true
  ctl holders || true
  ctl events || true
  tail -n 20 "$work"/*.log
  exit 1
}
# Waits until a command of subsumectl shows what is wanted: a hang ends the story, slowness does not.
until_shown() {
  local what=$1 pattern=$2
  shift 2
  for _ in $(seq 900); do
    ctl "$@" >"$work/shown" 2>/dev/null || true
    grep -qE "$pattern" "$work/shown" && { echo "ok: $what"; return; }
    sleep 0.2
  done
  fail "$what: no $pattern in subsumectl $*"
}
never_shown() {
  local what=$1 pattern=$2
  shift 2
  ctl "$@" >"$work/shown"
  ! grep -qE "$pattern" "$work/shown" || fail "$what: $pattern in subsumectl $*"
}
plug() { "$bin/allen-$1" --creature allen "${@:2}" >>"$work/$1.log" 2>&1 & }
# Its beats are counted on: level 0 never stops, whoever comes and goes above it.
level_0_goes_on() {
  local before after
  before=$(ctl status | awk '$1 == "avoid" { print $5 }')
  sleep 0.5
  after=$(ctl status | awk '$1 == "avoid" { print $5 }')
  [ "$after" -gt "$before" ] || fail "level 0 stands still: $before beats, then $after"
  until_shown "the body is free" '^halt: (no|reflex)$' status
}

echo "== level 0"
"$bin/subsumed" --creature layers/allen/allen.toml --page-port 0 --seed 6 --flight-recorder off >"$work/daemon.log" 2>&1 &
daemon=$!
until_shown "level 0 beats" '^avoid ' status
level_0_goes_on
until_shown "nobody taps it" 'nothing is tapped' holders
plug explore
explore=$!
wait $explore && fail "level 2 must be refused while there is no level 1"
explore=""
grep -q 'no module "avoid"' "$work/explore.log" || fail "level 2 must say what is missing"

echo "== level 1, a process"
grep -q -- '--wait' <("$bin/allen-explore" --help) || fail "the help must name --wait"
plug wander
wander=$!
until_shown "wander is attached" '^wander .*attached' status
until_shown "wander's message drives the wheels" '^turn.heading: held by avoid.heading of wander' holders
until_shown "and that is the reason" 'avoid.heading' why turn.rate
level_0_goes_on

echo "== level 2, a process, on a process"
plug explore
explore=$!
until_shown "explore is attached" '^explore .*attached' status
until_shown "its suppressor stands at wander" 'tap pathplan.heading > avoid.goal of layer explore joined at layer wander' events
until_shown "its inhibitor stands at wander" 'tap whenlook.hold > wander.heading of layer explore joined at layer wander' events
# It leads when it has found somewhere to go; it looks when the robot has come to rest, mostly within half a minute.
until_shown "explore's message leads" '^avoid.goal: held by pathplan.heading of explore' holders
until_shown "from explore through wander to the wheels" 'pathplan.heading' why turn.rate
level_0_goes_on
port=$(sed -n 's#.*http://127.0.0.1:\([0-9]*\)/.*#\1#p' "$work/daemon.log" | head -1)
if command -v curl >/dev/null; then
  curl -sf "http://127.0.0.1:$port/api/plan" >"$work/plan" || fail "the page shows no plan"
  grep -q 'pathplan.heading>avoid.goal\|pathplan.heading&gt;avoid.goal' "$work/plan" || fail "the page does not draw the tap of one process on another"
  echo "ok: the page draws it"
else
  echo "skipped: the page (no curl)"
fi

echo "== level 2 is killed"
kill -9 "$explore"
wait "$explore" 2>/dev/null || true
until_shown "its death is told" 'layer explore \(pid [0-9]+\) died' events
until_shown "its taps are let go" 'layer wander released the taps' events
until_shown "wander leads again" '^turn.heading: held by avoid.heading of wander' holders
never_shown "explore's windows ran out" 'of explore' holders
level_0_goes_on

echo "== level 2 is back; level 1 is killed under it"
plug explore
explore=$!
until_shown "explore is attached again" '^explore .*attached' status
until_shown "its taps stand again" 'pathplan.heading of explore' holders
kill -9 "$wander"
wait "$wander" 2>/dev/null || true
until_shown "its death is told" 'layer wander \(pid [0-9]+\) died' events
until_shown "explore waits for it" 'pathplan.heading > avoid.goal waits for wander' status
never_shown "explore stays" '^explore .*gone' status
until_shown "level 0 drives alone" 'nothing is tapped' holders
level_0_goes_on

echo "== level 1 is back"
plug wander
wander=$!
until_shown "wander is attached" '^wander .*attached' status
until_shown "explore taps the new one" 'pathplan.heading of explore' holders
never_shown "nothing waits any more" 'waits for' status
until_shown "down to the wheels" '^turn.heading: held by avoid.heading of wander' holders
level_0_goes_on

echo "== all leave"
kill -TERM "$explore"; wait "$explore" || fail "explore must end with status 0"; explore=""
kill -TERM "$wander"; wait "$wander" || fail "wander must end with status 0"; wander=""
until_shown "both detached" 'layer wander \(pid [0-9]+\) detached' events
level_0_goes_on
kill -TERM "$daemon"; wait "$daemon" || fail "the daemon must end with status 0"; daemon=""
left=$(ls /dev/shm | grep "^iox2_${SUBSUMED_DOMAIN}_" || true)
[ -z "$left" ] || fail "left in /dev/shm: $left"
echo "the story of Allen: each level joined, died and came back while the others lived"
