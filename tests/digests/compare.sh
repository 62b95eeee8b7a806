#!/usr/bin/env bash
# Checks that two builds make byte-identical plans of all shipped graphs and 200 random graphs.
# usage: compare.sh [BUILD_FOLDER BUILD_FOLDER]; default: build/release (gcc) and build/asan (clang)
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

first=${1:-build/release} second=${2:-build/asan}
digests() { "$1/tests/plan_digests" configs/graphs 200; }
a=$(digests "$first")
b=$(digests "$second")
if [[ $a != "$b" ]]; then
  diff <(printf '%s\n' "$a") <(printf '%s\n' "$b") || true
  printf 'plans differ between %s and %s\n' "$first" "$second" >&2
  exit 1
fi
printf '%s plans, equal in %s and %s\n' "$(wc -l <<<"$a")" "$first" "$second"
