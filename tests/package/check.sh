# Sourced by the tests here: a fresh folder $work, and what counts failures.
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
failures=0
broken() { printf 'FAILED: %s\n' "$*" >&2; failures=$((failures + 1)); }
finish() { [[ $failures -eq 0 ]] || { printf '%s checks failed\n' "$failures" >&2; exit 1; }; }
