#!/usr/bin/env bash
# completion.sh PROGRAM: what shells offer for the beginnings of some lines. Bash for certain; zsh and fish where they are there.
set -euo pipefail
program=$1
. "$(dirname -- "${BASH_SOURCE[0]}")/check.sh"

"$program" completion bash >"$work/bash" && "$program" completion zsh >"$work/zsh" && "$program" completion fish >"$work/fish"
. "$work/bash"
compopt() { :; }  # works inside a real completion only
offers() {  # EXPECTED WORD...: as after the last word
  local expected=$1
  shift
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  _candela || true  # compgen fails where it finds nothing
  [[ "${COMPREPLY[*]:-}" == "$expected" ]] || broken "'${*}' offers '${COMPREPLY[*]:-}', not '$expected'"
}
offers "render reference" candela re
offers "--technique" candela render --te
offers "clustered forward-plus brute-force visibility hybrid ray deferred-clustered deferred-tiled deferred-volumes auto" candela render --technique ""
offers "forward-plus" candela render --technique = f
offers "check" candela golden ch
offers "--root --report" candela golden check --r
offers "stained street street-dense street-dusk" candela make-scene st
offers "depth,normal" candela render --layers depth,nor
offers "" candela render --exposure ""
offers "auto on off" candela sequence --cache ""
offers "bash zsh fish" candela completion ""
touch "$work/one scene.glb" && mkdir "$work/one folder"
offers "$work/one scene.glb" candela render "$work/one s"
offers "$work/one folder" candela bench --allow-path "$work/one"
# Hidden commands stay hidden.
offers "" candela man

# Every option that the help shows is in all three.
for command in render sequence reference plan compare bench; do
  while read -r option; do
    for shell in bash zsh; do grep -qF -- "$option" "$work/$shell" || broken "$shell does not know $command $option"; done
    grep -qE -- " -l ${option#--}( |$)" "$work/fish" || broken "fish does not know $command $option"
  done < <("$program" "$command" --help | grep -oE '^  (-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+')
done

if command -v zsh >/dev/null; then zsh -n "$work/zsh" || broken "zsh does not read its script"; fi
if command -v fish >/dev/null; then
  fish_offers() {  # EXPECTED LINE
    local got
    got=$(fish --no-config -c "source $work/fish; complete -C '$2'" | cut -f1 | tr '\n' ' ')
    [[ $got == "$1 " ]] || broken "fish: '$2' offers '$got', not '$1'"
  }
  fish_offers "reference render" "candela re"
  fish_offers "--technique" "candela render --te"
  fish_offers "check" "candela golden ch"
fi
finish
