# Sourced by test.sh: the steps that passed of the sources as they are, so that a run which was stopped goes on there.
# shellcheck shell=bash

kept_steps=build/full_steps # its first line says of which sources; then "step <tab> seconds", one a line

# One line that is another one for other sources: the commit and what was changed since. Empty outside of a repository.
sources() {
  git rev-parse --verify -q HEAD >/dev/null 2>&1 || return 0
  {
    git rev-parse HEAD
    git diff --binary HEAD
    git ls-files --others --exclude-standard -z | xargs -0r sha256sum
  } | sha256sum | cut -d ' ' -f 1
}

# Forgets what was kept of other sources.
open_kept_steps() {
  local here
  here=$(sources)
  mkdir -p "$(dirname "$kept_steps")"
  if [[ -z $here || $(head -n 1 "$kept_steps" 2>/dev/null) != "$here" ]]; then printf '%s\n' "$here" >"$kept_steps"; fi
}

keep_step() { printf '%s\t%s\n' "$1" "$2" >>"$kept_steps"; } # name, seconds

# The seconds that it took; nothing where it did not pass.
kept_step() { awk -F '\t' -v name="$1" 'NR > 1 && $1 == name { print $2; exit }' "$kept_steps"; }
