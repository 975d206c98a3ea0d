#!/usr/bin/env bash
# Recordings from outside: what the daemon records is read by the PyPI package `mcap`, replayed without a
# difference, and asked why; the flight recorder keeps what halted; a hundred wires at 1 kHz are all there;
# metrics are scraped over HTTP.
#
#   tests/mcap.sh [FOLDER-OF-BINARIES]      default: target/release
# An export for ROS 2 is read by the PyPI package `rosbags`.
# Needs Python with venv and pip for the packages; says so and goes on without when they are not there.
set -euo pipefail
bin=$(realpath "${1:-target/release}")
here=$(realpath "$(dirname "$0")")
work=$(mktemp -d)
export SUBSUMED_DOMAIN="mcap$$" SUBSUMED_RUN="$work/run"
daemon="" wander=""
clean() {
  for pid in $wander $daemon; do kill -9 "$pid" 2>/dev/null || true; done
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
fail() { tail -n 20 "$work"/*.log; echo "FAILED: $*"; exit 1; }
ctl() { "$bin/subsumectl" --creature recs "$@"; }
up() { for _ in $(seq 200); do ctl status >/dev/null 2>&1 && return; sleep 0.1; done; fail "the daemon did not come up"; }

python=""
if [ -n "${MCAP_PYTHON:-}" ]; then python=$MCAP_PYTHON
elif python3 -m venv "$work/venv" 2>"$work/pip.log" && "$work/venv/bin/pip" -q install mcap 2>>"$work/pip.log"; then python="$work/venv/bin/python"
else echo "skipped: reading recordings with the PyPI package mcap (no venv, pip or network)"; fi
if [ -n "$python" ] && [ -z "${MCAP_PYTHON:-}" ] && ! "$work/venv/bin/pip" -q install rosbags 2>>"$work/pip.log"; then
  echo "skipped: reading exports with the PyPI package rosbags (pip refused it)"
fi
rosbags=""
[ -n "$python" ] && "$python" -c 'import rosbags' 2>/dev/null && rosbags=$python
reads() { [ -z "$python" ] || "$python" "$here/mcap_check.py" "$@" || fail "the package mcap does not agree with $1"; }

# Allen with a layer that comes and goes, from the first beat on.
"$bin/subsumed" --name recs --headless --record "$work/all.mcap" --flight-recorder "$work/flight" \
  --metrics-port 0 --metrics-socket "$work/metrics.sock" >"$work/daemon.log" 2>&1 & daemon=$!
up
"$bin/allen-wander" --creature recs >"$work/wander.log" 2>&1 & wander=$!
sleep 3
ctl record -o "$work/part.mcap" --seconds 3 --json >"$work/part.json" || fail "a recording of three seconds"
grep -q '"lost":0' "$work/part.json" || fail "lost messages: $(cat "$work/part.json")"
ctl record -o "$work/past.mcap" --past >/dev/null || fail "what the flight recorder holds"
ctl why body.turn >"$work/why.txt" || fail "why, live"
grep -q 'told to the body by the motor unit' "$work/why.txt" && grep -q 'a sensor of the body' "$work/why.txt" || fail "the chain must lead from the body back to its sensors: $(cat "$work/why.txt")"
grep -q '"tap":"wander"' <<<"$(ctl why turn.heading --json)" || fail "why must name the tap that brought the heading"
grep -q 'turn.heading: held by avoid.heading of wander' <<<"$(ctl holders)" || fail "holders must show the tap that holds"
ctl why nonsense 2>"$work/bad.log" && fail "an unknown wire must be refused"
grep -q 'expected one of' "$work/bad.log" || fail "an unknown wire must be told which there are"
if command -v curl >/dev/null; then
  curl -sf --unix-socket "$work/metrics.sock" http://x/metrics >"$work/metrics.txt" || fail "metrics over the socket"
  [ "$(tail -n 1 "$work/metrics.txt")" = '# EOF' ] || fail "metrics must end with # EOF"
  grep -q '^subsumed_beats_total{creature="recs",layer="avoid"} [1-9]' "$work/metrics.txt" || fail "beats must be among the metrics"
  grep -q '^subsumed_attached_layers{creature="recs"} 1$' "$work/metrics.txt" || fail "attached layers must be among the metrics"
  [ "$(curl -s -o /dev/null -w '%{http_code}' --unix-socket "$work/metrics.sock" http://x/)" = 404 ] || fail "there is only /metrics"
else
  echo "skipped: metrics over HTTP (no curl)"
fi
ctl record -o "$work/ring.mcap" --ring 2s >"$work/ring.log" 2>&1 & ring=$!
sleep 3
kill -9 "$wander"; wait "$wander" 2>/dev/null || true; wander=""
ctl halt >/dev/null
wait $ring || fail "a ring ends with the halt: $(cat "$work/ring.log")"
for _ in $(seq 300); do ls "$work"/flight/recs-*-emergency-stop.mcap >/dev/null 2>&1 && break; sleep 0.1; done
ls "$work"/flight/recs-*-emergency-stop.mcap >/dev/null || fail "the flight recorder must keep a halt"
kill -TERM $daemon; wait $daemon || fail "SIGTERM must end with status 0"; daemon=""
[ "$(ls "$work/flight" | wc -l)" = 1 ] || fail "a shutdown is no reason to keep a file: $(ls "$work/flight")"
for file in all part past ring; do reads "$work/$file.mcap"; done
reads "$work"/flight/*.mcap
"$bin/subsumectl" replay "$work/all.mcap" >"$work/replay.txt" || fail "the same build must give the same outputs: $(cat "$work/replay.txt")"
grep -q '^no difference' "$work/replay.txt" || fail "$(cat "$work/replay.txt")"
grep -q '^note' "$work/replay.txt" && fail "a recording from the first beat has nothing to be noted: $(cat "$work/replay.txt")"
"$bin/subsumectl" why collide.halt --from "$work"/flight/*.mcap --at -1 >/dev/null || fail "why, from a flight recording"
"$bin/subsumectl" why turn.rate --from "$work/all.mcap" --at 1e6 2>"$work/bad.log" && fail "a time outside the recording must be refused"
"$bin/subsumectl" export "$work/all.mcap" -o "$work/ros2.mcap" || fail "an export for ROS 2"
"$bin/subsumectl" export "$work/all.mcap" -o "$work/ros2.mcap" 2>"$work/bad.log" && fail "an export must not write over a file"
[ -z "$rosbags" ] || "$rosbags" "$here/ros2_check.py" "$work/all.mcap" "$work/ros2.mcap" || fail "the package rosbags does not agree"
head -c 200000 "$work/all.mcap" >"$work/cut.mcap"
"$bin/subsumectl" replay "$work/cut.mcap" >"$work/cut.txt" || fail "what is left of a recording replays: $(cat "$work/cut.txt")"
grep -q 'cut off' "$work/cut.txt" || fail "a recording that was cut off must be called that"
set +e
"$bin/subsumectl" replay "$work/why.txt" 2>"$work/bad.log"; [ $? -eq 2 ] || fail "what is no recording must end with status 2"
set -e

# A change must show: a sonar that pings half as often.
python3 - "$work/all.mcap" "$work/changed.toml" <<'P' 2>/dev/null || cp "$here/../layers/allen/allen.toml" "$work/changed.toml"
import re, sys
text = re.search(rb'# Allen.*?tap = \["turn.heading"\][^\n]*\n', open(sys.argv[1], "rb").read(), re.S).group(0)
open(sys.argv[2], "wb").write(text)
P
sed -i 's/every = "1s"/every = "2s"/' "$work/changed.toml"
set +e
"$bin/subsumectl" --creature "$work/changed.toml" replay "$work/all.mcap" >"$work/changed.txt"; [ $? -eq 1 ] || fail "a changed creature must differ: $(cat "$work/changed.txt")"
set -e
grep -q '^  first at' "$work/changed.txt" || fail "a difference must be placed"

# A hundred wires at 1 kHz.
{
  printf 'creature = "hundred"\nseed = 1\n[body]\nkind = "office"\nperiod = "20ms"\n[[layer]]\nname = "many"\nlevel = 0\nperiod = "1ms"\nvital = true\nwires = [\n'
  for k in $(seq 50); do printf '"body.compass -> t%s.compass", "t%s.go -> f%s.go", "f%s.done -> t%s.done",\n' $k $k $k $k $k; done
  printf '"body.sonar -> s.echo", "s.ping -> body.ping", "s.map -> c.map", "body.odometry -> c.pose", "c.halt -> f1.halt", "t1.rate -> body.turn", "f1.speed -> body.forward" ]\n[layer.modules]\ns = { kind = "allen.sonar", every = "1s" }\nc = { kind = "allen.collide" }\n'
  for k in $(seq 50); do printf 't%s = { kind = "allen.turn" }\nf%s = { kind = "allen.forward" }\n' $k $k; done
  printf '[halt]\nreflex = ["c.halt"]\nhold = "60ms"\nstale = "200ms"\n[outsiders]\ntap = ["t1.heading"]\n'
} >"$work/hundred.toml"
"$bin/subsumectl" check "$work/hundred.toml" || fail "the creature of a hundred wires"
"$bin/subsumed" --creature "$work/hundred.toml" --name recs --headless --flight-recorder off >"$work/hundred.log" 2>&1 & daemon=$!
up
ctl record -o "$work/hundred.mcap" --seconds 5 --json >"$work/hundred.json" || fail "recording a hundred wires"
kill -TERM $daemon; wait $daemon || true; daemon=""
messages=$(sed 's/.*"messages":\([0-9]*\).*/\1/' "$work/hundred.json") lost=$(sed 's/.*"lost":\([0-9]*\).*/\1/' "$work/hundred.json")
[ "$messages" -gt 100000 ] || fail "a hundred wires at 1 kHz: $(cat "$work/hundred.json") $(cat "$work/hundred.log")"
reads "$work/hundred.mcap" "$lost"
echo "recordings from outside: all held (a hundred wires at 1 kHz: $messages messages, $lost lost)"
