#include "python/interrupt_flag.h"

#include <atomic>
#include <csignal>
#include <memory>
#include <utility>

namespace patchlight {
namespace {

std::atomic<bool> asked_to_stop{false};

void ask_to_stop(int) { asked_to_stop = true; }

bool is_main_thread() {
  const auto threading = pybind11::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

}  // namespace

InterruptFlag::InterruptFlag() {
  if (!is_main_thread()) return;
  asked_to_stop = false;
  before_ = std::signal(SIGINT, ask_to_stop);
  installed_ = true;
}

InterruptFlag::~InterruptFlag() {
  if (installed_) std::signal(SIGINT, before_);
}

// An earlier Ctrl-C stops the work after the function returns.
InterruptFlag::LeftToPython::LeftToPython(const InterruptFlag& flag) : installed_(flag.installed_) {
  if (installed_) std::signal(SIGINT, flag.before_);
}

InterruptFlag::LeftToPython::~LeftToPython() {
  if (installed_) std::signal(SIGINT, ask_to_stop);
}

Observer InterruptFlag::observer(pybind11::object progress) {
  if (progress.is_none()) return [](const Progress&) { return !asked_to_stop; };
  // The function is released with the GIL held, in any thread.
  const std::shared_ptr<pybind11::object> kept(new pybind11::object(std::move(progress)),
                                               [](pybind11::object* function) {
                                                 const pybind11::gil_scoped_acquire lock;
                                                 delete function;
                                               });
  return [kept](const Progress& now) {
    const pybind11::gil_scoped_acquire lock;
    (*kept)(name_of(now.stage), now.fraction);
    return !asked_to_stop;
  };
}

}  // namespace patchlight
