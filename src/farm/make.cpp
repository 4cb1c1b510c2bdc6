#include "farm/quote.h"
#include "farm/writers.h"

namespace candela {

Expected<std::vector<FarmFile>> make_file(const FarmJob& job) {
  std::vector<std::string> all = job.arguments;
  all.insert(all.end(), {job.folder.string(), job.work.string(), job.program});
  for (const std::string& word : all)
    if (word.find_first_of("\n\r") != std::string::npos)
      return fail(ErrorKind::usage, "make", "make cannot hold a line break, and '{}' has one", comment_text(word));
  const std::string work = recipe_quoted(job.work.string()), folder = recipe_quoted(job.folder.string()),
                    program = recipe_quoted(job.program);
  std::string text = fmt::format("# {} frames of {} in {} shards, by GNU make. Written by candela farm make.\n#\n",
                                 job.frame_list().size(), comment_text(job.scene), job.shards);
  text += fmt::format("#   make -j 4 -k -C {} -f job.mk\n#\n", comment_text(shell_quoted(job.folder.string())));
  text +=
      "# -j says how many shards at once, -k goes on after one that failed; the same command again tries those once "
      "more.\n"
      "# Tools that spread make over machines do so with this file.\n\n";
  std::string shards;
  for (int i = 1; i <= job.shards; ++i) shards += fmt::format(" {}", i);
  text += "shards :=" + shards + "\n\n.PHONY: all\n.DELETE_ON_ERROR:\n\n";
  text += "all: $(shards:%=done/%)\n";
  text += fmt::format("\tcd -- {} && {} farm check {} --lost-after 0 || {{ rm -f -- {}/done/*; exit 1; }}\n\n", work,
                      program, folder, folder);  // the same command then makes what is missing
  text += "done/%:\n\t@mkdir -p done logs\n";
  text +=
      fmt::format("\tunset CANDELA_VIDEO CANDELA_VIDEO_CODEC CANDELA_VIDEO_PAD CANDELA_AUDIO; cd -- {} && {} sequence",
                  work, program);
  for (const std::string& word : job.arguments) text += " " + recipe_quoted(word);
  text += fmt::format(" \\\n\t  --shard $*/{} --resume --record {}/records >>{}/logs/shard-$*.log 2>&1\n", job.shards,
                      folder, folder);
  text += "\t@touch $@\n";
  return std::vector<FarmFile>{{"job.mk", text}};
}

}  // namespace candela
