#!/usr/bin/env bash
# The interface of this tree against that of integration/abi/baseline.abi: what was there stays as it was; structs grow
# at their end and functions are added only together with a new baseline.
# usage: abi_gate.sh SOURCE_DIR [--update]
# Exit codes: 0 as the baseline, 1 not, 77 abigail-tools or python3 is not installed.
set -euo pipefail
source=$(realpath "$1")
baseline=$source/integration/abi/baseline.abi
for tool in abidw abidiff python3; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed (packages abigail-tools, python3)"; exit 77; }
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The interface as a library: $1 the tree whose header it is, $2 the library.
build() {
  python3 "$source/tests/packaging/interface.py" "$1" > "$scratch/interface.c"
  (cd "$scratch" && cc -std=c99 -g -O0 -fPIC -shared -Wl,-soname,libdermis.so.0 -I"$1/integration/include" -o "$2" interface.c)
}
describe() { # without what changes from machine to machine
  abidw --no-corpus-path --no-comp-dir-path --no-show-locs --headers-dir "$source/integration/include" "$1" > "$2"
}

build "$source" "$scratch/libdermis.so.0"
if [[ ${2:-} == --update ]]; then
  describe "$scratch/libdermis.so.0" "$baseline"
  echo "wrote $baseline"
  exit
fi
if ! abidiff --no-show-locs "$baseline" "$scratch/libdermis.so.0"; then
  echo "the interface is not that of integration/abi/baseline.abi; if it only grew, write it anew: $0 SOURCE_DIR --update"
  exit 1
fi

# The gate itself: a member in the middle and a function that is gone must not pass.
expect_refused() { # what, sed script
  mkdir -p "$scratch/changed/integration/include/dermis"
  sed "$2" "$source/integration/include/dermis/dermis.h" > "$scratch/changed/integration/include/dermis/dermis.h"
  ! cmp -s "$source/integration/include/dermis/dermis.h" "$scratch/changed/integration/include/dermis/dermis.h" ||
    { echo "the gate tries nothing: $1"; exit 1; }
  build "$scratch/changed" "$scratch/changed.so"
  if abidiff --no-show-locs "$baseline" "$scratch/changed.so" >/dev/null; then
    echo "the gate lets through: $1"
    exit 1
  fi
}
expect_refused "a member in the middle of a struct" 's|^  uint32_t queue_family; .*of the command buffers.*|  uint64_t extra; uint32_t queue_family;|'
expect_refused "another number of an enumerator" 's|DERMIS_ERROR_VERSION = -2|DERMIS_ERROR_VERSION = -22|'
expect_refused "a function that is gone" 's|^DERMIS_API uint32_t DERMIS_CALL dermis_version(void);||'
expect_refused "a member at the end without a new baseline" 's|^  void\* view_user; .*|  void* view_user; void* more;|'
