#!/usr/bin/env bash
# Installs the build, moves the installed folder, and builds small hosts in four ways: plain
# compiler, pkg-config, find_package (shared and static) and add_subdirectory. Each host runs a
# graph.
# usage: consumers.sh BUILD_DIR SOURCE_DIR [--subdirectory]
# --subdirectory runs only add_subdirectory, which rebuilds the library.
set -euo pipefail
build=$1
source=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
run() { # a host
  echo "== $(basename "$1")"
  "$@" "$source/configs/graphs/burley.json" "$source/configs/profiles/skin.json"
}

if [[ ${3:-} == --subdirectory ]]; then
  # not in the scratch folder, so that ccache finds the same paths again
  host=$build/host_in_subdirectory
  launcher=$(command -v ccache || true)
  cmake -G Ninja -S "$source/tests/integration/packaging/subdirectory" -B "$host" \
    -DDERMIS="$source" -DCMAKE_BUILD_TYPE=Debug \
    -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=10 \
    ${launcher:+-DCMAKE_CXX_COMPILER_LAUNCHER="$launcher"} >/dev/null
  cmake --build "$host" -j "$(nproc)" >/dev/null
  run "$host/host_dermis"
  run "$host/host_dermis_static"
  exit
fi

cmake --install "$build" --prefix "$scratch/first" >/dev/null
mv "$scratch/first" "$scratch/moved" # the installation must not depend on its original path
prefix=$scratch/moved
lib=$(dirname "$(find "$prefix" -name libdermis.so)")
export LD_LIBRARY_PATH=$lib

flags=(-std=c99 -Wall -Wextra -Werror
  -I"$source/integration/examples" "$source/integration/examples/minimal.c")
cc "${flags[@]}" -I"$prefix/include" -o "$scratch/host_cc" -L"$lib" -ldermis -lvulkan
run "$scratch/host_cc"

if command -v pkg-config >/dev/null; then
  export PKG_CONFIG_PATH=$lib/pkgconfig
  # shellcheck disable=SC2046
  cc "${flags[@]}" -o "$scratch/host_pkg_config" $(pkg-config --cflags --libs dermis) -lvulkan
  run "$scratch/host_pkg_config"
else
  echo "== pkg-config: skipped, not installed"
fi

for languages in C "C;CXX"; do # a C project must also find the C++ run time
  cmake -G Ninja -S "$source/tests/integration/packaging/find_package" \
    -B "$scratch/build_${languages/;/_}" -DCMAKE_PREFIX_PATH="$prefix" -DLANGUAGES="$languages" \
    -DEXAMPLES="$source/integration/examples" -DCMAKE_BUILD_TYPE=Release >/dev/null
  cmake --build "$scratch/build_${languages/;/_}" >/dev/null
  run "$scratch/build_${languages/;/_}/host_dermis"
  run "$scratch/build_${languages/;/_}/host_dermis_static"
done

# README.md builds only three targets. They must make everything that is installed.
query=$(ninja -C "$build" -t query integration/packaging/dermis_shell_files)
[[ $query == *dermis_reference_pages* ]] ||
  { echo "the targets of README.md do not make the reference pages"; exit 1; }

# Runs the commands of README.md, unchanged except for the folders.
if command -v pkg-config >/dev/null; then
  sed -n '/^```console$/,/^```$/s/^\$ //p' "$source/README.md" |
    grep -v '^cmake --\(build\|preset\)' |
    sed -e "s#\$PWD/out#out#g" -e "s#out/#$scratch/readme/#g" -e "s#build/release#$build#g" \
      >"$scratch/lines"
  [[ $(wc -l <"$scratch/lines") -eq 4 ]] ||
    { echo "README.md has other lines than this test knows"; exit 1; }
  echo "== README.md"
  (cd "$source" && unset LD_LIBRARY_PATH && set -x && . "$scratch/lines") |
    grep -E '^scatter +[0-9.]+ ms$'
fi

# Every document and example is installed, and links between installed documents resolve.
documents=$(dirname "$(find "$prefix/share/doc" -name LICENSE)")
for file in "$source"/docs/*.md "$source"/integration/examples/*.{[ch],comp}; do
  [[ -f $documents/${file#"$source/"} ]] || { echo "${file#"$source/"} is not installed"; exit 1; }
done
(cd "$documents/docs" &&
  grep -oh '](\(\.\./integration/examples/\|[a-z_]*\.md\)[^)#]*' ./*.md | sed 's/^](//' | sort -u |
  while read -r link; do
    [[ -e $link ]] ||
      { echo "an installed document links to $link, which is not there"; exit 1; }
  done)

# The installation is self-contained: the command finds its library, and graphs validate.
unset LD_LIBRARY_PATH
"$prefix/bin/dermis" validate "$prefix/share/dermis/graphs/sap.json"
# Plain names of scenes, profiles and graphs resolve to installed files, from any folder.
(cd "$scratch" &&
  "$prefix/bin/dermis" report-bug "$prefix/share/dermis/graphs/sap.json" --size 32x18 --count 1 \
    --out bug &&
  "$prefix/bin/dermis" sheet --graphs sap --profiles skin --size 32x18 --out sheet.png &&
  "$prefix/bin/dermis" bench stability --techniques burley --cases light_nan --quick --quiet)

# The static library exports only the interface.
others=$(nm -g --defined-only "$lib/libdermis.a" | awk 'NF == 3 { print $3 }' |
  grep -v '^dermis_' || true)
[[ -z $others ]] ||
  { echo "libdermis.a exports more than dermis_*:"; echo "$others" | head; exit 1; }
[[ $(readelf -d "$lib/libdermis.so") == *SONAME*libdermis.so.0]* ]] ||
  { echo "the SONAME is not libdermis.so.0"; exit 1; }
