#include "render/id_names.h"

#include <gtest/gtest.h>

namespace candela {

TEST(IdNames, AreUnique) {
  EXPECT_EQ(unique_names({"Box", "", "Box", "Box #2", "", "node #1"}, "node"),
            (std::vector<std::string>{"Box", "node #1", "Box #2", "Box #2 #3", "node #4", "node #1 #5"}));
}

}  // namespace candela
