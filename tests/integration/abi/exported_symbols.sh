#!/bin/sh
# The shared library exports what integration/abi/symbols.txt lists: every function of the header, nothing else.
# usage: exported_symbols.sh LIBRARY SOURCE_DIR
set -eu
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
nm -D --defined-only "$1" | awk '$2 != "A" { print $3 }' | sort > "$scratch/exported"
sort "$2/integration/abi/symbols.txt" > "$scratch/listed"
grep -o 'DERMIS_CALL dermis_[a-z_]*(' "$2/integration/include/dermis/dermis.h" | sed 's/.* //; s/($//' | sort \
  > "$scratch/declared"
diff "$scratch/declared" "$scratch/listed" || { echo "the header (<) and symbols.txt (>) differ"; exit 1; }
diff "$scratch/listed" "$scratch/exported" || { echo "symbols.txt (<) and the library (>) differ"; exit 1; }
