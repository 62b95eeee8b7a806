#!/usr/bin/env bash
# What the tests run of framegraph/ and of the C interface: at least 90 % of lines and 80 % of branches, those left out
# that throwing makes and that cannot be reached. docs/verification.md says what is not covered.
# usage: run.sh [--report]; --report: only count what ran before. Exit code 77: gcovr is not installed
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

least_lines=90 least_branches=80
if ! command -v gcovr >/dev/null; then
  echo "coverage: skipped, gcovr is not installed"
  exit 77
fi
tests=(test_framegraph test_framegraph_vulkan test_passes test_integration_abi test_integration_embedding
  test_integration_null_device test_integration_static_library)
if [[ ${1:-} != --report ]]; then
  cmake --preset coverage --log-level=WARNING >/dev/null
  cmake --build --preset coverage -j "$(nproc)" --target "${tests[@]}"
  find build/coverage -name '*.gcda' -delete
  for test in "${tests[@]}"; do
    echo "coverage: $test"
    build/coverage/tests/"$test" >build/coverage/"$test".log 2>&1 || { tail -n 30 build/coverage/"$test".log; exit 1; }
  done
fi
shared=(--root . --exclude-throw-branches --exclude-unreachable-branches
  --gcov-ignore-parse-errors -j "$(nproc)")
failed=0
for part in framegraph integration/abi; do
  out=build/coverage/${part//\//_}
  gcovr "build/coverage/$part" "${shared[@]}" --filter "$part/" --json-summary "$out.json" --txt "$out.txt" \
    --fail-under-line $least_lines --fail-under-branch $least_branches || failed=1
  python3 - "$part" "$out.json" <<'PYTHON'
import json, sys
part, total = sys.argv[1], json.load(open(sys.argv[2]))
print(f"coverage of {part}/: {total['line_percent']} % of {total['line_total']} lines, "
      f"{total['branch_percent']} % of {total['branch_total']} branches")
PYTHON
done
exit $failed
