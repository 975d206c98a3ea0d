#!/usr/bin/env bash
# Follows the pages of the book that tell a stranger what to type, command by command, as they stand there.
#
#   tests/tutorial.sh [PAGE.md...]      default: every page of docs/src with commands to follow
#
# A block of shell commands is run as it is, all in one shell. Its first line may say more:
#   ```sh,keeps-running    in a terminal of its own; ended when the page is over
#   ```sh,until WORD       again and again until it prints the word
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
pages=("$@")
[ ${#pages[@]} -gt 0 ] || pages=(docs/src/tutorial/own-layer.md docs/src/tutorial/allen.md docs/src/multiplexer.md)
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$root/target}

follow() { # PAGE, in a shell of its own
  page=$1 block=0 started=() work=$(mktemp -d)
  # As the first page has it.
  export PATH="$root/target/release:$PATH"
  export SUBSUMED_RUN=$work/run SUBSUMED_DOMAIN="book$$b$RANDOM" XDG_STATE_HOME=$work/state TMPDIR=$work
  unset STATE_DIRECTORY
  end() {
    for pid in "${started[@]}"; do kill -INT -- "-$pid" 2>/dev/null || true; done
    for pid in "${started[@]}"; do wait "$pid" 2>/dev/null || true; done
    rm -rf "$work" "/tmp/iceoryx2-$SUBSUMED_DOMAIN" /dev/shm/"iox2_${SUBSUMED_DOMAIN}_"*
  }
  trap end EXIT
  # Nobody looks at the page here, and its port may be taken; a daemon that is forgotten ends by itself.
  subsumed() { command subsumed --headless --seconds 900 "$@"; }
  # Only what was started here: by its name, in our domain.
  pkill() {
    local signal=$1 name=$3 hit=1 dir
    for dir in /proc/[0-9]*; do
      [ "$(cat "$dir/comm" 2>/dev/null)" = "$name" ] || continue
      grep -qzx "SUBSUMED_DOMAIN=$SUBSUMED_DOMAIN" "$dir/environ" 2>/dev/null || continue
      kill "$signal" "${dir#/proc/}" && hit=0
    done
    return $hit
  }
  failed() {
    echo "FAILED: $page, block $block: $1"; sed 's/^/  | /' <<<"$body"
    echo "---- what it said"; tail -30 "$work/said" || true
    for log in "$work"/terminal.*; do [ -f "$log" ] && { echo "---- ${log##*/}"; tail -15 "$log"; }; done
    exit 1
  }
  while IFS= read -r -d $'\1' block_text; do
    block=$((block + 1))
    info=$(head -1 <<<"$block_text")
    body=$(tail -n +2 <<<"$block_text")
    case $info in
      keeps-running)
        set -m
        ( set +e; trap - EXIT; eval "$body" ) >"$work/terminal.$block" 2>&1 &
        started+=($!)
        set +m
        # Whoever joins it next finds it there.
        if [[ $body == subsumed* ]]; then
          for _ in $(seq 300); do compgen -G "$SUBSUMED_RUN/*.sock" >/dev/null && break; sleep 0.1; done
        fi ;;
      until\ *)
        limit=$((SECONDS + 240))
        until eval "$body" >"$work/said" 2>&1 && grep -q -- "${info#until }" "$work/said"; do
          [ $SECONDS -lt $limit ] || failed "never says ${info#until }"
          sleep 0.5
        done ;;
      *)
        # What asks a daemon that was started a moment ago may have to ask again.
        limit=$((SECONDS + 60))
        until eval "$body" >"$work/said" 2>&1; do
          [[ $body == subsumectl* ]] && [ $SECONDS -lt $limit ] || failed "status $?"
          sleep 0.5
        done ;;
    esac
  done < <(awk '/^```sh/ { on = 1; sub(/^```sh,?/, ""); printf "%s\n", $0; next } /^```$/ && on { on = 0; printf "\1" } on' "$root/$page")
  [ $block -gt 0 ] || { echo "FAILED: $page has no commands"; exit 1; }
  echo "$page: $block blocks followed in $SECONDS s"
}

for page in "${pages[@]}"; do ( SECONDS=0; follow "$page" ); done
