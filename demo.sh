#!/usr/bin/env bash
# Builds the library and the command, renders a bust with three graphs and one additional setting,
# and prints device times and errors. Then renders a sheet of all techniques. On Debian, as root or
# with sudo, the script first installs missing packages.
set -euo pipefail
root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
# shellcheck source=.ci/common.sh
source "$root/.ci/common.sh"

usage="usage: ./demo.sh [--head FOLDER]
Builds the library and the dermis command into build/release and renders a bust with three graphs
into out/. Prints device times and errors, then renders a sheet of six techniques and materials.
On Debian, as root or with sudo, the script first installs missing packages; elsewhere they must be
installed. The first run takes several minutes.
  --head FOLDER   also render the head scan in FOLDER, which must contain LeePerrySmith.glb,
                  Map-COL.jpg, Map-SPEC.jpg and Infinite-Level_02_Tangent_SmoothUV.jpg"

head=
while [[ $# -gt 0 ]]; do
  case "$1" in
    --head)
      [[ $# -ge 2 ]] || fail 2 "--head needs a folder"$'\n'"$usage"
      head=$(realpath -m "$2")
      for file in LeePerrySmith.glb Map-COL.jpg Map-SPEC.jpg \
        Infinite-Level_02_Tangent_SmoothUV.jpg; do
        [[ -f $head/$file ]] || fail 2 "'$head' has no $file"$'\n'"$usage"
      done
      shift 2
      ;;
    -h | --help) say "$usage"; exit 0 ;;
    *) fail 2 "unknown option '$1'"$'\n'"$usage" ;;
  esac
done
cd "$root"

install_packages
# Builds everything that cmake --install needs, without tests.
build_preset release --target dermis_command dermis_library integration/packaging/all

render() { # scene, graph, folder, more options
  say
  build/release/dermis render "configs/scenes/$1.json" --graph "configs/graphs/$2.json" \
    --size 640x360 --frames 8 --out "out/$3" "${@:4}"
}

for graph in sap burley separable; do
  render bust "$graph" "bust_$graph"
done
render bust sap bust_sap_through --set transmission=true
say "With transmitted light (ears): out/bust_sap_through"
say
build/release/dermis render configs/scenes/bust.json --graph none --size 640x360 --frames 1 \
  --out out/bust_without --quiet
say "Without scattering, to compare: out/bust_without"
say
build/release/dermis sheet --size 240x135 --out out/sheet.png

say
if [[ -z "$head" ]]; then
  say "Head scan: skipped, no folder given (./demo.sh --head FOLDER)."
else
  for graph in sap burley separable; do
    render head "$graph" "head_$graph" --model "$head/LeePerrySmith.glb" --height 0.426 \
      --albedo "$head/Map-COL.jpg" --specular "$head/Map-SPEC.jpg" \
      --normal "$head/Infinite-Level_02_Tangent_SmoothUV.jpg"
  done
fi
say "Images are in $root/out."
