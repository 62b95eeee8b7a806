#!/usr/bin/env bash
# Builds the project and runs its tests. On Debian as root (or with sudo) it installs the packages that are missing.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
# shellcheck source=.ci/common.sh
source .ci/common.sh

usage="usage: ./test.sh [--full]
  Runs the tests, then each fuzz target for 10 seconds (where clang is installed or can be).
  --full   also builds with address and undefined-behaviour sanitizers and runs the tests there; tries 10,000
           random graphs where the quick run tries 1,500; 60 seconds a fuzz target"

presets=(release)
fuzz_seconds=10
for argument in "$@"; do
  case "$argument" in
    --full) presets+=(asan); fuzz_seconds=60; export DERMIS_TESTS_FULL=1; optional_packages+=("${windows_packages[@]}") ;;
    -h | --help) say "$usage"; exit 0 ;;
    *) fail 2 "unknown option '$argument'"$'\n'"$usage" ;;
  esac
done

fuzz=no
if can_fuzz; then
  fuzz=yes
  packages+=("${fuzz_packages[@]}")
fi
optional_packages+=("${interface_packages[@]}" chromium) # chromium opens the viewer's page in a test
install_packages
for preset in "${presets[@]}"; do
  build_preset "$preset"
  say "Testing $preset ..."
  ctest --preset "$preset" -j "$(nproc)" --progress || fail 1 "tests failed in '$preset'; the log: build/$preset/Testing/Temporary/LastTest.log"
done
if [[ $fuzz == yes ]]; then
  build_preset fuzz
  tests/digests/compare.sh || fail 1 "plans depend on the compiler"
  tests/fuzz/run.sh "$fuzz_seconds" || fail 1 "a fuzz target has a finding; it is kept in build/fuzz/findings"
  presets+=(fuzz)
else
  say "Fuzz targets: skipped, these packages are not installed and this user cannot install them: ${fuzz_packages[*]}"
fi
say "All tests passed: ${presets[*]}"
