#!/usr/bin/env bash
# The units of deploy/ in a real systemd, booted for this (see tests/sdbox): start, ready, status, reload, stop, kills,
# freezes, layers that die, two creatures at once, real time refused.
#
#   tests/systemd.sh [FOLDER-OF-BINARIES]      default: target/release
# Needs root, systemd, util-linux and overlayfs; says what it skipped without.
set -euo pipefail
cd "$(dirname "$0")/.."
skip() { echo "skipped: the units in a real systemd ($*)"; exit 0; }
[ "$(id -u)" = 0 ] || skip "needs root, to boot one"
[ -x /lib/systemd/systemd ] || skip "no systemd; \`apt-get install systemd\` grants it"
for tool in unshare nsenter pivot_root systemd-analyze; do command -v $tool >/dev/null || skip "no $tool"; done
bin=$(realpath "${1:-target/release}")
stage=$(mktemp -d)
export SDBOX=$stage/box
here=$PWD
clean() { "$here/tests/sdbox" down >/dev/null 2>&1 || true; rm -rf --one-file-system "$stage"; }
trap clean EXIT

files=$stage/files
mkdir -p "$files"/usr/{bin,lib/systemd/system,lib/sysusers.d,lib/tmpfiles.d,lib/udev/rules.d,share/doc/subsumed} "$files"/etc/subsumed/layers
for program in subsumed subsumed-body subsumectl allen-wander; do
  install -m 755 "$bin/$program" "$files/usr/bin/$program"
done
cp deploy/systemd/*.service "$files/usr/lib/systemd/system/"
cp deploy/sysusers.d/subsumed.conf "$files/usr/lib/sysusers.d/"
cp deploy/tmpfiles.d/subsumed.conf "$files/usr/lib/tmpfiles.d/"
cp deploy/udev/60-subsumed-serial.rules "$files/usr/lib/udev/rules.d/"
cp deploy/README.md "$files/usr/share/doc/subsumed/"
for name in tom jerry spike; do cp layers/allen/allen.toml "$files/etc/subsumed/$name.toml"; done
echo 'OPTIONS=--body spike' >"$files/etc/subsumed/spike.env"
printf 'creature = "x"\n[[layer]]\nname = \n' >"$files/etc/subsumed/bad.toml"
ln -s /usr/bin/allen-wander "$files/etc/subsumed/layers/tom-wander"
mkdir -p "$files/etc/systemd/system/subsumed-layer@tom-wander.service.d"
# The n-th drop-in of the manual.
drop_in() { awk -v n="$1" '/^```ini$/ {on = ++count == n; next} /^```$/ {on = 0} on' deploy/README.md; }
drop_in 1 >"$files/etc/systemd/system/subsumed-layer@tom-wander.service.d/creature.conf"
# Outside of the overlay a mkdtemp folder is for its owner alone.
chmod -R u=rwX,go=rX "$files"

passed=0
box() { tests/sdbox run "$@"; }
ctl() { local name=$1; shift; box env SUBSUMED_RUN=/run/subsumed subsumectl --creature "$name" "$@"; }
show() { box systemctl show --value -p "$2" "$1"; }
log() { box journalctl -q --no-pager -o cat "$@"; }
fail() {
  echo "FAILED: $*"
  box systemctl --no-pager --full status 'subsumed*' 2>/dev/null | tail -60 || true
  log -n 60 || true
  exit 1
}
ok() { passed=$((passed + 1)); echo "  $*"; }
# Waits for what must come; the time is a way out, no criterion.
until_true() { local what=$1 _; shift; for _ in $(seq 300); do "$@" >/dev/null 2>&1 && return; sleep 0.1; done; fail "never came: $what"; }
says() { local pattern=$1; shift; grep -q -- "$pattern" <<<"$(log "$@")"; }
status_says() { grep -q -- "$2" <<<"$(show "$1" StatusText)"; }
is_new() { local pid; pid=$(show "$1" MainPID); [ "$pid" != 0 ] && [ "$pid" != "$2" ]; }
active() { [ "$(show "$1" ActiveState)" = active ]; }
# Signal to a unit's main process; never to 0, which would be everybody here.
hit() {
  local pid
  pid=$(show "$2" MainPID)
  [ "${pid:-0}" -gt 1 ] || fail "$2 does not run"
  box kill "$1" "$pid"
}
restarted() { active "$1" && is_new "$1" "$2"; }
attached() { grep -q "$2 .*attached" <<<"$(ctl "$1" status)"; }
messages() { ctl "$1" --json wires | tr '{' '\n' | sed -n 's/.*"messages":\([0-9]*\).*"wire":"body.odometry".*/\1/p'; }
goes_on() { local before; before=$(messages "$1"); sleep 0.3; [ "$(messages "$1")" -gt "$before" ]; }

