#!/usr/bin/env bash
# Builds the library and the minimal host for Windows with mingw-w64. Checks that the DLL exports
# only the interface and depends only on system libraries. Nothing is run.
# usage: mingw.sh SOURCE_DIR BUILD_DIR
# BUILD_DIR is a build for this machine, which provides write_bindings.
# Exit codes: 0 success, 1 failure, 77 the cross compiler is not installed.
set -euo pipefail
source=$(realpath "$1")
build=$(realpath "$2")
triple=x86_64-w64-mingw32
if ! command -v $triple-g++-posix >/dev/null; then
  echo "skipped: $triple-g++-posix is not installed (package g++-mingw-w64-x86-64-posix)"
  exit 77
fi
work=$build/mingw
mkdir -p "$work/include" "$work/cmake/fmt" "$work/cmake/nlohmann_json"

# Links headers of other projects without this system's own headers, which do not fit Windows.
for folder in vulkan vk_video fmt nlohmann; do
  ln -sfn "/usr/include/$folder" "$work/include/$folder"
done
for name in fmt nlohmann_json; do
  cat > "$work/cmake/$name/${name}Config.cmake" <<CONFIG
add_library($name::$name INTERFACE IMPORTED)
set_target_properties($name::$name PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "$work/include")
CONFIG
  echo 'set(PACKAGE_VERSION 99) 
set(PACKAGE_VERSION_COMPATIBLE TRUE)' > "$work/cmake/$name/${name}ConfigVersion.cmake"
done
cat > "$work/toolchain.cmake" <<TOOLCHAIN
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER $triple-gcc-posix)
set(CMAKE_CXX_COMPILER $triple-g++-posix)
set(CMAKE_RC_COMPILER $triple-windres)
TOOLCHAIN
cmake -G Ninja -S "$source" -B "$work/build" \
  -DCMAKE_TOOLCHAIN_FILE="$work/toolchain.cmake" \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O1 \
  -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=10 \
  -DDERMIS_BUILD_TOOLS=OFF -DDERMIS_BUILD_TESTS=OFF -DDERMIS_INSTALL=OFF \
  -DDERMIS_WARNINGS_AS_ERRORS=ON \
  -Dfmt_DIR="$work/cmake/fmt" -Dnlohmann_json_DIR="$work/cmake/nlohmann_json" \
  -DVulkan_INCLUDE_DIR="$work/include" -DVulkan_LIBRARY="$work/libvulkan-1.dll.a" \
  -DDERMIS_WRITE_BINDINGS="$build/generated/write_bindings" >/dev/null

# An import library of the Vulkan loader with the functions that the host calls.
examples=$source/integration/examples
{
  echo "LIBRARY vulkan-1.dll"
  echo "EXPORTS"
  grep -oh '\bvk[A-Z][A-Za-z0-9]*' "$examples/headless.h" "$examples/minimal.c" | sort -u
} > "$work/vulkan.def"
$triple-dlltool -d "$work/vulkan.def" -l "$work/libvulkan-1.dll.a"

cmake --build "$work/build" -j "${JOBS:-$(nproc)}" --target dermis_library >/dev/null ||
  { cmake --build "$work/build" --target dermis_library; exit 1; }
dll=$(find "$work/build" -name 'libdermis*.dll' -print -quit)
$triple-objdump -p "$dll" > "$work/headers.txt"
awk '/^\[Ordinal\/Name Pointer\] Table/ { on = 1; next } on && NF == 0 { exit } on { print $NF }' \
  "$work/headers.txt" | LC_ALL=C sort > "$work/exported.txt"
grep -ho 'DERMIS_CALL dermis_[a-z_]*(' "$source"/integration/include/dermis/*.h |
  sed 's/.* //; s/($//' | LC_ALL=C sort > "$work/declared.txt"
diff "$work/declared.txt" "$work/exported.txt" ||
  { echo "the header (<) and the DLL (>) differ"; exit 1; }
others=$(sed -n 's/.*DLL Name: //p' "$work/headers.txt" |
  grep -viE '^(kernel32|msvcrt|ucrtbase|api-ms-win-.*)\.dll$' || true)
[[ -z $others ]] ||
  { echo "the DLL needs more than the system's libraries:"; echo "$others"; exit 1; }
import=$(find "$work/build" -name 'libdermis*.dll.a' -print -quit)
for language in c c++; do
  $triple-g++-posix -x $language -Wall -Wextra -Werror \
    -I"$work/include" -I"$source/integration/include" -I"$examples" \
    "$examples/minimal.c" -x none -static -o "$work/minimal_$language.exe" \
    "$import" "$work/libvulkan-1.dll.a"
done
echo "libdermis.dll exports $(wc -l < "$work/exported.txt") functions; the host links as C and C++"
