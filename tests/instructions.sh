#!/usr/bin/env bash
# What the pieces of a step cost, in instructions, against what is kept in tests/instructions.txt: fails when one
# has grown by more than 3 %. Counts repeat exactly, on a busy machine too.
#
#   tests/instructions.sh [BINARY]            compare (default binary: target/release/instructions)
#   tests/instructions.sh --keep [BINARY]     keep the counts of now: do so on purpose, and say why in the commit
# Needs valgrind (callgrind). The cost of a turn is the count of 3000 turns less that of 1000, divided by 2000.
set -euo pipefail
cd "$(dirname "$0")/.."
keep=no
[ "${1:-}" = --keep ] && { keep=yes; shift; }
binary=$(realpath "${1:-${CARGO_TARGET_DIR:-target}/release/instructions}")
kept=tests/instructions.txt
command -v valgrind >/dev/null || { echo "FAILED: valgrind is not installed (Debian: apt-get install valgrind)"; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

count() { # CASE TURNS
  valgrind --tool=callgrind --callgrind-out-file="$work/out.$1.$2" "$binary" "$1" "$2" >/dev/null 2>"$work/log" \
    || { cat "$work/log"; exit 1; }
  sed -n 's/^\(summary\|totals\): \([0-9]*\).*/\2/p' "$work/out.$1.$2" | head -1
}

failed=0
now="$work/now"
{
  echo "# Instructions a turn, by tests/instructions.sh; kept on purpose. rustc of rust-toolchain or CI, x86_64."
  echo "# rustc: $(rustc -V | cut -d' ' -f2)"
} >"$now"
printf '%-24s %10s %10s %8s\n' case now kept change
while IFS=$'\t' read -r name about; do
  cost=$(( ($(count "$name" 3000) - $(count "$name" 1000)) / 2000 ))
  echo "$name $cost" >>"$now"
  before=$(awk -v n="$name" '$1 == n { print $2 }' "$kept" 2>/dev/null || true)
  if [ -z "$before" ]; then
    change="new"
    [ $keep = yes ] || failed=$((failed + 1))
  else
    change=$(awk -v a="$cost" -v b="$before" 'BEGIN { printf "%+.1f%%", 100 * (a - b) / b }')
    # A single instruction of a tiny case is no 3 %: rounding.
    if [ $((cost * 100)) -gt $((before * 103)) ] && [ $((cost - before)) -gt 1 ]; then
      change="$change GREW"
      failed=$((failed + 1))
    fi
  fi
  printf '%-24s %10s %10s %8s   %s\n' "$name" "$cost" "${before:--}" "$change" "$about"
done < <("$binary")
if [ $keep = yes ]; then
  cp "$now" "$kept"
  echo "kept in $kept"
  exit 0
fi
if [ $failed -gt 0 ]; then
  kept_by=$(sed -n 's/^# rustc: //p' "$kept" 2>/dev/null || true)
  echo "FAILED: $failed cases cost more than 3 % more than what is kept (counted with rustc $kept_by, here $(rustc -V | cut -d' ' -f2))."
  echo "If that is meant: tests/instructions.sh --keep, and say why in the commit."
  exit 1
fi
echo "instruction counts: all held"