if ! tests/sdbox up "$files" 2>"$stage/up.log"; then
  cat "$stage/up.log"
  skip "this host does not let one boot: $(tail -1 "$stage/up.log")"
fi
box systemd-sysusers
box systemd-tmpfiles --create subsumed.conf
box systemctl daemon-reload

# Before anything runs: the files themselves.
units="subsumed@tom.service subsumed-body@tom.service subsumed-layer@tom-wander.service"
said=$(box systemd-analyze verify $units 2>&1 >/dev/null) || true
[ -z "$said" ] || fail "systemd-analyze verify: $said"
exposures=""
for unit in subsumed@:10 subsumed-layer@:10 subsumed-body@:11; do
  box systemd-analyze security --offline=true --threshold="${unit#*:}" "/usr/lib/systemd/system/${unit%:*}.service" >"$stage/security" \
    || fail "exposure: $(grep Overall "$stage/security")"
  exposures+=" ${unit%:*} $(sed -n 's/.*Overall.*service: \([0-9.]*\) .*/\1/p' "$stage/security")"
done
# A trial run over any device reads every rule and complains of what it does not understand.
device=$(box sh -c 'ls -d /sys/class/tty/* 2>/dev/null | head -1')
if command -v udevadm >/dev/null && [ -n "$device" ]; then
  box udevadm test --action=add "$device" >"$stage/udev" 2>&1 || true
  grep -q 'DEVPATH=' "$stage/udev" || fail "udevadm does not read rules: $(tail -3 "$stage/udev")"
  grep '^/usr/lib/udev/rules.d/60-subsumed' "$stage/udev" && fail "the udev rule is not sound"
else
  echo "  skipped: the udev rule (no udevadm, or no device to try it on)"
fi
ok "verified; exposure at most 1.0, of the body 1.1:$exposures"

# Start: `systemctl start` returns when it is ready, and not before.
box systemctl start subsumed@tom || fail "subsumed@tom does not start"
active subsumed@tom || fail "not active after its start"
status_says subsumed@tom '^level 0 (avoid); ' || fail "ready without a status"
beats=$(ctl tom --json status | grep -o '"beats":[0-9]*' | head -1 | cut -d: -f2)
[ "${beats:-0}" -gt 0 ] || fail "ready before the first beat"
until_true "the status of tom" status_says subsumed@tom 'level 0 (avoid); may move'
if chrt -f 1 true 2>/dev/null; then
  status_says subsumed@tom 'real time' || fail "real time was refused: $(log -u subsumed@tom)"
  grep -q '^watchdog *FF' <<<"$(box ps -L -o comm=,cls= -p "$(show subsumed@tom MainPID)")" || fail "the watchdog is not under SCHED_FIFO"
else
  echo "  skipped: SCHED_FIFO in a unit (this host does not grant it)"
fi
[ "$(box stat -c %U "/proc/$(show subsumed@tom MainPID)")" = subsumed ] || fail "it does not run as its user"
until_true "tom moves" goes_on tom
# A login session finds it without being told where, and is told why it may not.
box env XDG_RUNTIME_DIR=/run/user/0 subsumectl --creature tom status >/dev/null || fail "root must find the host's daemon"
said=$(box setpriv --reuid=60001 --regid=60001 --clear-groups env XDG_RUNTIME_DIR=/run/user/60001 subsumectl --creature tom status 2>&1) \
  && fail "another user must not ask for the status"
grep -q 'not open to this user' <<<"$said" || fail "another user must hear why: $said"
box setpriv --reuid=subsumed --regid=subsumed --init-groups subsumectl --creature tom watch body.odometry --count 3 --seconds 20 >"$stage/watch" \
  && [ "$(wc -l <"$stage/watch")" = 3 ] || fail "its own user must read wires: $(cat "$stage/watch")"
ok "started, ready, with its status: $(show subsumed@tom StatusText)"

# Two at once, on wires and sockets of their own.
box systemctl start subsumed@jerry || fail "a second creature does not start"
until_true "jerry moves" goes_on jerry
active subsumed@tom || fail "the first did not outlive the start of the second"
ctl jerry halt >/dev/null
until_true "jerry halts" status_says subsumed@jerry 'halted: emergency'
status_says subsumed@tom 'may move' || fail "a halt of one creature halted the other"
until_true "the journal knows the cause" says 'the body is halted' -u subsumed@jerry SUBSUMED_KIND=halt 'SUBSUMED_CAUSE=emergency stop'
ctl jerry reset >/dev/null
until_true "jerry goes on" status_says subsumed@jerry 'may move'
until_true "the flight recorder's file" box sh -c 'ls /var/lib/subsumed/jerry-*-emergency-stop.mcap'
ok "two at once; halt state in the status, its cause in a field of the journal"

