#!/usr/bin/env bash
# Runs fuzz targets, one per processor, on the committed corpus, the shipped files and a dictionary
# of their words. The exit code is 1 after a finding, which is kept in build/asan/findings.
# usage: run.sh [SECONDS [TARGET...]]; default: 10 seconds, all targets
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

seconds=${1:-10}
[[ $seconds =~ ^[1-9][0-9]*$ ]] || { echo "usage: run.sh [SECONDS [TARGET...]]" >&2; exit 2; }
shift || true
targets=("$@")
all=(graph overlay profile scene capture exr plan)
[[ ${#targets[@]} -gt 0 ]] || targets=("${all[@]}")
for target in "${targets[@]}"; do
  [[ " ${all[*]} " == *" $target "* ]] || {
    echo "run.sh: there is no fuzz target '$target'; expected one of: ${all[*]}" >&2
    exit 2
  }
  [[ -x build/asan/fuzz/fuzz_$target ]] || {
    echo "run.sh: build/asan/fuzz/fuzz_$target is not built;" \
      "run: cmake --preset asan && cmake --build --preset asan --target fuzzers" >&2
    exit 2
  }
done

findings=build/asan/findings dictionary=build/asan/keys.dict
mkdir -p "$findings"
# Every short quoted word of a schema or shipped file: the keys and values of all formats.
grep -ohE '"[$A-Za-z0-9_./@-]{1,32}"' configs/{schema,graphs,overlays,profiles,scenes}/*.json |
  sort -u | sed 's/^"\(.*\)"$/"\\"\1\\""/' >"$dictionary"
run_one() { # target, seconds, folder of findings
  local target=$1 seconds=$2 findings=$3 grown=build/asan/corpus/$1 log=build/asan/$1.log
  local runs covered
  mkdir -p "$grown" # keeps the inputs of earlier runs
  local folders=("$grown" "tests/fuzz/corpus/$target")
  case $target in
    graph | overlay | profile | scene) folders+=("configs/${target}s") ;;
  esac
  if build/asan/fuzz/fuzz_"$target" -max_total_time="$seconds" -timeout=5 -rss_limit_mb=2048 \
    -max_len=65536 -dict="$dictionary" -artifact_prefix="$findings/$target-" \
    -print_final_stats=1 -verbosity=1 "${folders[@]}" >"$log" 2>&1; then
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    covered=$(grep -o 'cov: [0-9]*' "$log" | tail -n 1)
    printf 'fuzz %-10s %9s inputs, %s, no finding\n' "$target" "$runs" "$covered"
  else
    printf 'fuzz %-10s FINDING, kept in %s; the log: %s\n' "$target" "$findings" "$log"
    tail -n 30 "$log"
    return 1
  fi
}
export -f run_one
export dictionary
printf '%s\n' "${targets[@]}" |
  xargs -P "$(nproc)" -I{} bash -c 'run_one "$@"' run {} "$seconds" "$findings" || exit 1
