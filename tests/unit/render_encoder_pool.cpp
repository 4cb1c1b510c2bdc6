#include "render/encoder_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

namespace candela {
namespace {

constexpr uint64_t plenty = uint64_t(1) << 40;

EncoderLimits limits(size_t workers, size_t frames = 0, uint64_t bytes = plenty) {
  return {.workers = workers, .frames = frames ? frames : workers + 2, .bytes = bytes};
}

FinishedFrame frame_of(int64_t number) {
  FinishedFrame frame;
  frame.number = number;
  return frame;
}

// Work of unequal length, so that frames overtake each other.
void work(int64_t number) { std::this_thread::sleep_for(std::chrono::microseconds((number * 7919 % 13) * 100)); }

// Whoever lets go of a frame is counted.
class Counter : public gpu::Readback {
 public:
  explicit Counter(std::atomic<int>& alive) : alive_(alive) { ++alive_; }
  ~Counter() override { --alive_; }
  std::span<const std::byte> bytes() const override { return {}; }

 private:
  std::atomic<int>& alive_;
};

}  // namespace

TEST(EncoderPool, FramesAreCompletedInOrderOneAtATime) {
  for (const size_t workers : {1u, 2u, 8u}) {
    std::vector<int64_t> completed;
    std::atomic<int> inside = 0, together = 0, most_together = 0;
    std::vector<std::atomic<int>> by_worker(workers);
    EncoderPool pool(limits(workers), [&](FinishedFrame& frame, size_t worker) -> Expected<EncoderPool::Complete> {
      EXPECT_LT(worker, workers);
      ++by_worker[worker];
      const int now = ++together;
      for (int most = most_together; most < now && !most_together.compare_exchange_weak(most, now);) {
      }
      work(frame.number);
      --together;
      return [&, number = frame.number]() -> Expected<void> {
        EXPECT_EQ(++inside, 1);
        completed.push_back(number);
        --inside;
        return {};
      };
    });
    std::vector<int64_t> pushed;
    for (int64_t number = 0; number < 200; ++number) {
      pushed.push_back(2 * number + 5);
      ASSERT_TRUE(pool.push(frame_of(pushed.back()), 1));
    }
    ASSERT_TRUE(pool.finish());
    EXPECT_EQ(completed, pushed) << workers;
    EXPECT_LE(most_together, int(workers));
    EXPECT_GE(most_together, workers > 1 ? 2 : 1) << "the workers stood in line";
  }
}

// The frames that are there, whoever holds them, counted by what they hold.
TEST(EncoderPool, FramesInMemoryAreBounded) {
  struct Case {
    EncoderLimits limits;
    uint64_t bytes;
    size_t most;
  };
  for (const Case& c : {Case{limits(1, 1), 1, 1}, Case{limits(2, 4), 1, 4}, Case{limits(8, 10), 1, 10},
                        Case{limits(8, 10, 100), 30, 3}, Case{limits(8, 10, 100), 1000, 1}}) {
    std::atomic<int> alive = 0;
    int most_alive = 0;
    std::atomic<size_t> pushed = 0;
    EncoderPool pool(c.limits, [&](FinishedFrame& frame, size_t) -> Expected<EncoderPool::Complete> {
      // The first takes until all that have room are there, and a while longer.
      while (frame.number == 0 && pushed < c.most) std::this_thread::yield();
      work(frame.number + 1);
      // Until it is complete, as a picture for a film is.
      return [held = std::move(frame.frame.readbacks)]() -> Expected<void> { return {}; };
    });
    for (int64_t number = 0; number < 100; ++number) {
      FinishedFrame frame = frame_of(number);
      frame.frame.readbacks[0] = std::make_shared<Counter>(alive);
      ASSERT_TRUE(pool.push(std::move(frame), c.bytes));
      ++pushed;
      most_alive = std::max(most_alive, alive.load());
    }
    ASSERT_TRUE(pool.finish());
    EXPECT_EQ(pool.most_frames(), c.most);
    EXPECT_LE(most_alive, int(c.most));
    EXPECT_EQ(alive, 0);
  }
}

// Whichever worker fails first: the first frame that fails is told, all before it are complete, none after it is.
TEST(EncoderPool, TheFirstFrameThatFailsEndsIt) {
  const auto failing = [](int64_t number) { return fail(ErrorKind::output, "disk", "frame {} is full", number); };
  enum class Where { encode, complete };
  for (const Where where : {Where::encode, Where::complete})
    for (const size_t workers : {1u, 2u, 8u})
      for (int round = 0; round < 20; ++round) {
        const int64_t first = 11;
        std::vector<int64_t> completed;
        EncoderPool pool(limits(workers), [&](FinishedFrame& frame, size_t) -> Expected<EncoderPool::Complete> {
          const int64_t number = frame.number;
          if (number == first) std::this_thread::sleep_for(std::chrono::microseconds(500 * (round % 3)));
          if (where == Where::encode && number >= first) return failing(number);  // the later ones sooner
          work(number + round);
          return [&, number]() -> Expected<void> {
            if (number >= first) return failing(number);
            completed.push_back(number);
            return {};
          };
        });
        int64_t number = 0;
        while (number < 1000 && pool.push(frame_of(number), 1)) ++number;
        EXPECT_LT(number, first + 2 * int64_t(workers) + 4);
        const auto result = pool.finish();
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().message, "frame 11 is full");
        EXPECT_EQ(pool.failed_frame(), first);
        ASSERT_EQ(completed.size(), size_t(first));
        EXPECT_TRUE(std::is_sorted(completed.begin(), completed.end()));
      }
}

