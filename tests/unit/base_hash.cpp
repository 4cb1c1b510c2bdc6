#include "base/hash.h"

#include <gtest/gtest.h>

namespace candela {

// Published vectors of MurmurHash3 x86_32: every length of the last block, with and without a seed, and bytes above
// 127.
TEST(Hash32, GivesThePublishedVectors) {
  EXPECT_EQ(hash32(""), 0u);
  EXPECT_EQ(hash32("", 1), 0x514e28b7u);
  EXPECT_EQ(hash32("", 0xffffffffu), 0x81f16f39u);
  EXPECT_EQ(hash32("\xff\xff\xff\xff"), 0x76293b50u);
  EXPECT_EQ(hash32("\x21\x43\x65\x87"), 0xf55b516bu);
  EXPECT_EQ(hash32("\x21\x43\x65\x87", 0x5082edeeu), 0x2362f9deu);
  EXPECT_EQ(hash32("\x21\x43\x65"), 0x7e4a8634u);
  EXPECT_EQ(hash32("\x21\x43"), 0xa0f7b07au);
  EXPECT_EQ(hash32("\x21"), 0x72661cf4u);
  EXPECT_EQ(hash32("test"), 0xba6bd213u);
  EXPECT_EQ(hash32("Hello, world!", 0x9747b28cu), 0x24884cbau);
  EXPECT_EQ(hash32("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
  EXPECT_EQ(hash32("The quick brown fox jumps over the lazy dog", 0x9747b28cu), 0x2fa826cdu);
}

}  // namespace candela
