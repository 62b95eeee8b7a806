#!/usr/bin/env bash
# Builds the project and runs its tests. On Debian as root (or with sudo) it installs the packages that are missing.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
# shellcheck source=.ci/common.sh
source .ci/common.sh

usage="usage: ./test.sh [--full]
  --full   also builds with address and undefined-behaviour sanitizers and runs the tests there; tries 10,000
           random graphs where the quick run tries 1,500"

presets=(release)
for argument in "$@"; do
  case "$argument" in
    --full) presets+=(asan); export DERMIS_TESTS_FULL=1 ;;
    -h | --help) say "$usage"; exit 0 ;;
    *) fail 2 "unknown option '$argument'"$'\n'"$usage" ;;
  esac
done

install_packages
for preset in "${presets[@]}"; do
  build_preset "$preset"
  say "Testing $preset ..."
  ctest --preset "$preset" -j "$(nproc)" --progress || fail 1 "tests failed in '$preset'; the log: build/$preset/Testing/Temporary/LastTest.log"
done
say "All tests passed: ${presets[*]}"
