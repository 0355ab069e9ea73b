#pragma once

#include "patchlight/base/progress.h"

#include <pybind11/pybind11.h>

namespace patchlight {

/// During its lifetime Ctrl-C sets a flag that the observer checks: Python's own handler would wait for the end of the
/// work. Other Python threads continue meanwhile. Outside Python's main thread signals stay unchanged.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;

  /// During its lifetime Python handles signals itself: Ctrl-C raises KeyboardInterrupt in a Python function.
  class LeftToPython {
   public:
    explicit LeftToPython(const InterruptFlag& flag);
    ~LeftToPython();
    LeftToPython(const LeftToPython&) = delete;
    LeftToPython& operator=(const LeftToPython&) = delete;

   private:
    bool installed_;
  };

  /// Stops the work after Ctrl-C, and reports stage and fraction to `progress`, a function or None.
  static Observer observer(pybind11::object progress);

 private:
  bool installed_ = false;
  void (*before_)(int) = nullptr;
};

}  // namespace patchlight
