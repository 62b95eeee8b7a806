#!/usr/bin/env bash
# Measures test coverage of framegraph/ and of the C interface, and requires at least 90 % of lines
# and 80 % of branches. Unreachable branches and branches of exceptions are excluded.
# docs/verification.md lists uncovered code.
# usage: coverage.sh [--report]; --report only evaluates the previous run
# Exit code 77: gcovr is not installed.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

least_lines=90 least_branches=80
if ! command -v gcovr >/dev/null; then
  echo "coverage: skipped, gcovr is not installed"
  exit 77
fi
# The longest suites run first, two at a time. Suites of kernels and of the command cover no
# additional code.
tests=(test_framegraph test_integration_abi test_integration_embedding test_schema
  test_framegraph_vulkan test_shared_shaders test_integration_shaders test_integration_null_device
  test_integration_arguments test_integration_static_library)
# Long repetitive tests without additional coverage: mutated files, and hundreds of reloads.
left_out='Schema.GraphSchema_AgreesWithParserOnMutatedFiles:ReloadStorm.*'
build=build/coverage

# shellcheck disable=SC2317 # xargs calls it
run_test() { # name
  local begin=$SECONDS
  "$build/tests/$1" --gtest_filter="-$left_out" >"$build/$1.log" 2>&1 || {
    tail -n 30 "$build/$1.log"
    echo "coverage: $1 failed"
    return 1
  }
  echo "coverage: $1, $((SECONDS - begin)) s"
}
export -f run_test
export build left_out

case ${1:-} in
  "" | --report) ;;
  *) echo "usage: coverage.sh [--report]" >&2; exit 2 ;;
esac
if [[ ${1:-} != --report ]]; then
  cmake --preset coverage --log-level=WARNING >/dev/null
  known=$(cmake --build --preset coverage --target help)
  for i in "${!tests[@]}"; do # some suites need glslang or valijson
    grep -q "^${tests[i]}: phony" <<<"$known" || unset "tests[i]"
  done
  cmake --build --preset coverage -j "$(nproc)" --target "${tests[@]}"
  find $build -name '*.gcda' -delete
  unset DERMIS_TESTS_FULL # more random graphs cover the same lines
  printf '%s\n' "${tests[@]}" | xargs -P 2 -I {} bash -c 'run_test {}'
fi
failed=0
for part in framegraph integration/abi; do
  out=$build/${part//\//_}
  gcovr "$build/$part" --root . --exclude-throw-branches --exclude-unreachable-branches \
    -j "$(nproc)" --filter "$part/" --json-summary "$out.json" --txt "$out.txt" \
    --fail-under-line $least_lines --fail-under-branch $least_branches || failed=1
  python3 - "$part" "$out.json" <<'PYTHON'
import json, os, sys
part, total = sys.argv[1], json.load(open(sys.argv[2]))
folders = {}
for file in total["files"]:
    below = os.path.relpath(file["filename"], part).split("/")
    counts = folders.setdefault(below[0] if len(below) > 1 else ".", [0, 0, 0, 0])
    for i, name in enumerate(("line_covered", "line_total", "branch_covered", "branch_total")):
        counts[i] += file[name]
share = lambda covered, of: f"{100 * covered / of:5.1f} % of {of:5}" if of else "none"
for name, (lines, of_lines, branches, of_branches) in sorted(folders.items()):
    print(f"  {part}/{name:<12} {share(lines, of_lines)} lines, "
          f"{share(branches, of_branches)} branches")
print(f"coverage of {part}/: {total['line_percent']} % of {total['line_total']} lines, "
      f"{total['branch_percent']} % of {total['branch_total']} branches")
PYTHON
done
exit $failed
