#!/usr/bin/env bash
# Builds the project and runs its tests. On Debian, as root or with sudo, the script first installs
# missing packages.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
# shellcheck source=.ci/common.sh
source .ci/common.sh

usage="usage: ./test.sh [--full]
  Runs the tests. Tests that need ray queries run on a second driver, if the driver can be fetched.
  Then compiles the kernels for absent GPUs and checks their limits, and runs each fuzz target for
  10 seconds, if clang can be installed.
  --full   run more cases per test, check kernels on more GPUs, and run each graph on the drivers
           of absent GPUs. Then run code coverage (gcovr), the thread sanitizer, random graphs on a
           device, the device tests on other drivers, every bench with --quick, the benches of known
           answers and of stability in full, and the suites that manage memory or use a device with
           the address and undefined-behaviour sanitizers, if clang can be installed. Takes more
           than an hour. CONTRIBUTING.md lists the commands for longer runs."

full=no
for argument in "$@"; do
  case "$argument" in
    --full)
      full=yes
      export DERMIS_TESTS_FULL=1
      optional_packages+=("${windows_packages[@]}" "${coverage_packages[@]}")
      ;;
    -h | --help) say "$usage"; exit 0 ;;
    *) fail 2 "unknown option '$argument'"$'\n'"$usage" ;;
  esac
done

# A test opens the viewer's page in chromium.
optional_packages+=("${fuzz_packages[@]}" "${interface_packages[@]}" chromium)
install_packages
fuzz=no
if can_fuzz; then fuzz=yes; fi

# Runs one step: the function named like the step, with '_' for spaces. Exit code 77 means skipped.
times=() # "step <tab> seconds <tab> note"
step() {
  local name=$1 begin=$SECONDS rc=0
  say "== $name"
  "${name// /_}" || rc=$?
  [[ $rc -eq 0 || $rc -eq 77 ]] || fail 1 "$name: failed"
  times+=("$name"$'\t'"$((SECONDS - begin))"$'\t'"$([[ $rc -eq 0 ]] || say ', skipped')")
}

print_times() {
  printf '%s\n' "${times[@]}" | awk -F '\t' '
    { printf "%-16s %4d min %02d s%s\n", $1, $2 / 60, $2 % 60, $3; all += $2 }
    END { printf "%-16s %4d min %02d s\n", "all", all / 60, all % 60 }'
}

run_tests() { # preset, target, more arguments of ctest
  build_preset "$1" --target "$2"
  # One test per processor, each with one thread of the software driver.
  LP_NUM_THREADS=${LP_NUM_THREADS:-1} ctest --preset "$1" -j "$(nproc)" --progress "${@:3}" ||
    fail 1 "tests failed in '$1'; the log: build/$1/Testing/Temporary/LastTest.log"
}
# Suffix of suites that need ray queries, which run in a separate step.
ray_suites=WithRayQueries
release() { run_tests release all -E "$ray_suites\\."; }
# Runs without the additional cases of --full, which find nothing more with sanitizers or other
# drivers.
quick() { (unset DERMIS_TESTS_FULL && "$@"); }
# Left out: suites that only compare pictures and take minutes with sanitizers. Other tests run the
# same code. GTEST_FILTER applies to programs that run as a whole (<suite>_processes). The build
# precedes it, because the build lists the tests of all other programs.
asan() {
  if [[ $fuzz == no ]]; then return 77; fi # no clang; the step of the fuzz targets says so
  build_preset asan --target dermis_labelled_tests
  GTEST_FILTER='-*Demodulation*:*LastStep*:InputFormats.*:*Probe.*:*Hybrid.*:*Pair.*' \
    quick run_tests asan dermis_labelled_tests -L "memory|device" \
    -E "WithRayQueries\.|Golden\.|ListOrder\.|Engine\.(Frames|Kernels)"
}
tsan() {
  build_preset tsan --target test_integration_static_library
  TSAN_OPTIONS=halt_on_error=1 build/tsan/tests/test_integration_static_library \
    --gtest_filter='Threads.*'
}
built() { build_preset release --target "$@" >/dev/null; }
random_graphs() {
  built test_passes_device
  DERMIS_FUZZ_GRAPHS=60 build/release/tests/test_passes_device --gtest_filter='DeviceFuzz.*'
}
# Tests that need ray queries run on a driver that supports them, all others on the system's driver.
# The tests find the driver in the folder of fetch_driver.sh. With the driver present, no test may
# be skipped.
ray_queries() {
  local log=build/ray_queries.log rc=0 program shard part parts
  tests/scripts/fetch_driver.sh >/dev/null || return $? # 77: there is none
  built test_integration_examples_demo_engine test_integration_tools
  for program in integration_examples_demo_engine integration_tools; do
    parts=()
    for ((shard = 0; shard < $(nproc); ++shard)); do
      GTEST_TOTAL_SHARDS=$(nproc) GTEST_SHARD_INDEX=$shard LP_NUM_THREADS=1 quick \
        "build/release/tests/test_$program" --gtest_filter="*$ray_suites.*" >"$log.$shard" 2>&1 &
      parts+=($!)
    done
    for part in "${parts[@]}"; do wait "$part" || rc=1; done
    cat "$log".[0-9]*
    rm "$log".[0-9]*
  done >"$log"
  if [[ $rc -ne 0 ]]; then
    grep -B20 'FAILED' "$log" | tail -60
    fail 1 "tests on ray queries failed; the log: $log"
  fi
  if grep -q '^\[  SKIPPED \] ' "$log"; then
    grep -B3 '^\[  SKIPPED \] ' "$log"
    fail 1 "a driver with ray queries is present, but its tests were skipped; log: $log"
  fi
  local ran
  ran=$(grep -c '^\[       OK \]' "$log" || true)
  say "$ran tests ran on the driver with ray queries"
  [[ $ran -gt 0 ]] ||
    fail 1 "a driver with ray queries is present, but no test ran on it; log: $log"
}
# Kernels of the shipped graphs on compilers of GPUs, which need no GPU.
kernels() {
  local more=()
  [[ $full == no ]] || more=(--full)
  built dermis_command
  tests/gpu/check_kernels.sh "${more[@]}" build/release
}
other_drivers() { quick tests/scripts/run_on_drivers.sh build/release; }
coverage() { tests/scripts/coverage.sh; }
# --quick leaves out cases of the suites that are deterministic, so those run in full.
benches() {
  built dermis_command
  build/release/dermis bench all --quick --again --out build/bench
  build/release/dermis bench all --suites truth,stability --again --out build/bench_complete
}
fuzzers() { # also compares the plans of two compilers
  if [[ $fuzz == no ]]; then
    say "skipped, these packages are not installed and this user cannot install them:" \
      "${fuzz_packages[*]}"
    return 77
  fi
  build_preset asan --target fuzzers
  tests/digests/compare.sh || fail 1 "plans depend on the compiler"
  local seconds=10
  [[ $full == no ]] || seconds=30
  tests/fuzz/run.sh "$seconds" ||
    fail 1 "a fuzz target has a finding; it is kept in build/asan/findings"
}

steps=(release "ray queries" kernels fuzzers)
[[ $full == no ]] || steps+=(coverage tsan "random graphs" "other drivers" benches asan)
for one in "${steps[@]}"; do
  step "$one"
done
print_times
say "All tests passed."
