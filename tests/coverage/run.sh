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
tests=(test_framegraph test_passes test_framegraph_vulkan test_integration_abi test_integration_embedding
  test_integration_arguments test_shared_shaders test_integration_shaders test_integration_null_device test_integration_static_library test_schema)
build=build/coverage

run_test() { # name
  local begin=$SECONDS
  "$build/tests/$1" >"$build/$1.log" 2>&1 || { tail -n 30 "$build/$1.log"; echo "coverage: $1 failed"; return 1; }
  echo "coverage: $1, $((SECONDS - begin)) s"
}
export -f run_test
export build

if [[ ${1:-} != --report ]]; then
  cmake --preset coverage --log-level=WARNING >/dev/null
  cmake --build --preset coverage -j "$(nproc)" --target "${tests[@]}"
  find $build -name '*.gcda' -delete
  unset DERMIS_TESTS_FULL # more random graphs run the same lines
  printf '%s\n' "${tests[@]}" | xargs -P 2 -I {} bash -c 'run_test {}'
fi
failed=0
for part in framegraph integration/abi; do
  out=$build/${part//\//_}
  gcovr "$build/$part" --root . --exclude-throw-branches --exclude-unreachable-branches -j "$(nproc)" --filter "$part/" \
    --json-summary "$out.json" --txt "$out.txt" --fail-under-line $least_lines --fail-under-branch $least_branches ||
    failed=1
  python3 - "$part" "$out.json" <<'PYTHON'
import json, sys
part, total = sys.argv[1], json.load(open(sys.argv[2]))
print(f"coverage of {part}/: {total['line_percent']} % of {total['line_total']} lines, "
      f"{total['branch_percent']} % of {total['branch_total']} branches")
PYTHON
done
exit $failed
