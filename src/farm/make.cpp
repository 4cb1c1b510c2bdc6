#include "farm/quote.h"
#include "farm/writers.h"

namespace candela {

Expected<std::vector<FarmFile>> make_file(const FarmJob& job) {
  std::vector<std::string> all = job.arguments;
  all.insert(all.end(), {job.folder.string(), job.work_from_folder().string(), job.program});
  for (const std::string& word : all)
    if (word.find_first_of("\n\r") != std::string::npos)
      return fail(ErrorKind::usage, "make", "make cannot hold a line break, and '{}' has one", comment_text(word));
  // In a recipe, where make is in the job's folder.
  const std::string settings = recipe_text("folder=$(pwd); " + path_settings(job, "; ")) + "cd -- \"$$work\" && ";
  std::string text = fmt::format("# {} frames of {} in {} shards, by GNU make. Written by candela farm make.\n#\n",
                                 job.frame_list().size(), comment_text(job.scene), job.shards);
  text += fmt::format("#   make -j 4 -k -C {} -f job.mk\n#\n", comment_text(shell_quoted(job.folder.string())));
  text +=
      "# Machines may see the folder under different names, and have the program and the scene elsewhere: make\n"
      "# CANDELA_PROGRAM=FILE CANDELA_SCENE=FILE, or in the environment.\n"
      "# -j says how many shards at once, -k goes on after one that failed; the same command again tries those once "
      "more.\n"
      "# Tools that spread make over machines do so with this file.\n\n";
  std::string shards;
  for (int i = 1; i <= job.shards; ++i) shards += fmt::format(" {}", i);
  text += "shards :=" + shards + "\n\n.PHONY: all\n.DELETE_ON_ERROR:\n\n";
  text += "all: $(shards:%=done/%)\n";
  text += "\t" + settings +
          "\"$$candela\" farm check \"$$folder\" --lost-after 0 || { rm -f -- \"$$folder\"/done/*; exit 1; }\n\n";
  text += "done/%:\n\t@mkdir -p done logs\n";
  text += "\tunset CANDELA_VIDEO CANDELA_VIDEO_CODEC CANDELA_VIDEO_PAD CANDELA_AUDIO; " + settings +
          "\"$$candela\" sequence \"$$scene\"";
  for (const std::string& word : words_after_scene(job)) text += " " + recipe_quoted(word);
  text += fmt::format(
      " \\\n\t  --shard $*/{} --resume --record \"$$folder/records\" >>\"$$folder/logs/shard-$*.log\" 2>&1\n",
      job.shards);
  text += "\t@touch $@\n";
  return std::vector<FarmFile>{{"job.mk", text}};
}

}  // namespace candela
