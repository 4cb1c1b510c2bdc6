#include "base/log_gather.h"

#include <gtest/gtest.h>

#include "base/log.h"
#include "base/log_form.h"

namespace candela {
namespace {

template <class F>
std::string said(F&& f) {
  testing::internal::CaptureStderr();
  f();
  return testing::internal::GetCapturedStderr();
}

TEST(LogGather, FewLinesAreAllPrintedInTheirOrder) {
  EXPECT_EQ(said([] {
              log::gather();
              log::info("one");
              log::headline("device");
              log::warning("two");
              log::release(2);
              log::info("wrote");
            }),
            "device\none\nwarning: two\nwrote\n");
}

TEST(LogGather, OfManyTheLastWarningsStayAndTheRestIsCounted) {
  EXPECT_EQ(said([] {
              log::gather();
              for (int i = 0; i < 183; ++i) log::warning("of the file, {}", i);
              for (int i = 0; i < 4; ++i) log::info("note {}", i);
              log::warning("the frame is blank");
              log::release(3);
            }),
            "warning: of the file, 182\nwarning: the frame is blank\nwarning: 186 more lines, 182 of them warnings "
            "(--verbose)\n");
  EXPECT_EQ(said([] {
              log::gather();
              for (int i = 0; i < 4; ++i) log::info("note {}", i);
              log::release(2);
            }),
            "note 0\n3 more lines (--verbose)\n");
}

TEST(LogGather, AnErrorComesAfterWhatWasKept) {
  EXPECT_EQ(said([] {
              log::gather();
              log::warning("a");
              log::error("b");
              log::info("c");
            }),
            "warning: a\nerror: b\nc\n");
}

TEST(LogGather, WhereAllIsWantedNothingIsKept) {
  log::set_level(log::Level::debug);
  EXPECT_EQ(said([] {
              log::gather();
              for (int i = 0; i < 9; ++i) log::info("{}", i);
            }).size(),
            18u);
  log::set_level(log::Level::info);
  log::set_form(log::Form::json);
  EXPECT_NE(said([] {
              log::gather();
              log::info("at once");
            }).find("at once"),
            std::string::npos);
  log::set_form(log::Form::text);
  log::release(1);
  log::set_level(log::Level::warning);
  EXPECT_EQ(said([] {
              log::gather();
              log::info("note");
              log::headline("device");
              log::warning("w");
              log::release(1);
            }),
            "warning: w\n");
  log::set_level(log::Level::info);
}

}  // namespace
}  // namespace candela