# Reload: nothing changes while it runs, and the journal says so.
pid=$(show subsumed@tom MainPID)
box systemctl reload subsumed@tom || fail "a reload with a sound file must succeed"
until_true "reload, nothing new" says 'sound, and says what runs' -u subsumed@tom
box sed -i 's/^seed = 1$/seed = 2/' /etc/subsumed/tom.toml
box systemctl reload subsumed@tom || fail "a reload with a changed file must succeed"
until_true "reload, the seed" says 'the seed changed, which takes a restart' -u subsumed@tom
box cp /etc/subsumed/tom.toml /tmp/tom.toml
box cp /etc/subsumed/bad.toml /etc/subsumed/tom.toml
box systemctl reload subsumed@tom 2>/dev/null && fail "a reload with a broken file must fail"
until_true "the reload's errors" says 'tom.toml:3:' -u subsumed@tom
box systemctl kill --kill-whom=main -s HUP subsumed@tom
until_true "SIGHUP with a broken file" says 'not sound any more; the creature runs on' -u subsumed@tom
box cp /tmp/tom.toml /etc/subsumed/tom.toml
[ "$(show subsumed@tom MainPID)" = "$pid" ] || fail "a reload must not restart"
goes_on tom || fail "the creature must run on after a reload"
ok "reloaded with a sound, a changed and a broken file"

# A layer of its own unit, killed while the creature moves.
box systemctl start subsumed-layer@tom-wander || fail "the layer does not start"
until_true "the layer attaches" attached tom wander
until_true "level 1 in the status" status_says subsumed@tom 'level 1 (avoid, wander)'
layer=$(show subsumed-layer@tom-wander MainPID)
hit -KILL subsumed-layer@tom-wander
until_true "the layer's death in the journal" says "layer wander (pid [0-9]*) died" -u subsumed@tom
goes_on tom || fail "the creature must move on without the layer"
until_true "the layer's restart" restarted subsumed-layer@tom-wander "$layer"
until_true "the layer attaches again" attached tom wander
[ "$(show subsumed@tom MainPID)" = "$pid" ] || fail "the death of a layer must not touch the daemon"
entry=$(box journalctl -q --no-pager -o json SUBSUMED_CREATURE=tom SUBSUMED_LAYER=wander SUBSUMED_WIRE=turn.heading | tail -1)
for field in '"SUBSUMED_KIND":"layer"' '"SUBSUMED_TIME":"' '"_SYSTEMD_UNIT":"subsumed@tom.service"' '"PRIORITY":"6"'; do
  grep -qF -- "$field" <<<"$entry" || fail "the journal must have $field about the layer: $entry"
done
ok "a layer was killed and came back; the creature moved on; layer and wire are fields of the journal"

# SIGKILL: started again, and the layer finds it again.
hit -KILL subsumed@tom
until_true "the restart after SIGKILL" restarted subsumed@tom "$pid"
until_true "tom moves after SIGKILL" goes_on tom
until_true "the layer finds the new daemon" attached tom wander
ok "killed, started again (NRestarts $(show subsumed@tom NRestarts)); its layer found it again"

# SIGSTOP: nobody feeds, so systemd's watchdog ends it.
pid=$(show subsumed@tom MainPID)
hit -STOP subsumed@tom
until_true "the restart after SIGSTOP" restarted subsumed@tom "$pid"
until_true "the watchdog in the journal" says 'Watchdog timeout' -u subsumed@tom
until_true "tom moves after SIGSTOP" goes_on tom
ok "frozen, caught by the watchdog, started again"

# A body of its own: it outlives its daemon, halted.
box systemctl start subsumed-body@spike subsumed@spike || fail "body and daemon do not start"
until_true "spike may move" status_says subsumed@spike 'may move'
until_true "the body is free" says 'body spike: free to move' -u subsumed-body@spike
pid=$(show subsumed@spike MainPID) body=$(show subsumed-body@spike MainPID)
hit -STOP subsumed@spike
until_true "the body halts by itself" says 'body spike: halted: stale command' -u subsumed-body@spike
until_true "spike starts again" restarted subsumed@spike "$pid"
until_true "spike may move again" status_says subsumed@spike 'may move'
box systemctl stop subsumed@spike
until_true "the body is left" says 'left' -u subsumed-body@spike
[ "$(show subsumed-body@spike MainPID)" = "$body" ] || fail "the body must outlive its daemons"
box systemctl stop subsumed-body@spike
ok "a body process halts by itself and outlives its daemon"

