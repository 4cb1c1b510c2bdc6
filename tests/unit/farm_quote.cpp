#include "farm/quote.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

namespace candela {
namespace {

const std::vector<std::string> hostile = {"",           "plain-1.0_x/y",        "two words",  "it's",
                                          "\"quoted\"", "$(touch x) `y` $HOME", "a\\nb \\",   "*?[x]{a,b}~ !#&;|<>",
                                          "%A %% %04d", "line\nbreak\ttab",     "\xc3\xbc -n"};

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  while (const size_t n = fread(buffer.data(), 1, buffer.size(), pipe)) text.append(buffer.data(), n);
  EXPECT_EQ(pclose(pipe), 0);
  return text;
}

TEST(Quote, AShellReadsEveryWordAsItIs) {
  for (const std::string& word : hostile) EXPECT_EQ(output_of("printf %s " + shell_quoted(word)), word);
  std::string all;
  for (const std::string& word : hostile) all += "<" + word + ">";
  EXPECT_EQ(output_of("printf '<%s>' " + shell_quoted(hostile)), all);
  EXPECT_EQ(shell_quoted("plain-1.0_x/y"), "plain-1.0_x/y");
}

TEST(Quote, LinesOfArgumentsAreTheSameWords) {
  const std::vector<std::string> words = {"a b.glb", "--frames", "0-9", "--exposure=-1", "--no-dither", "-o", "it's"};
  EXPECT_EQ(argument_lines(words, "  ", " \\"),
            "  'a b.glb' \\\n  --frames 0-9 \\\n  --exposure=-1 \\\n  --no-dither \\\n  -o 'it'\\''s' \\\n");
  EXPECT_EQ(output_of("printf '<%s>' " + argument_lines(words, "", " \\") + "\n"),
            "<a b.glb><--frames><0-9><--exposure=-1><--no-dither><-o><it's>");
}

TEST(Quote, PythonReadsEveryTextAsItIs) { EXPECT_EQ(python_quoted("it's a\\b\n\x7f"), "'it\\'s a\\\\b\\x0a\\x7f'"); }

TEST(Quote, MakeKeepsDollarsInRecipes) { EXPECT_EQ(recipe_quoted("$(x) $$"), "'$$(x) $$$$'"); }

TEST(Quote, CommentsAndNamesHoldOneLine) {
  EXPECT_EQ(comment_text("a\nb\x1b[m"), "a?b?[m");
  EXPECT_EQ(plain_name("a b/c:$(d)-1.x_%"), "a_b_c___d_-1.x__");
}

}  // namespace
}  // namespace candela
