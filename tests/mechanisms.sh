#!/usr/bin/env bash
# Hierarchies of releasing mechanisms in real processes: one as level 2 on Allen's levels 0 and 1, plugged in, told
# commands, killed and plugged in again while the robot drives; then the nest builder in a daemon and on its page.
#
#   tests/mechanisms.sh [FOLDER-OF-BINARIES]    default: target/release; about a minute. SCREENSHOT=FILE keeps the picture
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$(realpath "${1:-target/release}")
work=$(mktemp -d)
export SUBSUMED_DOMAIN="mech$$" SUBSUMED_RUN="$work/run" XDG_STATE_HOME="$work/state"
daemon="" drives=""
clean() {
  for pid in $drives $daemon; do kill -9 "$pid" 2>/dev/null || true; done
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
creature=allen
ctl() { "$bin/subsumectl" --creature "$creature" "$@"; }
fail() {
  echo "FAILED: $*"
  ctl status || true
  ctl holders || true
  tail -n 20 "$work"/*.log
  exit 1
}
until_shown() {
  local what=$1 pattern=$2
  shift 2
  for _ in $(seq 600); do
    "$@" >"$work/shown" 2>&1 || true
    grep -qE "$pattern" "$work/shown" && { echo "ok: $what"; return; }
    sleep 0.2
  done
  cat "$work/shown"
  fail "$what: no $pattern in $*"
}
plug() { "$bin/allen-drives" --commands "$work/commands" "$@" >>"$work/drives.log" 2>&1 & drives=$!; }
# Headings in three seconds; the newest of before counts as well.
said() { ctl watch drives.heading --seconds 3 2>/dev/null | grep -c '#' || true; }
adroit() { local what=$1; shift; "$bin/subsumectl" adroit "$what" --socket "$work/commands" "$@"; }

echo "== level 2 on Allen"
"$bin/subsumed" --creature layers/allen/allen-01.toml --no-page --flight-recorder off >"$work/daemon.log" 2>&1 &
daemon=$!
until_shown "levels 0 and 1 beat" '^wander ' ctl status
printf 'rm explore reports to topp.\n' >"$work/bad.adroit"
"$bin/allen-drives" --program "$work/bad.adroit" >"$work/bad.log" 2>&1 && fail "a program with errors must be refused"
grep -q 'bad.adroit:1:23: ' "$work/bad.log" || fail "line and column must be told"
plug
until_shown "level 2 is attached" 'drives .*attached' ctl status
until_shown "level 1 goes by its headings" 'drives.heading' ctl holders

echo "== commands while it drives"
adroit apply 'threshold of rm explore is 0.1. rm nowhere reports to nothing.' && fail "a command is all or nothing"
[ -z "$(adroit list)" ] || fail "nothing was to be applied"
answer=$(adroit apply 'threshold of rm explore is 5. threshold of rm seek-space is 5. threshold of rm rest is 5.')
grep -qE 'after evaluation [1-9]' <<<"$answer" \
  || fail "the evaluation it was applied after must be told"
sleep 0.5
[ "$(said)" -le 1 ] || fail "with no drive above its threshold nothing is said"
grep -q 'threshold of rm explore is 5' <<<"$(adroit list)" || fail "the list must show it"
adroit save >"$work/saved.adroit"
"$bin/subsumectl" adroit check --robot drives "$work/saved.adroit" || fail "what is saved must load"
grep -q 'taken back' <<<"$(adroit undo)" || fail "the latest command can be taken back"
[ -z "$(adroit list)" ] || fail "the list must be empty again"
sleep 0.5
[ "$(said)" -gt 1 ] || fail "what is taken back has no effect any more"

echo "== killed and plugged in again"
kill -9 $drives; drives=""
until_shown "its death is told" 'layer drives \(pid [0-9]+\) died' ctl events
beats() { ctl status | awk -v layer="$1" '$1 == layer { print $5 }'; }
zero=$(beats avoid); one=$(beats wander); sleep 1
[ "$(beats avoid)" -gt "$zero" ] && [ "$(beats wander)" -gt "$one" ] || fail "levels 0 and 1 must go on"
plug
until_shown "level 2 is attached again" 'drives .*attached' ctl status
until_shown "and has the robot again" 'drives.heading' ctl holders
adroit list >/dev/null || fail "the dead process's socket must not be in the way"
kill $drives; wait $drives || fail "SIGTERM must end with status 0"
drives=""
kill $daemon; wait $daemon || fail "the daemon must end with status 0"
daemon=""

echo "== the nest builder"
creature=nest
"$bin/subsumed" --commands "$work/none" --headless 2>"$work/none.log" && fail "Allen has no hierarchy to command"
grep -q -- '--commands: expected one module of kind mechanisms' "$work/none.log" || fail "that must be told"
"$bin/subsumed" --creature layers/mechanisms/nest.toml --commands "$work/commands" --page-port 0 --flight-recorder off >"$work/nest.log" 2>&1 &
daemon=$!
until_shown "it drives" 'nest.wheel .* 0\.[1-9]' ctl wires
until_shown "it carries an object" '#[0-9]+ +[1-9]' ctl watch body.held --count 1
[ "$(ctl status --json | tr ',{' '\n\n' | sed -n 's/.*"real_time_allocations": *//p' | head -1)" = 0 ] || fail "allocations on real-time threads"
adroit apply 'rm idle reports to top. add stimulus always to rm idle with magnitude 9. threshold of rm idle is 0.' >"$work/told" 2>&1 \
  && fail "an RM without anything to control is an error: $(cat "$work/told")"
adroit apply 'rm wait reports to top. add stimulus always to rm wait with magnitude 50. mcu arm reports to rm wait.' \
  || fail "the hierarchy in the daemon takes commands"
grep -q 'rm wait reports to top' <<<"$(adroit list)" || fail "the list must show it"
until_shown "commanded to wait, it stands" '#[0-9]+ +0(\.0+)?( |$)' ctl watch nest.wheel --count 1
port=$(sed -n 's#.*http://127.0.0.1:\([0-9]*\)/#\1#p' "$work/nest.log")
grep -q '"wait"' <<<"$(curl -s "http://127.0.0.1:$port/api/plan")" \
  || fail "the page must draw the hierarchy that runs"
adroit undo || fail "and takes them back"
until_shown "and drives on" 'nest.wheel .* 0\.[1-9]' ctl wires
[ "$(stat -c %a "$work/commands")" = 600 ] || fail "commands are the owner's alone"
if command -v chromium >/dev/null; then
  timeout 90 chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --user-data-dir="$work/chromium" --window-size="${WINDOW:-1400,1500}" \
    --virtual-time-budget=6000 --screenshot="${SCREENSHOT:-$work/page.png}" --dump-dom "http://127.0.0.1:$port/" >"$work/dom.html" 2>"$work/chromium.log" \
    || fail "chromium failed"
  grep -q 'data-connected="true"' "$work/dom.html" || fail "the page does not reach the daemon"
  grep -q 'of 6 objects, fuel' "$work/dom.html" || fail "the page does not show the nest"
  grep -q 'data-lit="active"' "$work/dom.html" || fail "no RM is lit on the page"
  grep -q 'data-lit="deaf"' "$work/dom.html" || fail "an RM below an inactive one is deaf"
  echo "ok: the page shows the floor and the lit tree"
else
  echo "skipped: the page in a browser (no chromium)"
fi
kill $daemon; wait $daemon || fail "the daemon must end with status 0"
daemon=""
[ ! -e "$work/commands" ] || fail "the socket must be gone"
echo "all is well"