#!/usr/bin/env bash
# manual.sh PROGRAM: a man page a command, with every option that its help shows, in roff without warnings.
set -euo pipefail
program=$1
. "$(dirname -- "${BASH_SOURCE[0]}")/check.sh"

"$program" manual "$work/share" && "$program" manual "$work/again"
diff -r "$work/share" "$work/again" || broken "the pages differ from run to run"
pages=$work/share/man/man1
commands=$("$program" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z-]*\) .*/\1/p')
[[ $(wc -w <<<"$commands") -ge 11 ]] || broken "too few commands: $commands"
for command in "" $commands; do
  page=$pages/candela${command:+-$command}.1
  [[ -s $page ]] || { broken "no page of $command"; continue; }
  for heading in NAME SYNOPSIS OPTIONS "EXIT STATUS" "SEE ALSO"; do
    grep -q "^\.SH $heading" "$page" || broken "$page has no $heading"
  done
  while read -r option; do
    grep -qF -- "\\fB${option//-/\\-}\\fR" "$page" || broken "$page does not name $option"
  done < <("$program" $command --help | grep -oE '^  (-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+')
  if command -v groff >/dev/null; then
    warnings=$(groff -man -Tutf8 -ww -z "$page" 2>&1)
    [[ -z $warnings ]] || broken "$warnings"
  fi
done
for command in $commands; do
  grep -qF "candela\\-${command//-/\\-}\\fR(1)" "$pages/candela.1" || broken "candela.1 does not name $command"
done
grep -q '^check$\|fBcheck' "$pages/candela-golden.1" || broken "candela-golden.1 does not name its commands"
finish
