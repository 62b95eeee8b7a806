#!/usr/bin/env bash
# Runs the viewer's laws where there are Node, a Chromium and a viewer in the command; says why not otherwise.
# run.sh NODE NODE_MODULES DERMIS OUT
set -euo pipefail
skip() { printf 'skipped: %s\n' "$1"; exit 77; }
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
cd "$here/../.."
[[ -x "$1" ]] || skip "there is no Node"
[[ -d "$2/playwright-core" ]] || skip "playwright-core was not fetched"
chromium=$(command -v chromium || command -v chromium-browser) || skip "there is no chromium (Debian: chromium)"
exec "$1" "$here/viewer_test.mjs" "$2" "$chromium" "$3" "$4"
