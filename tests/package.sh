#!/usr/bin/env bash
# The Debian package in a real systemd, booted for this (see tests/sdbox): installed, started as deploy/README.md says,
# upgraded while running, removed, purged, nothing left.
#
#   tests/package.sh [FOLDER-OF-BINARIES]      default: target/release
# Needs root, systemd, dpkg and cargo-deb; says what it skipped without.
set -euo pipefail
cd "$(dirname "$0")/.."
skip() { echo "skipped: the Debian package ($*)"; exit 0; }
[ "$(id -u)" = 0 ] || skip "needs root, to boot a systemd and to install"
[ -x /lib/systemd/systemd ] || skip "no systemd; \`apt-get install systemd\` grants it"
for tool in unshare nsenter pivot_root dpkg dpkg-deb dpkg-shlibdeps; do command -v $tool >/dev/null || skip "no $tool"; done
cargo deb --version >/dev/null 2>&1 || skip "no cargo-deb; \`cargo install --locked cargo-deb\` grants it"
bin=$(realpath "${1:-target/release}")
stage=$(mktemp -d)
export SDBOX=$stage/box
here=$PWD
clean() { "$here/tests/sdbox" down >/dev/null 2>&1 || true; rm -rf --one-file-system "$stage"; }
trap clean EXIT

passed=0
ok() { passed=$((passed + 1)); echo "  $*"; }
box() { tests/sdbox run "$@"; }
show() { box systemctl show --value -p "$2" "$1"; }
fail() {
  echo "FAILED: $*"
  [ -e "$SDBOX/pid" ] && box systemctl --no-pager --full status 'subsumed*' 2>/dev/null | tail -40 || true
  [ -e "$SDBOX/pid" ] && box journalctl -q --no-pager -o cat -n 40 || true
  exit 1
}
# Waits for what must come; the time is a way out, no criterion.
until_true() { local what=$1 _; shift; for _ in $(seq 300); do "$@" >/dev/null 2>&1 && return; sleep 0.1; done; fail "never came: $what"; }
ctl() { box subsumectl --creature tom "$@"; }
attached() { grep -q "wander .*attached" <<<"$(ctl status)"; }
messages() { ctl --json wires | tr '{' '\n' | sed -n 's/.*"messages":\([0-9]*\).*"wire":"body.odometry".*/\1/p'; }
goes_on() { local before; before=$(messages); sleep 0.3; [ "$(messages)" -gt "$before" ]; }
# What differs from the host, but for logs, caches and dpkg's own book; what lies in memory; and who has an account.
files() {
  (
    cd "$SDBOX/upper"
    find . \( -path ./var/log -o -path ./var/cache -o -path ./var/lib/dpkg -o -path ./var/lib/systemd -o -path ./var/tmp \
      -o -path './etc/*-' -o -path './etc/.pwd.lock' \) -prune -o -print | sort | while read -r file; do
      if [ -d "$file" ]; then [ -d "/$file" ] || echo "$file/"
      elif [ ! -f "$file" ] || ! cmp -s "$file" "/$file"; then echo "$file"; fi
    done
  )
  box sh -c 'ls /run /dev/shm; getent passwd; getent group'
}

