#include "patchlight/base/parallel.h"

#include "patchlight/base/error.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <mutex>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

namespace patchlight {

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t index) { body(index); });
}

void parallel_for(std::size_t count, Stage stage, const Observer& observer,
                  const std::function<void(std::size_t)>& body) {
  if (!observer) return parallel_for(count, body);

  // Whichever thread finishes an item tells the observer, at most every tenth of a second and one at a time.
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
  tbb::parallel_for(
      std::size_t{0}, count,
      [&](std::size_t index) {
        if (stopped) return;
        body(index);
        ++done;
        if (wall_seconds() >= next_report) report();
      },
      tbb::simple_partitioner());
  if (stopped || !observer({.stage = stage, .fraction = 1})) throw Cancelled();
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
