#include "base/names.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

using namespace std::string_literals;

TEST(Names, InMessagesAreQuotedEscapedAndCut) {
  EXPECT_EQ(quoted_name("Küche 1"), "'Küche 1'");
  EXPECT_EQ(quoted_name("a'b\\c"), "'a\\'b\\\\c'");
  EXPECT_EQ(quoted_name("a\0b\n\x1b]0;title\a"s), "'a\\x00b\\n\\x1b]0;title\\x07'");
  EXPECT_EQ(quoted_name("\u202egnp.exe\u2066\u0085"), "'\\u202egnp.exe\\u2066\\x85'");
  EXPECT_EQ(quoted_name("\xff\xc3(\xed\xa0\x80"), "'\\xff\\xc3(\\xed\\xa0\\x80'") << "no UTF-8";
  EXPECT_EQ(quoted_name(std::string(80, 'x')), "'" + std::string(80, 'x') + "'");
  EXPECT_EQ(quoted_name(std::string(81, 'x')), "'" + std::string(80, 'x') + "...'");
  EXPECT_EQ(printable("one\ntwo\tthree"), "one\\ntwo\\tthree");
}

TEST(Names, InFileNamesAreSafeAndTellApartWhatIsDifferent) {
  EXPECT_EQ(file_name_part("Main Camera"), "Main_Camera");
  EXPECT_EQ(file_name_part("Küche"), "Küche");
  EXPECT_EQ(file_name_part("../../etc/passwd"), "_._.._etc_passwd");
  EXPECT_EQ(file_name_part("-o\0b*?\n"s), "_o_b___");
  EXPECT_EQ(file_name_part(""), "_");
  const std::string long_a = std::string(200, 'x') + "a", long_b = std::string(200, 'x') + "b";
  EXPECT_EQ(file_name_part(long_a).size(), 80u);
  EXPECT_NE(file_name_part(long_a), file_name_part(long_b));
  EXPECT_EQ(file_name_part(std::string(79, 'x') + "ü").find('\xc3'), std::string::npos) << "cut inside a character";
  EXPECT_EQ(file_name_parts({"a/b", "a:b", "A b", "c", "a_b-2"}),
            (std::vector<std::string>{"a_b", "a_b-2", "A_b-3", "c", "a_b-2-2"}));
}

}  // namespace
}  // namespace candela
