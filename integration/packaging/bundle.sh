#!/usr/bin/env bash
# Packs the command with its files and all libraries into one archive that runs on x86-64 Linux
# without installing anything. A GPU needs only its own Vulkan driver.
# usage: bundle.sh [BUILD] [ARCHIVE]
#   BUILD: default build/release; ARCHIVE: default BUILD/dermis-VERSION-linux-x86_64.tar.gz
set -euo pipefail
source=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
build=$(realpath -m "${1:-$source/build/release}")
archive=${2:+$(realpath -m "$2")}
cd "$source"
[[ -x $build/dermis ]] || { echo "bundle.sh: $build/dermis is not built" >&2; exit 2; }
version=$("$build/dermis" --version | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -n 1)
name=dermis-$version-linux-x86_64
archive=${archive:-$build/$name.tar.gz}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/$name
mkdir -p "$root"/{bin,lib,libc,share/dermis}

strip -o "$root/bin/dermis" "$build/dermis"
cp -r configs/. tests/benchmark "$root/share/dermis/"
ln -s share/dermis "$root/configs" # examples of the documents work in the bundle's folder
[[ ! -d $build/docs/schema ]] || cp -r "$build/docs/schema" "$root/share/dermis/"
cp tests/gpu/measure.sh "$root/"
cp LICENSE docs/third_party.md "$root/"

# The C library is kept apart: it is used only where the system's is too old.
libraries() { ldd "$1" | sed -nE 's/.*=> (\/[^ ]+).*/\1/p'; }
# Copies the licence of the package that a library belongs to.
copy_licence() { # library
  local path package
  for path in "$1" "/usr$1" "$(readlink -f "$1")"; do
    package=$(dpkg -S "$path" 2>/dev/null | sed -n '1s/:.*//p') || true
    [[ -n $package ]] || continue
    cp -Lu "/usr/share/doc/$package/copyright" "$root/licences/$package.txt"
    return
  done
}
mkdir "$root/licences"
loader=$(/sbin/ldconfig -p | sed -nE 's/.*libvulkan\.so\.1 .*x86-64.*=> (.*)/\1/p' | head -n 1)
for library in $(libraries "$build/dermis") $loader $(for l in $loader; do libraries "$l"; done); do
  copy_licence "$library"
  case $(basename "$library") in
    libc.so.* | libm.so.* | libdl.so.* | libpthread.so.* | librt.so.*)
      cp -Lu "$library" "$root/libc/"
      ;;
    *) cp -Lu "$library" "$root/lib/" ;;
  esac
done
cp -L /lib64/ld-linux-x86-64.so.2 "$root/libc/"

cat >"$root/dermis" <<'LAUNCHER'
#!/bin/sh
# Runs the command with the libraries of this folder, and with the system's C library if that is new
# enough.
here=$(dirname "$(readlink -f "$0")")
inherited=${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
if LD_LIBRARY_PATH="$here/lib$inherited" "$here/bin/dermis" --version >/dev/null 2>&1; then
  LD_LIBRARY_PATH="$here/lib$inherited" exec "$here/bin/dermis" "$@"
fi
exec "$here/libc/ld-linux-x86-64.so.2" --library-path "$here/lib:$here/libc$inherited" \
  "$here/bin/dermis" "$@"
LAUNCHER
chmod +x "$root/dermis"

tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner -czf "$archive" "$name"
echo "$archive"
