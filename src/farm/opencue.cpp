#include "farm/quote.h"
#include "farm/writers.h"

namespace candela {
namespace {

// The outline gives cuebot a line for a shell, in which it replaces words such as #IFRAME#. All that could be mistaken
// stands in a script beside it.
constexpr std::string_view outline = R"PY(
folder = os.path.dirname(os.path.abspath(__file__))
# As the hosts see it.
task = os.path.join(os.environ.get('CANDELA_FOLDER') or folder, 'task.sh')
if any(sign in task for sign in '\n\r#'):
    sys.exit("OpenCue's commands hold neither line breaks nor #: %r" % task)
for mark in glob.glob(os.path.join(glob.escape(folder), 'claims', 'never-*')):
    os.remove(mark)  # what failed before is tried again by a new job
job = outline.Outline(
    name, show=os.environ.get('SHOW', 'testing'), shot=os.environ.get('SHOT', 'test'), user=getpass.getuser())
frames = outline.modules.shell.Shell(
    'frames', command=['/bin/sh', shlex.quote(task), '#IFRAME#'], range='1-%d' % shards, chunk=1, **needs)
check = outline.modules.shell.Shell('check', command=['/bin/sh', shlex.quote(task), 'check'], range='1-1', chunk=1)
check.depend_all(frames)
job.add_layer(frames)
job.add_layer(check)
outline.cuerun.launch(job, use_pycuerun=False, maxretries=rounds - 1)
)PY";

constexpr std::string_view task = R"SH(
cd -- "$work" || exit 1
unset CANDELA_VIDEO CANDELA_VIDEO_CODEC CANDELA_VIDEO_PAD CANDELA_AUDIO  # the film is made at the end
if [ "$1" = check ]; then exec "$candela" farm check "$folder" --lost-after 0; fi
# What would end alike everywhere is not rendered again; OpenCue has no exit code that says so.
never=$folder/claims/never-$1
if [ -e "$never" ]; then exit 3; fi
status=0
sequence --shard "$1/$shards" --resume --record "$folder/records" || status=$?
case $status in
  2 | 3 | 7) mkdir -p -- "$folder/claims" && : >"$never" ;;
  6 | 137) status=33 ;;  # OpenCue gives the layer more memory and tries again
esac
exit "$status"
)SH";

}  // namespace

Expected<std::vector<FarmFile>> opencue_files(const FarmJob& job) {
  const std::string folder = job.folder.string();
  if (folder.find_first_of("\n\r#") != std::string::npos)
    return fail(ErrorKind::usage, "--job", "OpenCue's commands hold neither line breaks nor #, and '{}' has some",
                comment_text(folder));
  std::string text = "#!/usr/bin/env python3\n";
  text += fmt::format("# {} frames of {} in {} shards: an outline for OpenCue. Written by candela farm opencue.\n#\n",
                      job.frame_list().size(), comment_text(job.scene), job.shards);
  text += fmt::format("#   SHOW=... SHOT=... python3 {}\n#\n", comment_text(shell_quoted(folder + "/job.py")));
  text +=
      "# submits it, with OpenCue's pyoutline. Exit 6 (memory) is 33 to OpenCue, which then asks for more; other codes "
      "are\n"
      "# tried again as often as maxretries says; the layer check comes last and makes the film.\n";
  text +=
      "import getpass\nimport glob\nimport os\nimport shlex\nimport sys\n\nimport outline\nimport "
      "outline.cuerun\nimport "
      "outline.modules.shell\n\n";
  text += "name = " + python_quoted(job.name) + "\n";
  text += fmt::format("shards = {}\nrounds = {}\n", job.shards, job.rounds);
  text += fmt::format("needs = {{'threads': {}, 'memory': '{}m'{}{}}}\n", job.needs.cpus, job.needs.memory_mb,
                      job.needs.gpus > 0 ? fmt::format(", 'gpus': {}", job.needs.gpus) : "",
                      job.needs.minutes > 0 ? fmt::format(", 'timeout': {}", job.needs.minutes) : "");
  text += outline;
  std::string script = "#!/bin/sh\n# A frame of job.py: a shard's number, or check.\n";
  script += "folder=$(CDPATH= cd -- \"$(dirname -- \"$0\")\" && pwd) || exit 1\n";
  script += path_settings(job);
  script += fmt::format("shards={}\n", job.shards);
  script += "sequence() {  # OPTION...\n  \"$candela\" sequence \"$scene\" \\\n" +
            argument_lines(words_after_scene(job), "    ", " \\") + "    \"$@\"\n}\n";
  script += task;
  return std::vector<FarmFile>{{"job.py", text}, {"task.sh", script}};
}

}  // namespace candela
