#pragma once

#include "patchlight/base/progress.h"

#include <pybind11/pybind11.h>

namespace patchlight {

/// While it lives Ctrl-C sets a flag, which its observer sees: Python's own handler would wait for the end of the work,
/// during which other threads of Python go on. In threads other than Python's main one signals stay as they are.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;

  /// While it lives signals are Python's own again: a function of Python's that runs meanwhile ends by
  /// KeyboardInterrupt.
  class LeftToPython {
   public:
    explicit LeftToPython(const InterruptFlag& flag);
    ~LeftToPython();
    LeftToPython(const LeftToPython&) = delete;
    LeftToPython& operator=(const LeftToPython&) = delete;

   private:
    bool installed_;
  };

  /// Stops the work after Ctrl-C, and reports to `progress`, a function of stage and share or None.
  static Observer observer(pybind11::object progress);

 private:
  bool installed_ = false;
  void (*before_)(int) = nullptr;
};

}  // namespace patchlight
