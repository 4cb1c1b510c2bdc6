#include "farm/quote.h"
#include "farm/writers.h"

namespace candela {
namespace {

constexpr std::string_view shell_body = R"SH(
say() { printf '%s\n' "$*" >&2; }

# A claim is a file claims/SHARD.N, the N-th of its shard: who made it (host, boot, process, start of the process), then
# a line for each beat of its heart, and "released" at its end. It is made whole, by one worker alone (a hard link), and
# never taken away, so that who decided by an old claim cannot take a newer one.
beat_s=15   # between two beats
lost_s=120  # a worker of another machine is taken for dead when its claim does not change for so long

started() { tr '\n' ' ' <"/proc/$1/stat" | sed 's/^.*) \([A-Z]\) /\1 /' | cut -d' ' -f1,20; } 2>/dev/null  # PROCESS
host=$(hostname)
boot=$(cat /proc/sys/kernel/random/boot_id 2>/dev/null)/$(readlink /proc/self/ns/pid 2>/dev/null)
start=$(started $$)
start=${start#* }

alive() {  # PROCESS START, on this machine
  set -- "$2" "$(started "$1")"
  case $2 in "" | Z* | X*) return 1 ;; esac
  [ "${2#* }" = "$1" ]
}

# Of a claim: beats, and whose it is: free, a dead worker's (both free), one that lives here (here) or one of another
# machine (away).
read_claim() {  # FILE
  beats=0 owner=away mark=
  {
    read -r by_host && read -r by_boot && read -r by_process && read -r by_start || by_host=
    while read -r line; do beats=$((beats + 1)) mark=$line; done
  } <"$1"
  if [ "$mark" = released ]; then
    owner=free
  elif [ "$by_host" = "$host" ] && [ "$by_boot" = "$boot" ] && [ "$boot" != / ] && [ "$by_start" ]; then
    if alive "$by_process" "$by_start"; then owner=here; else owner=free; fi
  fi
}

# For each shard: newest_SHARD, the number of its newest claim, and owner_SHARD.
look_at_claims() {
  shard=0
  while [ $((shard += 1)) -le "$shards" ]; do eval "newest_$shard=0 owner_$shard=free"; done
  for file in "$folder"/claims/*.*; do
    if [ ! -e "$file" ]; then continue; fi
    number=${file##*.}
    shard=${file%.*}
    shard=${shard##*/}
    if eval "[ $number -gt \$newest_$shard ]"; then eval "newest_$shard=$number"; fi
  done
  shard=0
  while [ $((shard += 1)) -le "$shards" ]; do
    eval "number=\$newest_$shard"
    if [ "$number" -eq 0 ]; then continue; fi
    read_claim "$folder/claims/$shard.$number"
    if [ "$owner" = away ] && eval "[ \"\${lost_$shard:-}\" = $number.$beats ]"; then owner=free; fi
    eval "owner_$shard=$owner"
  done
}

claim() {  # SHARD; by what look_at_claims saw
  eval "number=\$newest_$1 owner=\$owner_$1"
  [ "$owner" = free ] || return 1
  mine=$folder/claims/$1.$((number + 1))
  new=$folder/claims/.$host-$$
  printf '%s\n' "$host" "$boot" "$$" "$start" >"$new" && ln -- "$new" "$mine" 2>/dev/null
  set -- $?
  rm -f -- "$new"
  return "$1"
}

heartbeat() { while sleep "$beat_s" && alive $$ "$start"; do echo . >>"$mine"; done; } >/dev/null 2>&1

# A run that ended before it could make its record gets one, so that its failure shows.
record_failure() {  # SHARD CODE
  name=$(printf %s "$node" | tr -c 'A-Za-z0-9_.-' _)
  now=$(date +%s)
  new=$folder/records/.$name-$$
  printf '{"shard": %s, "shards": %s, "node": "%s", "host": "%s", "process": %s, "started": %s, "updated": %s,
    "scene_content": "", "device": "", "driver": "", "frames": 0, "rendered": 0, "skipped": 0, "code": %s,
    "error": "ended before it began; see logs/shard-%s.log"}\n' \
    "$1" "$shards" "$name" "$name" $$ "$now" "$now" "$2" "$1" >"$new" &&
    mv -- "$new" "$folder/records/${1}of$shards-$name-$now-$$-$records.json"
}

count_records() {  # SHARD
  set -- "$folder/records/${1}of$shards"-*
  if [ -e "$1" ]; then records=$#; else records=0; fi
}

