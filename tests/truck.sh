#!/usr/bin/env bash
# A truck in the daemon, from outside: OOTland as its body, one game on the live page, the pace from there.
#
#   tests/truck.sh [FOLDER-OF-BINARIES]      default: target/release
# Needs curl, and chromium for the page itself; says what it skipped. SCREENSHOT=FILE keeps the picture.
set -euo pipefail
bin=$(realpath "${1:-target/release}")
root=$(realpath "$(dirname "$0")/..")
work=$(mktemp -d)
export SUBSUMED_DOMAIN="truck$$" SUBSUMED_RUN="$work/run"
daemon=""
clean() {
  [ -n "$daemon" ] && kill -9 "$daemon" 2>/dev/null || true
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
fail() { echo "FAILED: $*"; tail -n 20 "$work"/*.log; exit 1; }
ctl() { "$bin/subsumectl" --creature truck "$@"; }

# Bad input: a micro-strategy that is not there is told with its place and the nearest that is.
sed 's/"enough_for_the_game"/"enough_for_the_gane"/' "$root/layers/truckin/truck.toml" >"$work/bad.toml"
status=0; "$bin/subsumed" --creature "$work/bad.toml" 2>"$work/bad.log" || status=$?
[ $status -eq 2 ] || fail "an unknown micro-strategy must end with status 2"
grep -q 'bad.toml:[0-9]*:[0-9]*' "$work/bad.log" || fail "an unknown micro-strategy must be told with its place"
grep -q 'enough_for_the_game' "$work/bad.log" || fail "the nearest micro-strategy must be named"

"$bin/subsumed" --creature "$root/layers/truckin/truck.toml" --page-port 0 --flight-recorder off >"$work/daemon.log" 2>&1 &
daemon=$!
for _ in $(seq 100); do ctl status >/dev/null 2>&1 && break; sleep 0.1; done
ctl status >/dev/null || fail "the daemon did not come up"
page=$(sed -n 's#.*\(http://127.0.0.1:[0-9]*\)/#\1#p' "$work/daemon.log")
slot() { curl -s "$page/api/state" | tr ',{' '\n\n' | sed -n 's/^"slot":\([0-9]*\).*/\1/p' | head -1; }
pace() { curl -s -o "$work/answer.json" -w '%{http_code}' -X POST "$page/api/pace/$1"; }
grows() { for _ in $(seq 100); do [ "$(slot)" -gt "$1" ] && return; sleep 0.1; done; return 1; }

for _ in $(seq 100); do [ -n "$(slot)" ] && break; sleep 0.1; done
grows 2 || fail "slots must go by at the pace of the file"
[ "$(pace pause)" = 200 ] || fail "a pause must be taken"
sleep 2; paused=$(slot); sleep 1.5
[ "$(slot)" = "$paused" ] || fail "paused, the slot must stay"
[ "$(pace step)" = 200 ] || fail "a step must be taken"
grows "$paused" || fail "a step must play a slot"
sleep 1.5
[ "$(slot)" = $((paused + 1)) ] || fail "a step must play one slot: $paused, then $(slot)"
[ "$(pace quick)" = 409 ] || fail "an unknown pace must be refused"
grep -q 'pause or step' "$work/answer.json" || fail "the refusal must say which there are"
[ "$(pace fast)" = 200 ] || fail "fast must be taken"
grows $((paused + 40)) || fail "fast, slots must go by quickly"
grep -q '"real_time_allocations":0[,}]' <<<"$(ctl status --json)" || fail "deliberating must allocate nothing on a real-time thread"

if command -v chromium >/dev/null; then
  pace slow >/dev/null
  timeout 90 chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --user-data-dir="$work/chromium" --window-size="${WINDOW:-1500,1250}" \
    --virtual-time-budget=4000 --screenshot="${SCREENSHOT:-$work/page.png}" --dump-dom "$page/" >"$work/dom.html" 2>"$work/chromium.log" \
    || fail "chromium failed"
  grep -q 'data-connected="true"' "$work/dom.html" || fail "the page does not reach the daemon"
  for sign in 'id="ootland-panel"' 'class="dealer" data-kind="retailer"' 'data-truck="4"' 'class="capital"' \
    'data-state="holds"' 'data-pace="slow"' 'this creature' 'gas getting' 'call the neighbours'; do
    grep -q "$sign" "$work/dom.html" || fail "the page does not show $sign"
  done
  grep -q 'Refused to apply' "$work/chromium.log" && fail "the page's own policy refuses a part of it"
else
  echo "skipped: the page in a browser (no chromium)"
fi
kill -TERM $daemon; wait $daemon || fail "SIGTERM must end with status 0"
daemon=""
left=$(ls /dev/shm | grep "^iox2_${SUBSUMED_DOMAIN}_" || true)
[ -z "$left" ] || fail "left in /dev/shm: $left"
echo "the truck drives, the page shows it, the pace is kept"
