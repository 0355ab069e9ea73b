#pragma once

#include "cli/exit_code.h"

namespace patchlight::cli {

/// From now on SIGINT, SIGTERM and SIGHUP, unless the caller ignores them, ask the run to stop: interrupted() becomes
/// true. A stage that does not ask in time is ended half a second later, which loses nothing as long as no result is
/// being written.
void watch_interrupts();

/// True once the run was asked to stop.
bool interrupted();

/// The exit code of a run that was stopped: 128 and the number of the last signal.
ExitCode interrupted_run();

/// From now on there is something to write: the first signal only asks the run to stop, however long that takes. A
/// second one ends it.
void keep_what_is_there();

/// Forgets such a first signal, so that the results so far can be written; the next one ends the run. False when the
/// run was asked to end.
bool may_write_what_is_there();

/// Results are being written while this lives: the file at hand is finished or removed before the run stops.
class WritingGuard {
 public:
  WritingGuard();
  ~WritingGuard();
  WritingGuard(const WritingGuard&) = delete;
  WritingGuard& operator=(const WritingGuard&) = delete;
};

}  // namespace patchlight::cli
