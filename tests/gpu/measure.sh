#!/usr/bin/env bash
# Measures the techniques on this machine's GPU, for docs/performance.md. Each step takes less than
# ten minutes on a GPU. Runs in the folder of an unpacked bundle (integration/packaging/bundle.sh),
# and among the sources.
# usage: measure.sh 1|2|3 OUT
#   1  dermis doctor, pictures compared with those of another driver, times of passes
#   2  statistics of kernels, error over time of every technique
#   3  frames that keep a budget, a file per scene of SCENES
# DERMIS: the command. PICTURES: a folder that step 1 wrote on another driver. SCENE: bust by
# default. SIZES, TECHNIQUES: of the times. SCENES: of step 3, all by default.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"
[[ -d bin ]] || cd ../..
dermis=${DERMIS:-./dermis}
[[ -x $dermis ]] || dermis=build/release/dermis
step=${1:-} out=${2:-}
if [[ ! $step =~ ^[123]$ || -z $out ]]; then
  sed -n '2,/^# default/s/^# //p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
mkdir -p "$out"
defaults="sap separable burley papers/fixed papers/afis papers/afis_published"
read -ra techniques <<<"${TECHNIQUES:-$defaults}"
failed=0

render() { # technique, size, frames, folder, more options
  "$dermis" render "configs/scenes/${SCENE:-bust}.json" --graph "configs/graphs/$1.json" \
    --size "$2" --frames "$3" --deterministic --json --out "$4" "${@:5}"
}

case $step in
  1)
    "$dermis" doctor | tee "$out/doctor.txt"
    for technique in "${techniques[@]}"; do
      name=$(basename "$technique")
      render "$technique" 640x360 4 "$out/pictures/$name" --pictures last \
        >"$out/picture_$name.json" || failed=1
      if [[ -n ${PICTURES:-} ]]; then
        "$dermis" compare {"$out/pictures","$PICTURES"}/"$name"/scattered_0003.exr \
          --min-psnr 60 || failed=1
      fi
      for size in ${SIZES:-1920x1080 2560x1440}; do
        render "$technique" "$size" 200 "$out/frames" --subset 0 --pictures last \
          --unbound scattered_light,albedo >"$out/times_${name}_$size.json" || failed=1
      done
    done
    rm -rf "$out/frames"
    ;;
  2)
    "$dermis" kernels --json >"$out/kernels.json" || failed=1
    "$dermis" bench error-time --json "$out/error_time.json" --cache "$out/references" || failed=1
    ;;
  3)
    for scene in ${SCENES:-regular flashing dolly dynamic cut}; do
      "$dermis" bench budget --scenes "$scene" --json "$out/budget_$scene.json" \
        --cache "$out/references" || failed=1
    done
    ;;
esac
exit $failed
