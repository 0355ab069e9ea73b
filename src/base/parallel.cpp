#include "base/parallel.h"

#include "patchlight/base/error.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <mutex>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#if defined(__SANITIZE_THREAD__)
#include <exception>
#include <thread>
#include <vector>
#endif

namespace patchlight {
namespace {

#if defined(__SANITIZE_THREAD__)
// TBB is not compiled for the thread sanitizer, which does not see its synchronization. Here plain threads take the
// items one by one, without other synchronization.
void for_each_item(std::size_t count, const auto& body, const auto&... /*partitioner*/) {
  constexpr std::size_t most_threads = 4;
  std::atomic<std::size_t> next{0};
  std::mutex failing;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t index = next++; index < count; index = next++) {
      try {
        body(index);
      } catch (...) {
        const std::scoped_lock lock(failing);
        failure = std::current_exception();
      }
    }
  };
  std::vector<std::thread> threads;
  while (threads.size() < std::min(count, most_threads)) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}
#else
void for_each_item(std::size_t count, const auto& body, const auto&... partitioner) {
  tbb::parallel_for(
      std::size_t{0}, count, [&](std::size_t index) { body(index); }, partitioner...);
}
#endif

}  // namespace

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) { for_each_item(count, body); }

void parallel_for(std::size_t count, Stage stage, const Observer& observer,
                  const std::function<void(std::size_t)>& body) {
  if (!observer) return parallel_for(count, body);

  // The thread that finishes an item calls the observer, at most every tenth of a second and one thread at a time.
  constexpr double interval = 0.1;
  std::atomic<std::size_t> done{0};
  std::atomic<bool> stopped{false};
  std::atomic<double> next_report{wall_seconds()};
  std::mutex reporting;
  const auto report = [&] {
    const std::unique_lock lock(reporting, std::try_to_lock);
    if (!lock || wall_seconds() < next_report) return;
    if (!observer({.stage = stage, .fraction = static_cast<double>(done) / static_cast<double>(count)})) stopped = true;
    next_report = wall_seconds() + interval;
  };
  const auto observed = [&](std::size_t index) {
    if (stopped) return;
    body(index);
    ++done;
    if (wall_seconds() >= next_report) report();
  };
  for_each_item(count, observed, tbb::simple_partitioner());
  if (stopped || !observer({.stage = stage, .fraction = 1})) throw Canceled();
}

// Built in place: a copy of a global_control would end the limit of its original.
struct ThreadLimit::Limit {
  explicit Limit(std::size_t threads) : control(tbb::global_control::max_allowed_parallelism, threads) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : limit_(
          std::make_unique<Limit>(static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()))) {
}

ThreadLimit::~ThreadLimit() = default;

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace patchlight
