#!/usr/bin/env bash
# Compiles the public header and the C examples for Windows with mingw-w64, as C and as C++. Nothing
# is linked or run; mingw.sh builds and links the library.
# usage: mingw_headers.sh SOURCE_DIR SHADER_HEADERS_DIR
# Exit codes: 0 success, 1 compiler errors, 77 the cross compiler is not installed.
set -euo pipefail
source=$(realpath "$1")
shaders=$(realpath "$2")
compiler=x86_64-w64-mingw32-g++-posix
if ! command -v $compiler >/dev/null; then
  echo "skipped: $compiler is not installed (package g++-mingw-w64-x86-64-posix)"
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for folder in vulkan vk_video; do # no other system header
  ln -s "/usr/include/$folder" "$work/$folder"
done
echo '#include <dermis/dermis.h>' > "$work/header.c"
failed=0
for file in "$work/header.c" "$source"/integration/examples/{minimal,host_pass,write_capture}.c; do
  for language in c c++; do
    $compiler -x $language -Wall -Wextra -Werror -fsyntax-only \
      -I"$work" -I"$source/integration/include" -I"$source/integration/examples" -I"$shaders" \
      "$file" || { echo "$(basename "$file") as $language"; failed=1; }
  done
done
exit $failed
