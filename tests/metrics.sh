#!/usr/bin/env bash
# Metrics as Prometheus meets them: scraped from a port and from a Unix socket while a layer comes and goes, and read by
# the parser of the PyPI package prometheus_client; the alert rules are YAML of the right shape.
#
#   tests/metrics.sh [FOLDER-OF-BINARIES]      default: target/release
# Needs curl, and Python with venv and pip for the parser; says what it skipped.
set -euo pipefail
bin=$(realpath "${1:-target/release}")
here=$(realpath "$(dirname "$0")")
work=$(mktemp -d)
export SUBSUMED_DOMAIN="metrics$$" SUBSUMED_RUN="$work/run"
daemon="" wander=""
clean() {
  for pid in $wander $daemon; do kill -9 "$pid" 2>/dev/null || true; done
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
fail() { echo "FAILED: $*"; tail -n 20 "$work"/*.log; exit 1; }
ctl() { "$bin/subsumectl" --creature scraped "$@"; }
command -v curl >/dev/null || { echo "skipped: metrics (no curl)"; exit 0; }
python=""
if python3 -m venv "$work/venv" >"$work/venv.log" 2>&1 && "$work/venv/bin/pip" install -q prometheus_client pyyaml >>"$work/venv.log" 2>&1; then
  python="$work/venv/bin/python"
else
  echo "skipped: reading metrics with prometheus_client (no venv, pip or network)"
fi

"$bin/subsumed" --name scraped --headless --seed 3 --flight-recorder off --seconds 120 \
  --metrics-port 0 --metrics-socket "$work/metrics.sock" >"$work/daemon.log" 2>&1 & daemon=$!
for _ in $(seq 100); do ctl status >/dev/null 2>&1 && break; sleep 0.1; done
address=$(sed -n 's#^metrics: \(http://127.0.0.1:[0-9]*/metrics\)$#\1#p' "$work/daemon.log")
[ -n "$address" ] || fail "the port must be told"
scrape() { curl -sf "$address" >"$work/$1.txt" || fail "a scrape over the port"; }
has() { grep -qxF "$2" "$work/$1.txt" || fail "$1: expected: $2"; }
scrape before
"$bin/allen-wander" --creature scraped >"$work/wander.log" 2>&1 & wander=$!
for _ in $(seq 100); do grep -q 'wander .*attached' <<<"$(ctl status)" && break; sleep 0.1; done
ctl halt >/dev/null
sleep 1.5
scrape during
kill -9 "$wander"; wait "$wander" 2>/dev/null || true; wander=""
for _ in $(seq 100); do grep -q 'wander .*attached' <<<"$(ctl status)" || break; sleep 0.1; done
sleep 0.3
curl -sf --unix-socket "$work/metrics.sock" http://creature/metrics >"$work/after.txt" || fail "a scrape over the socket"
grep -qi '^content-type: application/openmetrics-text; version=1.0.0' <<<"$(curl -sI "$address")" || fail "the media type"
has before 'subsumed_attached_layers{creature="scraped"} 0'
has before 'subsumed_halts_total{creature="scraped",cause="emergency stop"} 0'
has during 'subsumed_attached_layers{creature="scraped"} 1'
has during 'subsumed_layer_attached{creature="scraped",layer="wander",level="1"} 1'
has during 'subsumed_halts_total{creature="scraped",cause="emergency stop"} 1'
has during 'subsumed_halted{creature="scraped"} 1'
grep -q '^subsumed_tap_delivered_total{creature="scraped",from="avoid.heading",to="turn.heading",kind="suppress"} [1-9]' "$work/during.txt" || fail "taps must be counted"
has after 'subsumed_attached_layers{creature="scraped"} 0'
if [ -n "$python" ]; then
  "$python" "$here/metrics_check.py" "$here/../deploy/prometheus" "$work"/{before,during,after}.txt || fail "the text must be OpenMetrics"
fi
kill -TERM $daemon; wait $daemon || fail "SIGTERM must end with status 0"; daemon=""
echo "metrics from outside: all held"