CARGO_TARGET_DIR=$(dirname "$bin") NO_BUILD=1 deploy/package "$stage" >"$stage/package.log" 2>&1 || { cat "$stage/package.log"; fail "it does not build"; }
deb=$(ls "$stage"/*.deb)
# The same again, one version later.
dpkg-deb -R "$deb" "$stage/next"
sed -i 's/^Version: .*/&+next/' "$stage/next/DEBIAN/control"
echo next >"$stage/next/usr/share/doc/subsumed/next"
dpkg-deb --root-owner-group -Zgzip -z1 -b "$stage/next" "$stage/next.deb" >/dev/null
for program in subsumed subsumed-body subsumectl $(basename -s .rs layers/*/src/bin/*.rs); do
  for file in "usr/bin/$program" "usr/share/man/man1/$program.1.gz"; do
    [ -s "$stage/next/$file" ] || fail "$file is missing"
  done
done
for file in layers/allen/allen*.toml layers/mechanisms/nest.toml layers/truckin/truck.toml; do
  "$bin/subsumectl" check "$stage/next/usr/share/subsumed/creatures/$(basename "$file")" >/dev/null || fail "$file is not sound as packed"
done
"$bin/subsumectl" test "$stage/next/usr/share/subsumed/creatures/scenarios" >/dev/null || fail "the scenarios fail as packed"
for program in subsumectl subsumed subsumed-body; do
  bash -c ". '$stage/next/usr/share/bash-completion/completions/$program' && complete -p $program" >/dev/null || fail "no completion for $program"
done
ok "built: $(du -h "$deb" | cut -f1), $(dpkg-deb -c "$deb" | grep -vc '/$') files; every program with its page, creatures sound, completions load"
if command -v lintian >/dev/null; then
  # It closes no bug of Debian's, where it is not.
  lintian --allow-root --suppress-tags initial-upload-closes-no-bugs --fail-on error,warning "$deb" >"$stage/lintian" || { cat "$stage/lintian"; fail "lintian"; }
  ok "lintian finds no error and no warning"
else
  echo "  skipped: lintian (\`apt-get install lintian\` grants it)"
fi

if ! tests/sdbox up 2>"$stage/up.log"; then
  cat "$stage/up.log"
  skip "this host does not let one boot: $(tail -1 "$stage/up.log")"
fi
# The box is a copy of this host: what it has of us is no part of the trial. Images of containers forbid packages to
# start and stop anything.
box sh -c 'dpkg --purge subsumed >/dev/null 2>&1 || true; rm -rf /etc/subsumed; rm -f /usr/sbin/policy-rc.d;
  mkdir -p /etc/systemd/system/multi-user.target.wants'
files >"$stage/before"
cp "$deb" "$SDBOX/root/var/tmp/subsumed.deb"
cp "$stage/next.deb" "$SDBOX/root/var/tmp/next.deb"

box dpkg --force-unsafe-io -i /var/tmp/subsumed.deb >"$stage/dpkg.log" 2>&1 || { cat "$stage/dpkg.log"; fail "it does not install"; }
box id subsumed >/dev/null || fail "the user is missing"
box test -d /etc/subsumed/layers -a -d /run/subsumed/iceoryx2 || fail "folders are missing"
[ -z "$(box systemctl --no-legend list-units 'subsumed*@*')" ] || fail "a first installation must start nothing"
ok "installed: user and folders there, nothing started"

# As deploy/README.md says.
box cp /usr/share/subsumed/creatures/allen.toml /etc/subsumed/tom.toml
box systemctl enable -q --now subsumed@tom || fail "subsumed@tom does not start"
box ln -s /usr/bin/allen-wander /etc/subsumed/layers/tom-wander
box mkdir /etc/systemd/system/subsumed-layer@tom-wander.service.d
awk '/^```ini$/ {on = ++count == 1; next} /^```$/ {on = 0} on' deploy/README.md \
  | box sh -c 'cat >/etc/systemd/system/subsumed-layer@tom-wander.service.d/creature.conf'
box systemctl daemon-reload
box systemctl -q add-wants subsumed@tom.service subsumed-layer@tom-wander.service || fail "the layer cannot be wanted"
box systemctl start subsumed-layer@tom-wander || fail "the layer does not start"
until_true "the layer attaches" attached
until_true "tom moves" goes_on
ok "started as the manual says; $(show subsumed@tom StatusText)"

pid=$(show subsumed@tom MainPID) layer=$(show subsumed-layer@tom-wander MainPID)
box dpkg --force-unsafe-io -i /var/tmp/next.deb >"$stage/dpkg.log" 2>&1 || { cat "$stage/dpkg.log"; fail "it does not upgrade"; }
box test -e /usr/share/doc/subsumed/next || fail "the upgrade has no new files"
[ "$(show subsumed@tom ActiveState)" = active ] || fail "tom must run after the upgrade"
new=$(show subsumed@tom MainPID)
[ "$new" != "$pid" ] || fail "an upgrade must start what runs with the new program"
[ "$(box readlink "/proc/$new/exe")" = /usr/bin/subsumed ] || fail "tom runs another program: $(box readlink "/proc/$new/exe")"
until_true "the layer attaches again" attached
[ "$(show subsumed-layer@tom-wander MainPID)" != "$layer" ] || fail "the layer must be started with the new program"
until_true "tom moves again" goes_on
grep -q 'the body is halted: .*shutdown' <<<"$(box journalctl -q --no-pager -o cat -u subsumed@tom SUBSUMED_KIND=halt)" || fail "the body must be halted for the upgrade"
ok "upgraded while running: body halted, new programs, layer back"

box dpkg -r subsumed >"$stage/dpkg.log" 2>&1 || { cat "$stage/dpkg.log"; fail "it cannot be removed"; }
[ -z "$(box sh -c 'ps -C subsumed,subsumed-body,allen-wander -o pid=')" ] || fail "a removal must stop what runs"
box test -e /usr/bin/subsumed && fail "a removal leaves programs"
box test -e /etc/subsumed/tom.toml || fail "a removal must keep creature files"
box dpkg --purge subsumed >"$stage/dpkg.log" 2>&1 || { cat "$stage/dpkg.log"; fail "it cannot be purged"; }
files >"$stage/after"
diff "$stage/before" "$stage/after" >"$stage/left" || { cat "$stage/left"; fail "a purge leaves something"; }
grep -q subsumed <<<"$(box systemctl --no-pager --failed)" && fail "a purge leaves failed units"
ok "removed: stopped, creature files kept; purged: no file, folder, socket, shared memory or account left"

# And in one go, while it runs.
box dpkg --force-unsafe-io -i /var/tmp/subsumed.deb >"$stage/dpkg.log" 2>&1 || { cat "$stage/dpkg.log"; fail "it does not install again"; }
box cp /usr/share/subsumed/creatures/allen.toml /etc/subsumed/tom.toml
box systemctl enable -q --now subsumed@tom || fail "subsumed@tom does not start after a purge"
box dpkg --purge subsumed >"$stage/dpkg.log" 2>&1 || { cat "$stage/dpkg.log"; fail "it cannot be purged while it runs"; }
files >"$stage/after"
diff "$stage/before" "$stage/after" >"$stage/left" || { cat "$stage/left"; fail "a purge while it runs leaves something"; }
ok "installed again and purged while it ran: nothing left"
echo "the Debian package: $passed passed, 0 failed"
