#!/usr/bin/env bash
# Builds the project and runs its tests. On Debian as root (or with sudo) it installs the packages that are missing.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
# shellcheck source=.ci/common.sh
source .ci/common.sh
# shellcheck source=.ci/kept_steps.sh
source .ci/kept_steps.sh

usage="usage: ./test.sh [--full]
  Runs the tests, those that need ray queries on a second driver (where it can be fetched), then each fuzz
  target for 10 seconds (where clang is installed or can be).
  --full   hours, told step by step: 10,000 random graphs where the quick run tries 1,500, and mutations over them;
           the tests again with address and undefined-behaviour sanitizers; the threaded ones with the thread
           sanitizer; 100,000 frames of the soak; 400 random graphs of the real kinds on a device; the device tests on
           other drivers that are there; covered code (gcovr); 60 seconds a fuzz target; every bench. A run that was
           stopped goes on with the step that it was in, as long as the sources stay as they are"

# What --full does in parts, each of them a step of its own:
test_parts=6
soak_parts=10 soaks_a_part=2 soak_frames=5000 # of each soak: a driver that forgets mappings runs out of them in one process
graph_parts=10 chunks_a_part=2 chunk_graphs=20
driver_suites=(framegraph_vulkan shaders passes_device integration_abi integration_embedding integration_examples_demo_engine
  laws:{1..8}/8)
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

