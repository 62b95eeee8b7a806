#!/usr/bin/env bash
# Builds the project and runs its tests. On Debian as root (or with sudo) it installs the packages that are missing.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
# shellcheck source=.ci/common.sh
source .ci/common.sh

usage="usage: ./test.sh [--full]
  Runs the tests, then each fuzz target for 10 seconds (where clang is installed or can be).
  --full   hours, told step by step: 10,000 random graphs where the quick run tries 1,500, and mutations over them;
           the tests again with address and undefined-behaviour sanitizers; the threaded ones with the thread
           sanitizer; 100,000 frames of the soak; the device tests on other drivers that are there; covered code
           (gcovr); 60 seconds a fuzz target; every bench"

soak_processes=20 soak_frames=5000 # of each: a driver that forgets mappings runs out of them in one process
full=no
for argument in "$@"; do
  case "$argument" in
    --full) full=yes; export DERMIS_TESTS_FULL=1; optional_packages+=("${windows_packages[@]}" "${coverage_packages[@]}") ;;
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

# Runs a step, a function of its name with '_' for ' ', and keeps how long it took. What a step leaves out it says with
# the exit code 77.
times=()
step() {
  local name=$1 begin=$SECONDS rc=0 told
  say "== $name"
  "${name// /_}" || rc=$?
  told=$(printf '%-20s %4d min %02d s' "$name" $(((SECONDS - begin) / 60)) $(((SECONDS - begin) % 60)))
  [[ $rc -ne 77 ]] || told+=", skipped"
  times+=("$told")
  [[ $rc -eq 0 || $rc -eq 77 ]] || fail 1 "$name: failed"
}

tests_of() { # preset
  build_preset "$1"
  ctest --preset "$1" -j "$(nproc)" --progress ||
    fail 1 "tests failed in '$1'; the log: build/$1/Testing/Temporary/LastTest.log"
}
release() { tests_of release; }
asan() { tests_of asan; }
tsan() {
  build_preset tsan --target test_integration_static_library
  TSAN_OPTIONS=halt_on_error=1 build/tsan/tests/test_integration_static_library --gtest_filter='Threads.*'
}
soak() {
  local seed
  for ((seed = 1; seed <= soak_processes; ++seed)); do
    DERMIS_SOAK_SEED=$seed DERMIS_SOAK_FRAMES=$soak_frames build/release/tests/test_integration_soak ||
      fail 1 "the soak failed with DERMIS_SOAK_SEED=$seed DERMIS_SOAK_FRAMES=$soak_frames"
  done
}
other_drivers() { tests/drivers/run.sh; }
coverage() { tests/coverage/run.sh; }
benches() { build/release/dermis bench all --out build/bench; }
fuzzers() { # and the plans of another compiler
  if [[ $fuzz == no ]]; then
    say "skipped, these packages are not installed and this user cannot install them: ${fuzz_packages[*]}"
    return 77
  fi
  build_preset fuzz
  tests/digests/compare.sh || fail 1 "plans depend on the compiler"
  local seconds=10
  [[ $full == no ]] || seconds=60
  tests/fuzz/run.sh "$seconds" || fail 1 "a fuzz target has a finding; it is kept in build/fuzz/findings"
}

steps=(release fuzzers)
[[ $full == no ]] || steps=(release asan tsan soak "other drivers" coverage fuzzers benches)
for one in "${steps[@]}"; do
  step "$one"
done
printf '%s\n' "${times[@]}"
say "All tests passed: $(printf '%s, ' "${steps[@]}" | sed 's/, $//'), in $((SECONDS / 60)) min"
