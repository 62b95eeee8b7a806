#!/usr/bin/env bash
# The device tests on other drivers than the system's: SwiftShader where chromium-common brings it, and those that
# DERMIS_DRIVERS names (manifests, separated by ':'). Prints a table of drivers and suites. Tests that one does not pass
# are listed in known/DRIVER and left out; any other failure fails. Exit code 77: there is no other driver.
# usage: run.sh [BUILD]; BUILD: build/release
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

build=${1:-build/release}
suites=(test_framegraph_vulkan test_passes_kernels test_integration_abi test_integration_embedding)
drivers=()
named=${DERMIS_DRIVERS:-}
for manifest in /usr/lib/chromium/vk_swiftshader_icd.json ${named//:/ }; do
  [[ -e $manifest ]] && drivers+=("$manifest")
done
if [[ ${#drivers[@]} -eq 0 ]]; then
  echo "other drivers: skipped, none is installed (chromium-common has SwiftShader; DERMIS_DRIVERS names manifests)"
  exit 77
fi
failed=0
for manifest in "${drivers[@]}"; do
  name=$(basename "$manifest" .json)
  known=tests/drivers/known/$name
  left_out=-$(grep -v '^#' "$known" 2>/dev/null | grep . | paste -sd: || true)
  for suite in "${suites[@]}"; do
    log=$build/drivers_${name}_$suite.log
    begin=$SECONDS
    rc=0
    VK_DRIVER_FILES=$manifest VK_ICD_FILENAMES=$manifest timeout 1800 "$build/tests/$suite" --gtest_filter="$left_out" \
      >"$log" 2>&1 || rc=$?
    printf '%-24s %-30s %5s passed, %3s failed, %3s skipped, %4s s%s\n' "$name" "$suite" \
      "$(grep -c '^\[       OK \]' "$log" || true)" "$(grep -c '^\[  FAILED  \].* (.* ms)$' "$log" || true)" \
      "$(grep -c '^\[  SKIPPED \].* (.* ms)$' "$log" || true)" "$((SECONDS - begin))" \
      "$([[ $rc -eq 0 ]] || echo "; the log: $log")"
    [[ $rc -eq 0 ]] || failed=1
  done
done
exit $failed
