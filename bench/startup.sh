#!/usr/bin/env bash
# Measures start-up, one frame cold and warm, sequence against render, and a long run; see README.md beside this file.
set -euo pipefail
export LC_ALL=C

here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
root=$(dirname -- "$here")
program=$root/build/release/candela
runs=9
sequence_frames=48
long_frames=1000

while [[ $# -gt 0 ]]; do
  case $1 in
    --program) program=$2; shift 2 ;;
    --runs) runs=$2; shift 2 ;;
    --frames) long_frames=$2; shift 2 ;;
    --quick) runs=3 sequence_frames=8 long_frames=60; shift ;;
    *) sed -n '2,3p' "$0" >&2; printf 'usage: bench/startup.sh [--program FILE] [--runs N] [--frames N] [--quick]\n' >&2; exit 2 ;;
  esac
done
[[ -x $program ]] || { printf 'no program at %s: ./run build\n' "$program" >&2; exit 3; }

small=$root/scenes/animated/animated.glb
sponza=$root/../shared/assets/scenes/Sponza/Sponza.gltf
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
say() { printf '%s\n' "$*" >&2; }

now_ms() { awk -v t="$EPOCHREALTIME" 'BEGIN { printf "%.3f", t * 1000 }'; }

# Wall milliseconds of a command are appended to FILE.
timed() {  # FILE COMMAND...
  local file=$1 from to
  shift
  from=$EPOCHREALTIME
  "$@" >/dev/null 2>"$work/stderr" || { cat "$work/stderr" >&2; say "failed: $*"; exit 1; }
  to=$EPOCHREALTIME
  awk -v a="${from/,/.}" -v b="${to/,/.}" 'BEGIN { printf "%.3f\n", (b - a) * 1000 }' >>"$file"
}

fresh_cache() {  # NAME
  rm -rf -- "${work:?}/cache-$1"
  mkdir -p "$work/cache-$1"/{candela,mesa}
}
with_cache() {  # NAME COMMAND...
  local name=$1
  shift
  CANDELA_CACHE_DIR=$work/cache-$name/candela MESA_SHADER_CACHE_DIR=$work/cache-$name/mesa "$@"
}

# {"median": ..., "min": ..., "mad": ..., "count": ..., "samples": [...]} of the numbers in FILE.
statistics() {
  sort -g "$1" | awk '
    function median(list, n) { return n % 2 ? list[(n + 1) / 2] : (list[n / 2] + list[n / 2 + 1]) / 2 }
    { x[NR] = $1; all = all (NR > 1 ? ", " : "") $1 }
    END {
      m = median(x, NR)
      for (i = 1; i <= NR; i++) d[i] = x[i] > m ? x[i] - m : m - x[i]
      for (i = 2; i <= NR; i++) for (j = i; j > 1 && d[j - 1] > d[j]; j--) { t = d[j]; d[j] = d[j - 1]; d[j - 1] = t }
      printf "{\"median\": %g, \"min\": %g, \"mad\": %g, \"count\": %d, \"samples\": [%s]}", m, x[1], median(d, NR), NR, all
    }'
}

