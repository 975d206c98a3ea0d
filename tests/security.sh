#!/usr/bin/env bash
# What other users can do to a running creature, tried as they are: needs root, to become them.
#
#   tests/security.sh [FOLDER-OF-BINARIES]      default: target/release
# The answers stand in deploy/SECURITY.md.
set -euo pipefail
if [ "$(id -u)" != 0 ] || ! command -v setpriv >/dev/null; then
  echo "skipped: what other users can do (needs root and setpriv, to become them)"
  exit 0
fi
bin=$(realpath "${1:-target/release}")
work=$(mktemp -d)
chmod 755 "$work"
cp "$bin/subsumed" "$bin/subsumed-body" "$bin/subsumectl" "$bin/allen-wander" "$work/"
export SUBSUMED_DOMAIN="sec$$" SUBSUMED_RUN="$work/run"
export XDG_STATE_HOME="$work/state"; unset STATE_DIRECTORY
mkdir -m 755 "$SUBSUMED_RUN"
owner=60001 stranger=60002
chown $owner:$owner "$SUBSUMED_RUN"
daemon="" body=""
clean() {
  for pid in $daemon $body; do kill -9 "$pid" 2>/dev/null || true; done
  rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
}
trap clean EXIT
fail() { echo "FAILED: $*"; tail -n 20 "$work"/*.log; exit 1; }
as() { local user=$1; shift; setpriv --reuid="$user" --regid="$user" --clear-groups "$@"; }
# Same group as the daemon, another user.
member() { setpriv --reuid=$stranger --regid=$owner --clear-groups "$@"; }
passed=0
may() { local what=$1; shift; "$@" >"$work/try.log" 2>&1 || fail "must be possible: $what"; passed=$((passed + 1)); }
may_not() { local what=$1; shift; "$@" >"$work/try.log" 2>&1 && fail "must not be possible: $what"; passed=$((passed + 1)); }

setpriv --reuid=$owner --regid=$owner --clear-groups "$work/subsumed-body" --name hall --seconds 120 2>"$work/body.log" & body=$!
setpriv --reuid=$owner --regid=$owner --clear-groups "$work/subsumed" --name guarded --body hall --page-port 0 --seconds 120 \
  >"$work/daemon.out" 2>"$work/daemon.log" & daemon=$!
disown -a
ctl() { "$work/subsumectl" --creature guarded "$@"; }
for _ in $(seq 100); do as $owner "$work/subsumectl" --creature guarded status >/dev/null 2>&1 && break; sleep 0.1; done

may "the same user asks for the status" as $owner "$work/subsumectl" --creature guarded status
may "root asks for the status" ctl status
for who in "as $stranger" member; do
  for order in status halt reset events; do
    may_not "$who: subsumectl $order" $who "$work/subsumectl" --creature guarded $order
  done
  may_not "$who: plugs a layer in" timeout 10 $who "$work/allen-wander" --creature guarded --once
  may_not "$who: reaches the body's socket" $who python3 -c "import socket,sys; socket.socket(socket.AF_UNIX).connect('$SUBSUMED_RUN/$SUBSUMED_DOMAIN.hall.body')"
  may_not "$who: signals the daemon" $who kill -STOP $daemon
  for file in /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"* "$SUBSUMED_RUN"/*; do
    may_not "$who: reads $file" $who sh -c "cat '$file'"
    may_not "$who: truncates $file" $who sh -c "truncate -s 0 '$file'"
    may_not "$who: removes $file" $who sh -c "rm -f '$file' && [ ! -e '$file' ]"
  done
done
# Without real time a busy host may make a layer late; what nobody else may have done is halt or cut anything.
if ctl events | grep -E 'emergency stop|reset|cut short|died|policy breach' >"$work/try.log"; then
  fail "the creature must be unharmed"
fi
if command -v curl >/dev/null; then
  page=$(sed -n 's#.*\(http://127.0.0.1:[0-9]*\)/.*#\1#p' "$work/daemon.out" | head -1)
  may "another user looks at the page" as $stranger curl -fsS "$page/api/state"
  may "another user halts through the page" as $stranger curl -fsS -X POST "$page/api/halt"
  may "the same user resets it" as $owner "$work/subsumectl" --creature guarded reset
else
  echo "skipped: the live page (no curl)"
fi
may "the same user halts it" as $owner "$work/subsumectl" --creature guarded halt
may "the same user resets it" as $owner "$work/subsumectl" --creature guarded reset
may "the same user stops the daemon" as $owner kill -STOP $daemon
for _ in $(seq 100); do grep -q 'halted: stale command' "$work/body.log" && break; sleep 0.1; done
grep -q 'halted: stale command' "$work/body.log" || fail "the body must halt by itself"
echo "what users can do: $passed tried, all as deploy/SECURITY.md says"