# Stop: the body is halted before the process ends; the layer goes with its daemon.
invocation=$(show subsumed@tom InvocationID)
box systemctl stop subsumed@tom
[ "$(show subsumed@tom Result)" = success ] || fail "a stop must end with success, not $(show subsumed@tom Result)"
until_true "the layer stops with its daemon" sh -c "! SDBOX=$SDBOX tests/sdbox run systemctl -q is-active subsumed-layer@tom-wander"
# Both speak to the journal through one socket, so their order there is the order in which it happened.
line_of() { log "_SYSTEMD_INVOCATION_ID=$invocation" + "INVOCATION_ID=$invocation" | grep -n "$1" | tail -1 | cut -d: -f1; }
until_true "the end in the journal" says 'Deactivated successfully' "INVOCATION_ID=$invocation"
halted=$(line_of 'the body is halted: .*shutdown') ended=$(line_of 'Deactivated successfully')
[ -n "$halted" ] && [ "$halted" -lt "$ended" ] || fail "the body must be halted before the daemon leaves"
ok "stopped: body halted first, its layer gone with it"

# Bad input: said with its place, and not tried again and again.
box systemctl start subsumed@bad 2>/dev/null && fail "a broken creature file must not start"
[ "$(show subsumed@bad ExecMainStatus)" = 2 ] && [ "$(show subsumed@bad NRestarts)" = 0 ] || fail "bad input must end with status 2, once"
until_true "the errors of a broken file" says 'bad.toml:3:' -u subsumed@bad
ok "a broken file: its errors in the journal, no restarts"

# The page and its hole in the wall, as the manual says.
if command -v curl >/dev/null; then
  may_look() { box curl -fsS --max-time 5 http://127.0.0.1:4686/api/state; }
  may_look >/dev/null 2>&1 && fail "the page must be off"
  echo 'PAGE=--page-port 4686' | box sh -c 'cat >/etc/subsumed/jerry.env'
  box systemctl restart subsumed@jerry || fail "jerry does not start with a page"
  may_look >/dev/null 2>&1 && fail "without its drop-in the page must not be reached"
  box mkdir -p /etc/systemd/system/subsumed@jerry.service.d
  drop_in 2 | box sh -c 'cat >/etc/systemd/system/subsumed@jerry.service.d/page.conf'
  box systemctl daemon-reload
  box systemctl restart subsumed@jerry || fail "jerry does not start with its drop-in for the page"
  grep -q '"jerry"' <<<"$(may_look)" || fail "with its drop-in the page must be reached"
  ok "the page is off, and on where the manual says how; exposure then $(box systemd-analyze security subsumed@jerry | sed -n 's/.*Overall.*service: \([0-9.]*\) .*/\1/p')"
else
  echo "  skipped: the page (no curl)"
fi

# Real time refused: explained, and the creature runs in best effort.
refuse() {
  local option=$1 found=$2
  box mkdir -p /run/systemd/system/subsumed@jerry.service.d
  printf '[Service]\n%s\n' "$option" | box sh -c 'cat >/run/systemd/system/subsumed@jerry.service.d/refuse.conf'
  box systemctl daemon-reload
  box systemctl restart subsumed@jerry || fail "with $option it must start in best effort"
  status_says subsumed@jerry 'best effort' || fail "with $option its status must say best effort"
  local words; for words in 'sched_setscheduler(SCHED_FIFO' CAP_SYS_NICE RT_GROUP_SCHED RestrictRealtime= 'user namespaces' "found here: $found"; do
    says "$words" -u subsumed@jerry "_PID=$(show subsumed@jerry MainPID)" || fail "with $option the journal must name $words"
  done
}
refuse PrivateUsers=yes 'a user namespace'
refuse RestrictRealtime=yes 'a system call filter'
ok "real time refused by PrivateUsers= and RestrictRealtime=: explained in the journal"
# Last, because it takes real time away from everything in the slice, as on a real host.
if box sh -c 'cat /sys/fs/cgroup/cpu*/cpu.rt_runtime_us' >/dev/null 2>&1; then
  refuse CPUWeight=50 'the cpu control group /system.slice'
  ok "real time refused by RT_GROUP_SCHED: explained in the journal"
else
  echo "  skipped: RT_GROUP_SCHED (this kernel has none, or no cpu control group of the old layout)"
fi

box systemctl stop subsumed@jerry
until_true "no socket is left" box sh -c '! ls /run/subsumed/*.sock /run/subsumed/*.body'
left=$(box sh -c 'ls /dev/shm | grep ^iox2_' || true)
[ -z "$left" ] || fail "left in /dev/shm: $left"
ok "nothing left in /run and /dev/shm"
echo "the units in a real systemd: $passed passed, 0 failed"
