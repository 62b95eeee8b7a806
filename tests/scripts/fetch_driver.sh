#!/usr/bin/env bash
# Fetches Mesa from Debian's backports, whose lavapipe is newer than the system's, into a folder,
# and prints the path of its manifest. The system stays unchanged: apt uses separate lists and a
# separate cache, and the package is unpacked, not installed. A driver that was fetched before is
# reused.
# usage: fetch_driver.sh [FOLDER]; default: build/drivers
# Exit code 77: the driver is not available; the reason is printed.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.."

folder=${1:-build/drivers}
package=mesa-vulkan-drivers
keyring=/usr/share/keyrings/debian-archive-keyring.gpg # from the package debian-archive-keyring
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
# The system's mirror of this release, independent of the format of apt's sources.
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
