#!/usr/bin/env bash
# Tests that the bundle runs in a root that holds nothing but a shell and the bundle.
# usage: bundle.sh BUILD SOURCE
# Exit code 77: this user cannot change the root.
set -euo pipefail
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unshare -rm chroot / true 2>/dev/null ||
  { echo "skipped: this user cannot change the root"; exit 77; }

"$source/integration/packaging/bundle.sh" "$build" "$work/bundle.tar.gz" >/dev/null
root=$work/root
mkdir -p "$root"/{bin,dev,usr/bin,lib64,proc,tmp}
: >"$root/dev/null"
tar -C "$root" --strip-components=1 -xzf "$work/bundle.tar.gz"
for program in /bin/sh /usr/bin/dirname /usr/bin/readlink; do
  cp -L "$program" "$root$program"
  for library in $(ldd "$program" | grep -oE '/[^ ]+'); do
    mkdir -p "$root$(dirname "$library")"
    cp -L "$library" "$root$library"
  done
done
run() {
  unshare -rm --fork --pid sh -c '
    mount -t proc proc "$1/proc" 2>/dev/null || mount --rbind /proc "$1/proc"
    root=$1
    shift
    exec chroot "$root" "$@"' sh "$root" "$@"
}
run /dermis explain configs/graphs/sap.json >"$work/explain.txt"
grep -q gather "$work/explain.txt" || { echo "explain printed no plan"; exit 1; }
rc=0
run /dermis doctor >"$work/doctor.txt" 2>&1 || rc=$?
if [[ $rc -ne 3 ]]; then
  echo "doctor without a driver: exit code $rc, expected 3"
  cat "$work/doctor.txt"
  exit 1
fi
[[ -s $root/licences/libopenexr-3-1-30.txt || -n $(ls "$root/licences") ]] ||
  { echo "no licences"; exit 1; }
