#!/usr/bin/env bash
# Runs a test of HTML pages if Node and Chromium are installed; otherwise prints the reason for
# skipping.
# usage: run.sh TEST.mjs NODE NODE_MODULES DERMIS OUT; exit code 77: skipped
set -euo pipefail
skip() { printf 'skipped: %s\n' "$1"; exit 77; }
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
cd "$here/../../../.."
[[ -x "$2" ]] || skip "there is no Node"
[[ -d "$3/playwright-core" ]] || skip "playwright-core was not fetched"
chromium=$(command -v chromium || command -v chromium-browser) ||
  skip "there is no chromium (Debian: chromium)"
exec "$2" "$here/$1" "$3" "$chromium" "$4" "$5"
