#!/usr/bin/env bash
# Runs the device tests on drivers other than the system's: Mesa from Debian's backports
# (fetch_driver.sh), SwiftShader from chromium-common, and the manifests in DERMIS_DRIVERS
# (separated by ':'). Prints a table of drivers and suites. Golden frames and light of random graphs
# are compared with the system's driver. Tests of decisions by time are left out, because they do
# not depend on the driver. Tests that a driver is known to fail are listed in known/DRIVER with the
# reason and left out. Any other failure is an error.
# usage: run_on_drivers.sh [BUILD [SUITE...]]
# BUILD: default build/release
# SUITE: "integration_abi" for test_integration_abi, "properties:2/8" for the second eighth of the
# tests of test_properties. Default: the suites that use a device, except properties.
# Exit code 77: there is no other driver.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

fail() { # message
  printf 'run_on_drivers.sh: %s\n' "$1" >&2
  exit 2
}

build=${1:-build/release}
shift || true
suites=("$@")
[[ $# -gt 0 ]] || suites=(integration_abi:{1,2}/2 passes_device shaders integration_embedding
  integration_examples_demo_engine framegraph_vulkan)
for suite in "${suites[@]}"; do
  program=$build/tests/test_${suite%%:*}
  [[ -x $program ]] || fail "there is no suite '$suite': $program is not built"
  [[ $suite =~ ^[a-z_]+(:[1-9][0-9]*/[1-9][0-9]*)?$ ]] ||
    fail "'$suite' is not a suite or a part of one, such as 'properties:2/8'"
done
of_decisions='Choice.*:Frontier.*:Probe.*'
seconds=1800       # per suite or part of a suite
memory=$((8 << 20)) # KiB per suite; protects the machine from drivers that use too much memory
swiftshader=/usr/lib/chromium/vk_swiftshader_icd.json

drivers=()
# The path is absolute because tests change the working directory.
fetched=$(tests/scripts/fetch_driver.sh) && drivers+=("$(readlink -f "$fetched")")
[[ -e $swiftshader ]] && drivers+=("$swiftshader") ||
  echo "SwiftShader: skipped, chromium-common is not installed" >&2
IFS=: read -ra named <<<"${DERMIS_DRIVERS:-}"
for manifest in "${named[@]}"; do
  [[ -e $manifest ]] && drivers+=("$(readlink -f "$manifest")") ||
    echo "$manifest: skipped, there is no such file" >&2
done
if [[ ${#drivers[@]} -eq 0 ]]; then
  echo "other drivers: skipped, there is none"
  exit 77
fi

pictures=$build/drivers_pictures
mkdir -p "$pictures"
DERMIS_PICTURES=$pictures DERMIS_PICTURES_KEEP=1 "$build/tests/test_passes_device" \
  --gtest_filter='*OfAnotherDriver*' >"$pictures/log" 2>&1 ||
  { echo "pictures of the system's driver failed; the log: $pictures/log"; exit 1; }

name_of() { # manifest
  local name
  name=$(basename "$1" .json)
  name=${name#vk_}
  echo "${name%_icd}"
}

# Runs a suite on a driver and prints a row of the table.
run_suite() { # manifest, suite
  local manifest=$1 suite=$2 begin=$SECONDS rc=0 of_suite=0 # of_suite: number of tests left out
  local name program left_out log
  name=$(name_of "$manifest")
  program=$build/tests/test_${suite%%:*}
  left_out=$(grep -v '^#' "tests/scripts/known/$name" 2>/dev/null | grep . | awk '{ print $1 }' |
    paste -sd: || true)
  log=$build/drivers_${name}_$(tr ':/' '__' <<<"$suite").log
  (
    ulimit -v $memory
    if [[ $suite == *:* ]]; then
      part=${suite#*:}
      export GTEST_TOTAL_SHARDS=${part#*/} GTEST_SHARD_INDEX=$((${part%/*} - 1))
    fi
    VK_DRIVER_FILES=$manifest VK_ICD_FILENAMES=$manifest DERMIS_PICTURES=$pictures \
      timeout $seconds "$program" --gtest_filter="-$of_decisions:$left_out"
  ) >"$log" 2>&1 || rc=$?
  if [[ -n $left_out ]]; then
    of_suite=$("$program" --gtest_list_tests --gtest_filter="$left_out" | grep -c '^  ' || true)
  fi
  printf '%-14s %-32s %4s passed, %2s failed, %2s skipped, %3s known, %4s s%s\n' \
    "$name" "$suite" "$(grep -c '^\[       OK \]' "$log" || true)" \
    "$(grep -c '^\[  FAILED  \].* (.* ms)$' "$log" || true)" \
    "$(grep -c '^\[  SKIPPED \].* (.* ms)$' "$log" || true)" "$of_suite" "$((SECONDS - begin))" \
    "$([[ $rc -eq 0 ]] || echo "; ended with $rc; the log: $log")"
  return $((rc == 0 ? 0 : 1))
}

# As many suites at once as there are processors, each with one thread of the driver.
export LP_NUM_THREADS=${LP_NUM_THREADS:-1}
failed=0 running=0
wait_for_one() {
  wait -n || failed=1
  running=$((running - 1))
}
for suite in "${suites[@]}"; do
  for manifest in "${drivers[@]}"; do
    [[ $running -lt $(nproc) ]] || wait_for_one
    run_suite "$manifest" "$suite" &
    running=$((running + 1))
  done
done
while [[ $running -gt 0 ]]; do wait_for_one; done
for manifest in "${drivers[@]}"; do
  grep -h '^pictures' "$build/drivers_$(name_of "$manifest")_passes_device.log" 2>/dev/null |
    cut -f 3- || true
done
exit $failed
