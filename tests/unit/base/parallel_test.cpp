#include "base/parallel.h"

#include "patchlight/base/error.h"

#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <mutex>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

namespace patchlight::parallel_test {
namespace {

TEST(ParallelFor, CallsEveryIndexOnce) {
  std::vector<int> calls(10000, 0);
  parallel_for(calls.size(), [&](std::size_t k) { ++calls[k]; });
  EXPECT_EQ(calls, std::vector<int>(10000, 1));
}

TEST(ThreadLimit, HoldsWhileItLives) {
  const ThreadLimit limit(1);
  std::mutex writing;
  std::set<std::thread::id> threads;
  parallel_for(200, [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // long enough for another thread to start
    const std::scoped_lock lock(writing);
    threads.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(threads.size(), 1U);
}

TEST(ParallelFor, ReportsProgressUpToTheEnd) {
  double last = 0;
  const Observer observer = [&](const Progress& progress) {
    EXPECT_EQ(progress.stage, Stage::mesh);
    EXPECT_GE(progress.fraction, last);
    last = progress.fraction;
    return true;
  };
  parallel_for(100, Stage::mesh, observer, [](std::size_t) {});
  EXPECT_EQ(last, 1);
}

TEST(ParallelFor, StopsWhenTheObserverSaysSo) {
  std::atomic<int> calls{0};
  const Observer observer = [](const Progress&) { return false; };
  const auto body = [&](std::size_t) {
    ++calls;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  EXPECT_THROW(parallel_for(100000, Stage::solve, observer, body), Canceled);
  EXPECT_LT(calls, 100000);
}

}  // namespace
}  // namespace patchlight::parallel_test
