#!/usr/bin/env bash
# Builds the library and the command, renders a bust with three graphs, and with one more setting, and prints what it
# cost and how exact it is; then one sheet of all techniques. On Debian as root (or with sudo) it installs the packages
# that are missing.
set -euo pipefail
root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
cd "$root"
# shellcheck source=.ci/common.sh
source .ci/common.sh

usage="usage: ./demo.sh [--head FOLDER]
Builds the library and the dermis command into build/release, renders a bust with three graphs into out/ and prints
device times and errors, then a sheet of every technique and material. On Debian, as root or with sudo, it first
installs the packages that are missing; elsewhere it takes them as there. Minutes the first time.
  --head FOLDER   also renders the head scan of that folder: LeePerrySmith.glb, Map-COL.jpg, Map-SPEC.jpg and
                  Infinite-Level_02_Tangent_SmoothUV.jpg"

head=
while [[ $# -gt 0 ]]; do
  case "$1" in
    --head)
      [[ $# -ge 2 ]] || fail 2 "--head needs a folder"$'\n'"$usage"
      head=$2
      shift 2
      ;;
    -h | --help) say "$usage"; exit 0 ;;
    *) fail 2 "unknown option '$1'"$'\n'"$usage" ;;
  esac
done

install_packages
# All that cmake --install puts in place; the tests are left out.
build_preset release --target dermis_command dermis_library integration/packaging/all

render() { # scene, graph, folder, more options
  say
  build/release/dermis render "configs/scenes/$1.json" --graph "configs/graphs/$2.json" --size 640x360 --frames 8 \
    --out "out/$3" "${@:4}"
}

for graph in sap burley separable; do
  render bust "$graph" "bust_$graph"
done
render bust sap bust_sap_through --set transmission=true
say "With light through the ears: out/bust_sap_through"
say
build/release/dermis render configs/scenes/bust.json --graph none --size 640x360 --frames 1 --out out/bust_without --quiet
say "Without scattering, to compare: out/bust_without"
say
build/release/dermis sheet --size 240x135 --out out/sheet.png

say
if [[ -z "$head" ]]; then
  say "Head scan: skipped, no folder given (./demo.sh --head FOLDER)."
elif [[ ! -f "$head/LeePerrySmith.glb" ]]; then
  say "Head scan: skipped, there is no LeePerrySmith.glb in '$head'."
else
  for graph in sap burley separable; do
    render head "$graph" "head_$graph" --model "$head/LeePerrySmith.glb" --height 0.24 --albedo "$head/Map-COL.jpg" \
      --specular "$head/Map-SPEC.jpg" --normal "$head/Infinite-Level_02_Tangent_SmoothUV.jpg"
  done
fi
say "Pictures and EXRs are in $root/out."
