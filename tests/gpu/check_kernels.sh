#!/usr/bin/env bash
# Compiles every kernel of the shipped graphs for GPUs that are not here, and checks the compiler's
# values against kernel_limits.json. Checks dispatches, barriers and bytes of each graph against
# frame_limits.json. Writes all values to BUILD/kernels/FAMILY.json.
# usage: check_kernels.sh [--full] [BUILD]; default: build/release
#   --full  also newer GPUs with Mesa of backports (fetch_driver.sh), and whole runs of every
#           shipped graph on a kernel driver that executes nothing (mesa-drm-shim)
# Exit code 77: no driver for AMD GPUs is installed; nothing was checked on a GPU's compiler.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

full=no
[[ ${1:-} != --full ]] || { full=yes; shift; }
build=${1:-build/release}
dermis=$build/dermis
[[ -x $dermis ]] || { echo "check_kernels.sh: $dermis is not built" >&2; exit 2; }
out=$build/kernels
mkdir -p "$out"
limits=tests/gpu/kernel_limits.json
measured_with="Mesa 22.3" # the limits hold for this version of the system's driver
failed=0 compiled=0

# Slots that an engine may leave out. The bytes per pixel of the documents are counted without them.
"$dermis" kernels --quiet --unbound scattered_light,albedo,scatter_scale \
  --limits tests/gpu/frame_limits.json || failed=1

# Runs a command with a driver's manifest. The compiler must run, so its cache is empty.
with_driver() { # manifest, command...
  VK_DRIVER_FILES=$1 VK_ICD_FILENAMES=$1 MESA_SHADER_CACHE_DISABLE=true "${@:2}"
}

# Shaders in which one ray query takes the place of restir_initial. Other kernels are built in.
one_ray_query=$out/one_ray_query
mkdir -p "$one_ray_query/restir"
cp shaders/restir/instances.glsl shaders/restir/lights.glsl "$one_ray_query/restir"
cp tests/gpu/one_ray_query.comp "$one_ray_query/restir/restir_initial.comp"

compile_for() { # family, manifest
  local json=$out/$1.json log=$out/$1.log rc=0
  local one=$out/$1.one_ray_query.json own=$out/$1.limits.json # with the lines of $limits
  with_driver "$2" env RADV_FORCE_FAMILY="$1" "$dermis" kernels restir --shaders "$one_ray_query" \
    --json >"$one" 2>"$log" || { cat "$log" "$one"; return 1; }
  python3 -B tests/gpu/device_limits.py $limits "$one" >"$own"
  with_driver "$2" env RADV_FORCE_FAMILY="$1" "$dermis" kernels --json --limits "$own" \
    >"$json" 2>"$log" || rc=1
  python3 -B tests/gpu/summarise_kernels.py "$1" "$json" || rc=1
  [[ $rc -eq 0 ]] || cat "$log"
  return $rc
}

# Compiles for two families at once, because the compiler uses one processor.
compile_for_both() { # manifest, family, family
  local begin=$SECONDS first
  compile_for "$2" "$1" >"$out/$2.txt" 2>&1 &
  first=$!
  compile_for "$3" "$1" >"$out/$3.txt" 2>&1 || failed=1
  wait $first || failed=1
  cat "$out/$2.txt" "$out/$3.txt"
  echo "$2 and $3 took $((SECONDS - begin)) s"
  compiled=$((compiled + 2))
}

shopt -s nullglob
system=(/usr/share/vulkan/icd.d/radeon_icd*.json)
if [[ ${#system[@]} -eq 0 ]]; then
  echo "kernels on navi21 and vega10: skipped, no radeon_icd in /usr/share/vulkan/icd.d" \
    "(Debian: mesa-vulkan-drivers)"
elif ! version=$(with_driver "${system[0]}" env RADV_FORCE_FAMILY=navi21 \
  "$dermis" kernels burley 2>/dev/null | sed -n '1s/.*, //p') ||
  [[ $version != *"$measured_with"* ]]; then
  echo "kernels on navi21 and vega10: skipped, the limits are for $measured_with," \
    "but the driver is '$version'"
else
  compile_for_both "${system[0]}" navi21 vega10
  with_driver "${system[0]}" env RADV_FORCE_FAMILY=navi21 "$dermis" kernels sap --small-groups \
    --limits tests/gpu/small_group_limits.json >"$out/small_groups.log" 2>&1 ||
    { sed -n '/dermis: error/,$p' "$out/small_groups.log"; failed=1; }
  # The last step of the pyramid, which also combines: executed vector instructions per pixel, from
  # texels with one layer.
  last_step=$out/last_step
  if with_driver "${system[0]}" env RADV_FORCE_FAMILY=navi21 "$dermis" kernels \
    configs/graphs/sap.json --set variant=smooth --set texturing=post --set last_step=fused \
    --unbound scattered_light,scatter_scale --assembly "$last_step" >"$last_step.log" 2>&1; then
    python3 tests/gpu/instruction_mix.py --longest --one-layer --limit 600 \
      "$last_step/sap_subsurface_sap_gather.txt" >>"$last_step.log" || failed=1
    echo "last step on navi21: $(sed -n 's/^vector *//p' "$last_step.log") vector instructions" \
      "per pixel, limit 600"
  else
    cat "$last_step.log"
    failed=1
  fi
fi

# Runs a graph on the driver of a family as if its GPU were there. Nothing executes, so pictures are
# empty, but the driver creates the device, images and pipelines and records all commands.
run_graph() { # family, graph file
  local log rc=0 complaints
  log=$out/run_$1_$(basename "$2" .json).log
  with_driver "$radeon" env AMDGPU_GPU_ID="$1" LD_PRELOAD="$shim" timeout 300 "$dermis" render \
    configs/scenes/bust.json --graph "$2" --frames 2 --size 320x180 --subset 0 --quiet \
    --out "$out/pictures" >"$log" 2>&1 || rc=$?
  # The first line comes from the shim, the others from Mesa and concern every program.
  complaints=$(grep -v -e '^DRM_IOCTL_GET_CAP: unhandled' \
    -e 'not a conformant Vulkan implementation' \
    -e "output is based on invalid pci bus info" "$log" || true)
  [[ $rc -ne 0 || -n $complaints ]] || return 0
  echo "$(basename "$2" .json) on $1: exit code $rc, the driver's messages: ${complaints:-none}"
  return 1
}

if [[ $full == yes ]]; then
  radeon=$(tests/scripts/fetch_driver.sh --radeon) || radeon=""
  shim=""
  [[ -z $radeon ]] || shim=$(tests/scripts/fetch_driver.sh --shim) || shim=""
  if [[ -n $radeon ]]; then
    compile_for_both "$radeon" navi31 gfx1201
  else
    echo "kernels on navi31 and gfx1201: skipped, there is no driver"
  fi
  if [[ -n $shim ]]; then
    for family in navi21 navi31 vega10 vangogh; do
      begin=$SECONDS runs=0 bad=0
      for graph in configs/graphs/*.json configs/graphs/papers/*.json; do
        [[ $graph != *.expect.json ]] || continue
        runs=$((runs + 1))
        run_graph $family "$graph" || bad=$((bad + 1))
      done
      echo "graphs on $family: $runs ran, $bad failed, $((SECONDS - begin)) s"
      [[ $bad -eq 0 ]] || failed=1
      compiled=$((compiled + 1))
    done
  else
    echo "graphs on navi21, navi31, vega10 and vangogh: skipped," \
      "there is no shim of the kernel's driver"
  fi
fi
[[ $failed -eq 0 ]] || exit 1
[[ $compiled -gt 0 ]] || exit 77