# Runs a step: a function of its name's words with '_' between, given the number behind them, if there is one. What a
# step leaves out it says with the exit code 77.
times=() # "step <tab> seconds <tab> what is to be told of it"
step() {
  local name=$1 begin=$SECONDS rc=0 words=${1% [0-9]*} number='' seconds=''
  [[ $words == "$name" ]] || number=${name##* }
  [[ $full == no ]] || seconds=$(kept_step "$name")
  if [[ -n $seconds ]]; then
    say "== $name: passed before, in $seconds s"
    times+=("$name"$'\t'"$seconds"$'\tpassed before')
    return
  fi
  say "== $name"
  "${words// /_}" "$number" || rc=$?
  [[ $rc -eq 0 || $rc -eq 77 ]] || fail 1 "$name: failed"
  seconds=$((SECONDS - begin))
  times+=("$name"$'\t'"$seconds"$'\t'"$([[ $rc -eq 0 ]] || say skipped)")
  if [[ $full == yes && $rc -eq 0 ]]; then keep_step "$name" "$seconds"; fi
}

# A line for each step, those that differ by their number as one; then all.
tell_times() {
  printf '%s\n' "${times[@]}" | awk -F '\t' '
    function told(seconds) { return sprintf("%4d min %02d s", seconds / 60, seconds % 60) }
    { sub(/ [0-9]+$/, "", $1)
      if (!($1 in seconds)) order[++steps] = $1
      seconds[$1] += $2; all += $2; parts[$1]++; if ($3 != "") { note[$1] = $3; noted[$1]++ } }
    END { for (i = 1; i <= steps; ++i) { one = order[i]
            printf "%-20s %s%s%s\n", one, told(seconds[one]), noted[one] ? ", " note[one] : "",
              noted[one] && noted[one] < parts[one] ? " in parts" : "" }
          printf "%-20s %s\n", "all", told(all) }'
}

tests_of() { # preset [part] [options of ctest]
  local chosen=("${@:3}")
  [[ -z ${2:-} ]] || chosen+=(-I "$2,,$test_parts")
  build_preset "$1"
  # As many tests run at a time as there are processors: one thread each of Mesa's software driver, not one a processor.
  LP_NUM_THREADS=${LP_NUM_THREADS:-1} ctest --preset "$1" -j "$(nproc)" --progress "${chosen[@]}" ||
    fail 1 "tests failed in '$1'; the log: build/$1/Testing/Temporary/LastTest.log"
}
# Suites of tests that need ray queries end in this; they have a step of their own.
ray_suites=WithRayQueries
release() { tests_of release "$1" -E "$ray_suites\\."; } # part, or all
# Sanitizers and other drivers see no more in the tenth thousand of graphs, at many times the time.
quick() { (unset DERMIS_TESTS_FULL && "$@"); }
asan() { quick tests_of asan "$1"; } # part
tsan() {
  build_preset tsan --target test_integration_static_library
  TSAN_OPTIONS=halt_on_error=1 build/tsan/tests/test_integration_static_library --gtest_filter='Threads.*'
}
built() { build_preset release --target "$@" >/dev/null; } # after an earlier run something else may have been
# Several runs of a test program at the same time, told apart by a variable.
side_by_side() { # variable, first value, step, runs, program and its arguments
  local variable=$1 first=$2 by=$3 runs=$4 i log failed=''
  shift 4
  local processes=()
  for ((i = 0; i < runs; ++i)); do
    env "$variable=$((first + i * by))" "$@" >"build/$variable.$i.log" 2>&1 &
    processes+=($!)
  done
  for ((i = 0; i < runs; ++i)); do
    log=build/$variable.$i.log
    wait "${processes[i]}" || failed+=" $variable=$((first + i * by))"
    cat "$log"
  done
  [[ -z $failed ]] || fail 1 "it failed with$failed"
}
soak() { # part, from 1
  built test_integration_soak
  DERMIS_SOAK_FRAMES=$soak_frames side_by_side DERMIS_SOAK_SEED $((($1 - 1) * soaks_a_part + 1)) 1 $soaks_a_part \
    build/release/tests/test_integration_soak
}
random_graphs() { # part, from 1
  built test_passes_device
  DERMIS_FUZZ_GRAPHS=$chunk_graphs side_by_side DERMIS_FUZZ_SEED $((($1 - 1) * chunks_a_part * chunk_graphs)) $chunk_graphs \
    $chunks_a_part build/release/tests/test_passes_device --gtest_filter='DeviceFuzz.*'
}
# The tests that need ray queries run on a driver that has them, all others on the system's. The tests find
# the driver where fetch.sh leaves it. With the driver there, none of them may be skipped.
ray_queries() {
  local log=build/ray_queries.log rc=0 program
  tests/scripts/fetch_driver.sh >/dev/null || return 77
  built test_integration_examples_demo_engine test_integration_tools
  for program in integration_examples_demo_engine command; do
    LP_NUM_THREADS=$(nproc) quick "build/release/tests/test_$program" --gtest_filter="*$ray_suites.*" || rc=1
  done >"$log" 2>&1
  [[ $rc -eq 0 ]] || { grep -B20 'FAILED' "$log" | tail -60; fail 1 "tests on ray queries failed; the log: $log"; }
  if grep -q '^\[  SKIPPED \] ' "$log"; then
    grep -B3 '^\[  SKIPPED \] ' "$log"
    fail 1 "a driver with ray queries is there, but tests on it were skipped; the log: $log"
  fi
  local ran
  ran=$(grep -c '^\[       OK \]' "$log" || true)
  say "$ran tests ran on the driver with ray queries"
  [[ $ran -gt 0 ]] || fail 1 "a driver with ray queries is there, but no test ran on it; the log: $log"
}
other_drivers() { # suite, from 1
  build_preset release >/dev/null
  quick tests/scripts/run_on_drivers.sh build/release "${driver_suites[$1 - 1]}"
}
coverage() { tests/scripts/coverage.sh; }
benches() {
  built dermis
  build/release/dermis bench all --out build/bench
}
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

steps=(release "ray queries" fuzzers)
if [[ $full == yes ]]; then
  open_kept_steps
  parts_of() { seq -f "$1 %g" "$2"; } # name, parts
  mapfile -t steps < <(parts_of release "$test_parts"; echo 'ray queries'; echo fuzzers; echo coverage; echo tsan; parts_of soak "$soak_parts"
    parts_of 'random graphs' "$graph_parts"; parts_of 'other drivers' "${#driver_suites[@]}"; echo benches
    parts_of asan "$test_parts")
fi
for one in "${steps[@]}"; do
  step "$one"
done
tell_times
say "All tests passed."
