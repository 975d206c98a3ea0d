#!/usr/bin/env bash
# `subsumectl top` as a user sees it: in a real terminal (tmux), small and large, every key.
#
#   tests/top.sh [FOLDER-OF-BINARIES]      default: target/release
# Needs tmux; says so and leaves when it is not there. CAPTURES=FOLDER keeps the screens.
set -euo pipefail
bin=$(realpath "${1:-target/release}")
command -v tmux >/dev/null || { echo "skipped: top in a terminal (no tmux)"; exit 0; }
work=$(mktemp -d)
export SUBSUMED_DOMAIN="top$$" SUBSUMED_RUN="$work/run" TMUX_TMPDIR="$work"
captures=${CAPTURES:-$work}
mkdir -p "$captures"
daemon="" wander=""
clean() {
  tmux kill-server 2>/dev/null || true
  for pid in $wander $daemon; do kill -9 "$pid" 2>/dev/null || true; done
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
fail() { echo "FAILED: $*"; screen; tail -n 5 "$work"/*.log; exit 1; }
screen() { tmux capture-pane -p -t top; }
# Waits until the screen shows something, however slow the machine is.
shows() { for _ in $(seq 150); do grep -q -- "$1" <<<"$(screen)" && return; sleep 0.2; done; fail "the screen does not show: $1"; }
hides() { for _ in $(seq 150); do grep -q -- "$1" <<<"$(screen)" || return 0; sleep 0.2; done; fail "the screen still shows: $1"; }
keys() { tmux send-keys -t top "$@"; }
halted() { grep -q '"halted":true' <<<"$("$bin/subsumectl" --creature tops status --json)"; }

"$bin/subsumed" --name tops --headless --flight-recorder off >"$work/daemon.log" 2>&1 & daemon=$!
for _ in $(seq 200); do "$bin/subsumectl" --creature tops status >/dev/null 2>&1 && break; sleep 0.1; done
"$bin/allen-wander" --creature tops >"$work/wander.log" 2>&1 & wander=$!

# A server without sessions leaves, and the next session would find it leaving.
tmux -f /dev/null new-session -d -s stays "sleep 600"
for size in 80x24 200x60; do
  tmux -f /dev/null new-session -d -s top -x "${size%x*}" -y "${size#*x}" "$bin/subsumectl --creature tops top 2>$work/top.log; echo left with status \$?; sleep 60"
  shows '^the body may move'
  shows '^avoid '
  shows 'process [0-9]'
  shows '(S) avoid.heading'
  shows 'body.odometry'
  shows '[▁▂▃▄▅▆▇█]'
  screen >"$captures/top-$size.txt"
  [ "$(wc -l <"$captures/top-$size.txt")" -le "${size#*x}" ] || fail "the screen has too many lines"
  keys s; shows 'by name'
  keys / ; keys -l 'body.od'; keys Enter; shows 'filter: body.od'; hides 'forward.speed'; shows 'body.odometry'
  keys Escape; shows 'forward.speed'
  keys f; shows FROZEN; a=$(screen); sleep 1; [ "$a" = "$(screen)" ] || fail "a frozen screen must stand still"; keys f; hides FROZEN
  keys '?'; shows 'emergency stop, holds until reset'; keys Escape; hides 'holds until reset'
  keys h; shows 'HALTED: emergency stop'; halted || fail "h must halt"
  screen >"$captures/top-$size-halted.txt"
  keys r; shows '^the body may move'; halted && fail "r must reset"
  keys q; shows 'left with status 0'
  tmux kill-session -t top
done
"$bin/subsumectl" --creature tops top </dev/null >"$work/pipe.log" 2>&1 && fail "top without a terminal must end with status 1"
grep -q 'needs a terminal' "$work/pipe.log" || fail "top without a terminal must say so"
echo "top in a terminal: all held"