TEST(EncoderPool, AnExceptionEndsItAndItsFrameIsKnown) {
  for (const bool late : {false, true})
    for (const size_t workers : {1u, 8u}) {
      std::atomic<int> completed = 0;
      EncoderPool pool(limits(workers), [&](FinishedFrame& frame, size_t) -> Expected<EncoderPool::Complete> {
        const bool throws = frame.number == 7;
        if (throws && !late) throw std::bad_alloc();
        return [&, throws]() -> Expected<void> {
          if (throws) throw std::bad_alloc();
          ++completed;
          return {};
        };
      });
      int64_t number = 0;
      while (number < 1000 && pool.push(frame_of(number), 1)) ++number;
      EXPECT_LT(number, 1000);
      EXPECT_THROW((void)pool.finish(), std::bad_alloc);
      EXPECT_EQ(pool.failed_frame(), 7);
      EXPECT_EQ(completed, 7);
    }
}

TEST(EncoderPool, WhatWaitsIsDroppedWithoutFinish) {
  std::atomic<int> alive = 0, completed = 0;
  {
    EncoderPool pool(limits(1, 10), [&](FinishedFrame&, size_t) -> Expected<EncoderPool::Complete> {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      return [&]() -> Expected<void> {
        ++completed;
        return {};
      };
    });
    for (int64_t number = 0; number < 8; ++number) {
      FinishedFrame frame = frame_of(number);
      frame.frame.readbacks[0] = std::make_shared<Counter>(alive);
      ASSERT_TRUE(pool.push(std::move(frame), 1));
    }
  }
  EXPECT_LT(completed, 8);
  EXPECT_EQ(alive, 0);
}

TEST(EncoderPool, LimitsFollowTheWorkers) {
  for (const int workers : {1, 2, 16}) {
    const EncoderLimits limits = encoder_limits(workers);
    EXPECT_EQ(limits.workers, size_t(workers));
    EXPECT_EQ(limits.frames, size_t(workers) + 2);
    EXPECT_GT(limits.bytes, 0u);
    EXPECT_LE(limits.bytes, uint64_t(4) << 30);
  }
  EXPECT_GE(encoder_limits(0).workers, 1u);
}

}  // namespace candela