run_shard() {  # SHARD OPTION...
  shard=$1
  shift
  say "shard $shard of $shards"
  count_records "$shard"
  before=$records
  heartbeat &
  beating=$!
  code=0
  sequence --shard "$shard/$shards" --resume --record "$folder/records" "$@" >>"$folder/logs/shard-$shard.log" 2>&1 ||
    code=$?
  kill "$beating" 2>/dev/null
  wait "$beating" 2>/dev/null
  eval "tries_$shard=\$((\${tries_$shard:-0} + 1))"
  count_records "$shard"
  if [ "$code" -ne 0 ]; then
    say "shard $shard ended with exit $code; see $folder/logs/shard-$shard.log"
    if [ "$records" -eq "$before" ]; then record_failure "$shard" "$code"; fi
    case $code in 2 | 3 | 7) eval "tries_$shard=$rounds" ;; esac  # would end so again
  fi
  echo released >>"$mine"
  case $code in
    126 | 127)
      say "$candela does not run on this machine"
      exit "$code"
      ;;
  esac
}

# Shards of workers on other machines: whose claim does not change for lost_s of this machine's own time is lost_SHARD.
watch_others() {  # SHARD...
  for shard; do
    eval "number=\$newest_$shard"
    read_claim "$folder/claims/$shard.$number"
    eval "lost_$shard=$number.$beats"
  done
  sleep "$lost_s"
  look_at_claims
  for shard; do
    if eval "[ \$owner_$shard = free ]"; then return 0; fi
  done
  return 1
}

cd -- "$work" || exit 1
unset CANDELA_VIDEO CANDELA_VIDEO_CODEC CANDELA_VIDEO_PAD CANDELA_AUDIO  # the film is made at the end
mkdir -p -- "$folder/claims" "$folder/logs" "$folder/records" || exit 1
# What workers of this machine left that were killed while they made a claim or a record.
for file in "$folder"/claims/."$host"-* "$folder"/records/."$host"-*; do
  if [ -e "$file" ] && ! kill -0 "${file##*-}" 2>/dev/null; then rm -f -- "$file"; fi
done
node=${SLURMD_NODENAME:-$host}
look_at_claims
next=0
while [ $((next += 1)) -le "$shards" ]; do
  count_records "$next"
  if [ "$records" -eq 0 ] && claim "$next"; then run_shard "$next"; fi
done
# Then what is missing, until nothing is left that this machine can do. A line of candela farm check is
#   again|never EXCLUDED_NODES|- MEMORY_FACTOR SHARDS
# Each start of this script tries each shard as often as rounds says, whatever became of it before.
while :; do
  look_at_claims
  status=0
  todo=$("$candela" farm check "$folder" --lost-after 0) || status=$?
  if [ "$status" -ne 1 ]; then exit "$status"; fi
  busy='' away=''
  while read -r what excluded factor list; do
    for next in $(printf '%s' "$list" | tr , ' '); do
      eval "tries=\${tries_$next:-0} owner=\$owner_$next"
      if [ "$tries" -ge "$rounds" ]; then continue; fi
      case $tries,$excluded, in [1-9]*,*",$node,"*) continue ;; esac
      if [ "$owner" = away ]; then away="$away $next"; fi
      claim "$next" || continue
      busy=1
      # One machine has no more memory to give: fewer frames at once need less.
      if [ "$factor" -gt 1 ]; then run_shard "$next" --encoders 1 --in-flight 1; else run_shard "$next"; fi
    done
  done <<END
$todo
END
  if [ "$busy" ]; then continue; fi
  if [ -z "$away" ]; then break; fi
  say "waiting $lost_s s to see whether other machines are at work on shards$away"
  watch_others $away || break
done
say "left to other workers, or failed here (candela farm status says which); the same command tries them again:"
say "$todo"
exit 1
)SH";

}  // namespace

Expected<std::vector<FarmFile>> shell_file(const FarmJob& job) {
  const std::string file = (job.folder / "job.sh").string();
  std::string text = "#!/bin/sh\n";
  text += fmt::format("# {} frames of {} in {} shards. Written by candela farm shell.\n#\n", job.frame_list().size(),
                      comment_text(job.scene), job.shards);
  text += fmt::format("#   sh {}\n#\n", comment_text(shell_quoted(file)));
  text +=
      "# on as many machines as you like that see this folder and the frames, at any time, several times on one "
      "machine\n"
      "# too. Each takes free shards; the last to end makes the film. Run it again to go on.\n";
  text +=
      "# Machines may see the folder under different names, and have the program and the scene elsewhere\n"
      "# (CANDELA_PROGRAM, CANDELA_SCENE).\n"
      "folder=$(CDPATH= cd -- \"$(dirname -- \"$0\")\" && pwd) || exit 1\n";
  text += path_settings(job);
  text +=
      fmt::format("shards={}\nrounds={}  # how often a start of this script tries a shard\n", job.shards, job.rounds);
  text += "sequence() {  # OPTION...\n  \"$candela\" sequence \"$scene\" \\\n" +
          argument_lines(words_after_scene(job), "    ", " \\") + "    \"$@\"\n}\n";
  text += shell_body;
  return std::vector<FarmFile>{{"job.sh", text}};
}

}  // namespace candela
