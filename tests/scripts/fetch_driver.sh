#!/usr/bin/env bash
# Fetches Mesa from Debian's backports, whose drivers are newer than the system's, into a folder,
# and prints the path of one part. The system stays unchanged: apt uses separate lists and a
# separate cache, and packages are unpacked, not installed. A package that was fetched before is
# reused.
# usage: fetch_driver.sh [--radeon | --shim] [FOLDER]; default: build/drivers
# prints: the manifest of the software driver lavapipe
#   --radeon  the manifest of the driver for AMD GPUs, which also compiles for absent GPUs
#   --shim    a library to preload, with which that driver runs as if a GPU were there
# Exit code 77: the part is not available; the reason is printed.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

part=lavapipe
case ${1:-} in
  --radeon | --shim) part=${1#--}; shift ;;
  -*) echo "usage: fetch_driver.sh [--radeon | --shim] [FOLDER]" >&2; exit 2 ;;
esac
folder=${1:-build/drivers}
keyring=/usr/share/keyrings/debian-archive-keyring.gpg # from the package debian-archive-keyring
unavailable() {
  echo "Mesa of backports: skipped, $1" >&2
  exit 77
}

shopt -s nullglob
apt_options=()
log=""
complaint() { grep -m 1 -E '^(W|E): ' "$log" || tail -n 1 "$log"; }
# Makes separate lists of packages that include backports.
prepare_apt() {
  [[ ${#apt_options[@]} -eq 0 ]] || return 0
  local release mirror options=""
  for tool in apt-get dpkg-deb; do
    command -v $tool >/dev/null || unavailable "there is no $tool: this is no Debian"
  done
  release=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
  [[ -n $release ]] || unavailable "/etc/os-release has no VERSION_CODENAME"
  # The system's mirror of this release, independent of the format of apt's sources.
  mirror=$(apt-get indextargets --format '$(RELEASE) $(REPO_URI)' 'Created-By: Packages' |
    awk -v release="$release" '$1 == release { print $2; exit }')
  [[ -n $mirror ]] || unavailable "the sources of apt name no mirror of '$release'"
  mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial"
  [[ ! -e $keyring ]] || options="[signed-by=$keyring] "
  echo "deb $options$mirror $release-backports main" >"$folder/apt/sources.list"
  apt_options=(-o Dir::Etc::sourcelist="$folder/apt/sources.list" -o Dir::Etc::sourceparts=-
    -o Dir::State::Lists="$folder/apt/lists" -o Dir::Cache="$folder/apt/cache"
    -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any -o Acquire::Retries=2)
  log=$folder/apt/log
  apt-get "${apt_options[@]}" update >"$log" 2>&1 ||
    unavailable "the lists of $release-backports cannot be had: $(complaint)"
  backports=$release-backports
}
# Unpacks a package into PREFIX-VERSION and sets `unpacked` to that folder.
unpack() { # package, prefix
  local kept=("$folder/$2"-[0-9]*/)
  if [[ ${#kept[@]} -gt 0 ]]; then
    unpacked=${kept[0]%/}
    return
  fi
  prepare_apt
  local archive version here=$PWD
  cd "$folder/apt"
  rm -f "$1"_*.deb
  apt-get "${apt_options[@]}" download "$1/$backports" >>"$log" 2>&1 ||
    unavailable "$backports has no $1 to give: $(complaint)"
  archive=$(echo "$1"_*.deb)
  version=$(dpkg-deb -f "$archive" Version)
  unpacked=$folder/$2-${version#*:} # without the epoch
  rm -rf "$folder/unpacking" # of a run that was stopped
  dpkg-deb -x "$archive" "$folder/unpacking"
  mv "$folder/unpacking" "$unpacked"
  rm "$archive"
  cd "$here"
}
# Writes the manifest of a driver of the unpacked Mesa, unless it exists, and prints its path.
manifest_of() { # library, pattern of Mesa's manifest, name
  unpack mesa-vulkan-drivers mesa
  local version=${unpacked##*/mesa-} driver lacking api manifest
  manifest=$folder/$3${version%%.*}.json
  if [[ ! -e $manifest ]]; then
    driver=$(find "$unpacked" -name "$1")
    [[ -n $driver ]] || unavailable "Mesa $version has no $1"
    lacking=$(ldd "$driver" | awk '/not found/ { print $1 }' | paste -sd' ')
    [[ -z $lacking ]] ||
      unavailable "$1 of Mesa $version needs libraries that are not installed: $lacking"
    # shellcheck disable=SC2086 # $2 is a pattern
    api=$(sed -n 's/.*"api_version": *"\([0-9.]*\)".*/\1/p' \
      "$(dirname "$driver")"/../../share/vulkan/icd.d/$2)
    cat >"$manifest" <<MANIFEST
{ "file_format_version": "1.0.0", "ICD": { "library_path": "$driver", "api_version": "$api" } }
MANIFEST
  fi
  printf '%s\n' "$manifest"
}

mkdir -p "$folder"
folder=$(readlink -f "$folder")
case $part in
  lavapipe) manifest_of libvulkan_lvp.so 'lvp_icd*.json' mesa ;;
  radeon) manifest_of libvulkan_radeon.so 'radeon_icd*.json' radeon ;;
  shim)
    unpack mesa-drm-shim shim
    find "$unpacked" -name libamdgpu_noop_drm_shim.so | grep . ||
      unavailable "the package has no shim for AMD GPUs"
    ;;
esac
