#!/usr/bin/env bash
# Fetches the Mesa of Debian's backports, whose lavapipe is newer than the system's, below build/drivers, and prints its
# manifest's path. Nothing of the system changes: apt has lists and cache of its own there, the package is unpacked, not
# installed. What was fetched is kept. Exit code 77: it cannot be had here; says why.
# usage: fetch_driver.sh [FOLDER]; FOLDER: build/drivers
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

folder=${1:-build/drivers}
package=mesa-vulkan-drivers
keyring=/usr/share/keyrings/debian-archive-keyring.gpg # of the package debian-archive-keyring
unavailable() {
  echo "Mesa of backports: skipped, $1" >&2
  exit 77
}

shopt -s nullglob
kept=("$folder"/mesa*.json)
if [[ ${#kept[@]} -gt 0 ]]; then
  printf '%s\n' "${kept[0]}"
  exit 0
fi
for tool in apt-get dpkg-deb; do
  command -v $tool >/dev/null || unavailable "there is no $tool: this is no Debian"
done
release=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
[[ -n $release ]] || unavailable "/etc/os-release has no VERSION_CODENAME"
# The mirror that the system takes this release from, whichever way its sources are written.
mirror=$(apt-get indextargets --format '$(RELEASE) $(REPO_URI)' 'Created-By: Packages' |
  awk -v release="$release" '$1 == release { print $2; exit }')
[[ -n $mirror ]] || unavailable "the sources of apt name no mirror of '$release'"

mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial"
folder=$(readlink -f "$folder")
options=""
[[ ! -e $keyring ]] || options="[signed-by=$keyring] "
echo "deb $options$mirror $release-backports main" >"$folder/apt/sources.list"
own=(-o Dir::Etc::sourcelist="$folder/apt/sources.list" -o Dir::Etc::sourceparts=- -o Dir::State::Lists="$folder/apt/lists"
  -o Dir::Cache="$folder/apt/cache" -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any -o Acquire::Retries=2)
log=$folder/apt/log
complaint() { grep -m 1 -E '^(W|E): ' "$log" || tail -n 1 "$log"; }
apt-get "${own[@]}" update >"$log" 2>&1 || unavailable "the lists of $release-backports cannot be had: $(complaint)"
cd "$folder/apt"
rm -f "$package"_*.deb
apt-get "${own[@]}" download "$package/$release-backports" >>"$log" 2>&1 ||
  unavailable "$release-backports has no $package to give: $(complaint)"

archive=$(echo "$package"_*.deb)
version=$(dpkg-deb -f "$archive" Version)
version=${version#*:} # without the epoch
unpacked=$folder/mesa-$version
dpkg-deb -x "$archive" "$unpacked"
rm "$archive"
driver=$(find "$unpacked" -name libvulkan_lvp.so)
[[ -n $driver ]] || unavailable "Mesa $version has no lavapipe"
lacking=$(ldd "$driver" | awk '/not found/ { print $1 }' | paste -sd' ')
[[ -z $lacking ]] || unavailable "lavapipe of Mesa $version needs libraries that are not installed: $lacking"
manifest=$folder/mesa${version%%.*}.json
api=$(sed -n 's/.*"api_version": *"\([0-9.]*\)".*/\1/p' "$(dirname "$driver")"/../../share/vulkan/icd.d/lvp_icd*.json)
printf '{ "file_format_version": "1.0.0", "ICD": { "library_path": "%s", "api_version": "%s" } }\n' \
  "$driver" "$api" >"$manifest"
printf '%s\n' "$manifest"
