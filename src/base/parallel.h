#pragma once

#include "patchlight/base/progress.h"

#include <cstddef>
#include <functional>
#include <memory>

namespace patchlight {

/// Calls body(index) for every index in [0, count), spread over the threads. Each call must write to its own place
/// only: then the result does not depend on the number of threads.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// The same in a stage whose progress is observed.
/// \throws Canceled when the observer returns false; calls already begun are finished first.
void parallel_for(std::size_t count, Stage stage, const Observer& observer,
                  const std::function<void(std::size_t)>& body);

/// Limits the threads of parallel_for and of Embree while it lives.
class ThreadLimit {
 public:
  /// 0 means all processors.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Limit;
  std::unique_ptr<Limit> limit_;
};

/// Processor seconds used by this process so far, all threads.
double cpu_seconds();

/// Wall-clock seconds since an arbitrary origin.
double wall_seconds();

}  // namespace patchlight
