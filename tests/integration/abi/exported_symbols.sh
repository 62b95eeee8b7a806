#!/bin/sh
# Checks that the shared library exports exactly the functions of the header. The library may only
# depend on the C and C++ run time: no Vulkan loader, no JSON or shader library.
# usage: exported_symbols.sh LIBRARY SOURCE_DIR
set -eu
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
nm -D --defined-only "$1" | awk '$2 != "A" { print $3 }' | sort > "$scratch/exported"
grep -ho 'DERMIS_CALL dermis_[a-z_]*(' "$2"/integration/include/dermis/*.h |
  sed 's/.* //; s/($//' | sort > "$scratch/declared"
diff "$scratch/declared" "$scratch/exported" ||
  { echo "the header (<) and the library (>) differ"; exit 1; }
others=$(readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' |
  grep -v -E '^(libc|libm|libstdc\+\+|libgcc_s|lib[a-z]*san|ld-linux.*)\.so' || true)
[ -z "$others" ] || { echo "it needs more than the C and C++ run time: $others"; exit 1; }
