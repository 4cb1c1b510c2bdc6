#!/usr/bin/env bash
# leaves_no_files.sh PROGRAM ARGUMENT...: runs it with a new folder for temporary files; exits 1 when it fails or leaves any behind.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
TMPDIR=$folder TEST_TMPDIR=$folder "$@"
left=$(ls -A -- "$folder")
if [[ -n $left ]]; then
  printf 'left in the folder of temporary files:\n%s\n' "$left"
  exit 1
fi
