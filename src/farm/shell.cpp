#include "farm/quote.h"
#include "farm/writers.h"

namespace candela {
namespace {

constexpr std::string_view shell_body = R"SH(
say() { printf '%s\n' "$*" >&2; }

# Of machines that try at the same time, one makes the folder. Its name holds how often the shard was run before, so
# that a machine that died holds back nothing once its run is on record.
claim() {  # SHARD
  set -- "$1" "$folder/records/$1of$shards"-*
  if [ -e "$2" ]; then runs=$(($# - 1)); else runs=0; fi
  [ "$runs" -lt "$rounds" ] && mkdir "$folder/claims/$1.$runs" 2>/dev/null
}

run_shard() {  # SHARD OPTION...
  shard=$1
  shift
  say "shard $shard of $shards"
  sequence --shard "$shard/$shards" --resume --record "$folder/records" "$@" >>"$folder/logs/shard-$shard.log" 2>&1 ||
    say "shard $shard ended with exit $?; see $folder/logs/shard-$shard.log"
}

cd -- "$work" || exit 1
unset CANDELA_VIDEO CANDELA_AUDIO  # the film is made at the end
mkdir -p -- "$folder/claims" "$folder/logs" || exit 1
shard=0
while [ $((shard += 1)) -le "$shards" ]; do
  set -- "$folder/records/${shard}of$shards"-*
  if [ ! -e "$1" ] && claim "$shard"; then run_shard "$shard"; fi
done
# Then what is missing, until nothing is left that this machine can do. A line of candela farm check is
#   again|never|wait EXCLUDED_NODES|- MEMORY_FACTOR SHARDS
node=${SLURMD_NODENAME:-$(hostname)}
while :; do
  status=0
  todo=$("$candela" farm check "$folder") || status=$?
  if [ "$status" -ne 1 ]; then exit "$status"; fi
  busy=
  while read -r what excluded factor list; do
    case $what,$excluded, in again,*",$node,"* | never,* | wait,*) continue ;; esac
    for shard in $(printf '%s' "$list" | tr , ' '); do
      claim "$shard" || continue
      busy=1
      # One machine has no more memory to give: fewer frames at once need less.
      if [ "$factor" -gt 1 ]; then run_shard "$shard" --encoders 1 --in-flight 1; else run_shard "$shard"; fi
    done
  done <<END
$todo
END
  if [ -z "$busy" ]; then break; fi
done
say "left to other machines, or for good (candela farm status says which):"
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
      "# too. Each takes shards that nobody has; the last to end makes the film. Run it again to go on.\n";
  text += "folder=" + shell_quoted(job.folder.string()) + "\n";
  text += "work=" + shell_quoted(job.work.string()) + "\n";
  text += "candela=" + shell_quoted(job.program) + "\n";
  text += fmt::format("shards={}\nrounds=${{ROUNDS:-{}}}  # how often a shard is tried\n", job.shards, job.rounds);
  text += "sequence() {  # OPTION...\n  \"$candela\" sequence \\\n" + argument_lines(job.arguments, "    ", " \\") +
          "    \"$@\"\n}\n";
  text += shell_body;
  return std::vector<FarmFile>{{"job.sh", text}};
}

}  // namespace candela