# The "cpu_ms" members (and those of "memory") of the timings files given, one file of samples for each name.
stages() {  # PREFIX FILE...
  local prefix=$1
  shift
  awk -v prefix="$prefix" '
    /^  "(cpu_ms|memory)": \{/ { inside = 1; next }
    /^  \}/ { inside = 0 }
    inside && match($0, /"[^"]+"/) {
      name = substr($0, RSTART + 1, RLENGTH - 2)
      value = $0
      sub(/^[^:]*:[ ]*/, "", value)
      sub(/,$/, "", value)
      print value >> (prefix "." name)
    }
    /^  "gpu_frame_ms":/ || /^  "process_ms":/ {
      name = $1
      gsub(/[":]/, "", name)
      value = $2
      sub(/,$/, "", value)
      print value >> (prefix "." name)
    }' "$@"
}

object_of() {  # PREFIX
  local file first=1
  printf '{'
  for file in "$1".*; do
    [[ $first ]] || printf ', '
    first=
    printf '"%s": ' "${file##*.}"
    statistics "$file"
  done
  printf '}'
}

measure_version() {
  say "candela --version"
  for _ in $(seq $((runs * 3))); do timed "$work/version" "$program" --version; done
}

# Scenes and caches take turns, so that a machine that slows down slows all of them. Wall times are of what users run;
# --timings, which submits each pass alone and draws a frame more to warm up, has runs of its own for the stages.
measure_render() {
  local scene name run cache
  for run in $(seq "$runs"); do
    for scene in "$small" "$sponza"; do
      [[ -f $scene ]] || continue
      name=$(basename -- "${scene%.*}")
      local view=()
      [[ $scene != "$sponza" ]] || view=(--eye=-9,1.5,0 --target=0,2,0 --yfov 60)
      local job=("$program" render "$scene" --size 1280x720 "${view[@]}" -o "$work/frame.exr" --quiet)
      fresh_cache "$name"
      for cache in cold warm; do
        say "render $name, $cache cache, run $run of $runs"
        timed "$work/render.$name.$cache.wall" with_cache "$name" "${job[@]}"
      done
      fresh_cache "$name"
      for cache in cold warm; do
        with_cache "$name" "${job[@]}" --timings "$work/t.json" >/dev/null
        stages "$work/stage.$name.$cache" "$work/t.json"
        cp "$work/t.json" "$work/last.json"
      done
    done
  done
}

measure_sequence() {
  local last=$((sequence_frames - 1)) run frame from size=(--size 320x180 --quiet)
  fresh_cache sequence
  with_cache sequence "$program" render "$small" "${size[@]}" -o "$work/warm.exr" >/dev/null
  for run in 1 2 3; do
    say "sequence of $sequence_frames frames, run $run of 3"
    mkdir -p "$work/a" "$work/b"
    timed "$work/sequence" with_cache sequence "$program" sequence "$small" --frames "0-$last" "${size[@]}" -o "$work/a/%04d.exr"
    say "$sequence_frames render calls, run $run of 3"
    from=$(now_ms)
    for frame in $(seq 0 "$last"); do
      with_cache sequence "$program" render "$small" --frame "$frame" "${size[@]}" -o "$work/b/%04d.exr" >/dev/null
    done
    awk -v a="$from" -v b="$(now_ms)" 'BEGIN { printf "%.3f\n", b - a }' >>"$work/renders"
    diff -rq "$work/a" "$work/b" >&2 || { say "sequence and render wrote different bytes"; exit 1; }
    rm -rf -- "$work/a" "$work/b"
  done
}

# Resident memory and finished frames twice a second; slopes by least squares over the second half, when caches are full.
measure_long_run() {
  local out=$work/long pid resident done_frames
  mkdir -p "$out"
  fresh_cache long
  say "sequence of $long_frames frames"
  # exec, so that the process watched is the program and not a shell around it.
  (
    export CANDELA_CACHE_DIR=$work/cache-long/candela MESA_SHADER_CACHE_DIR=$work/cache-long/mesa
    exec "$program" sequence "$small" --frames "0-$((long_frames - 1))" --size 160x90 --quiet -o "$out/%05d.exr" >/dev/null
  ) &
  pid=$!
  while resident=$(awk '/^VmRSS:/ { print $2 }' "/proc/$pid/status" 2>/dev/null) && [[ -n $resident ]]; do
    done_frames=$(find "$out" -name '*.exr' | wc -l)
    printf '%s %s %s\n' "$done_frames" "$resident" "$(now_ms)" >>"$work/long.samples"
    sleep 0.5
  done
  wait "$pid"
}

long_run_json() {
  awk -v frames="$long_frames" '
    { n[NR] = $1; kib[NR] = $2; ms[NR] = $3; if ($2 > peak) peak = $2 }
    END {
      for (i = 1; i <= NR; i++) if (n[i] >= frames / 2) {
        c++; sx += n[i]; sy += kib[i]; sxx += n[i] * n[i]; sxy += n[i] * kib[i]
        if (c == 1) { first_n = n[i]; first_ms = ms[i] }
      }
      d = c * sxx - sx * sx
      slope = d > 0 ? (c * sxy - sx * sy) / d : 0
      for (i = 1; i <= NR; i++) if (n[i] > 0 && !start) { start = 1; n0 = n[i]; t0 = ms[i] }
      early = first_n > n0 ? (first_ms - t0) / (first_n - n0) : 0
      late = n[NR] > first_n ? (ms[NR] - first_ms) / (n[NR] - first_n) : 0
      printf "{\"frames\": %d, \"peak_kib\": %d, \"memory_slope_kib_per_frame\": %.3f, \"ms_per_frame_first_half\": %.3f, \"ms_per_frame_second_half\": %.3f, \"samples\": %d}", frames, peak, slope, early, late, NR
    }' "$work/long.samples"
}

render_json() {
  local wall name first=1
  printf '{'
  for wall in "$work"/render.*.wall; do
    name=${wall#"$work"/render.}
    name=${name%.wall}
    [[ $first ]] || printf ',\n    '
    first=
    printf '"%s": {"wall_ms": ' "$name"
    statistics "$wall"
    printf ', "stages": '
    object_of "$work/stage.$name"
    printf '}'
  done
  printf '}'
}

[[ -f $sponza ]] || say "notice: Sponza is absent, its part is left out"
measure_version
measure_render
measure_sequence
measure_long_run

# The block "device": {...} of a timings file, as it is.
device=$(awk '/^  "device": \{/ { on = 1; print "{"; next } on { print } on && /^  \}/ { exit }' "$work/last.json" | sed '$ s/,$//')
class=$(printf '%s' "$device" | awk -F'"' '$2 == "class" { print $4 }')
mkdir -p "$here/results/${class:-unknown}"
result=$here/results/${class:-unknown}/startup.json
{
  printf '{\n  "version": "%s",\n' "$("$program" --version)"
  printf '  "device": %s,\n  "cpu_cores": %s,\n' "$device" "$(nproc)"
  printf '  "load_average_at_end": %s,\n' "$(awk '{ print $1 }' /proc/loadavg)"
  printf '  "version_ms": %s,\n' "$(statistics "$work/version")"
  printf '  "render": %s,\n' "$(render_json)"
  printf '  "sequence_against_render": {"frames": %d, "sequence_ms": %s, "renders_ms": %s},\n' "$sequence_frames" \
    "$(statistics "$work/sequence")" "$(statistics "$work/renders")"
  printf '  "long_run": %s\n}\n' "$(long_run_json)"
} >"$work/result.json"
mv -- "$work/result.json" "$result"
say "wrote $result"
