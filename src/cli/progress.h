#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/input/read_scene.h"

#include "base/parallel.h"
#include "cli/messages.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace patchlight::cli {

/// How progress is shown: not at all, in one line that is rewritten, or, where that cannot be, in a line every ten
/// seconds.
enum class ProgressShown { nothing, line, log };

/// The line where stderr is a terminal, else the log.
ProgressShown progress_shown(bool quiet);

/// Stage, percent and time left on stderr while the work goes on. A line that is rewritten is erased at the end.
class ProgressLine {
 public:
  explicit ProgressLine(ProgressShown shown) : shown_(shown) {}
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// The name of the work, before stage, percent and time left; empty at first.
  void name(std::string work);
  void show(const Progress& progress) { show(progress, wall_seconds()); }
  /// At this time, in wall seconds.
  void show(const Progress& progress, double now);
  /// Erases the line, so that something else can be printed.
  void hide();

 private:
  std::string text_of(const Progress& progress, double now);

  ProgressShown shown_;
  std::string work_;
  std::optional<Stage> stage_;
  double stage_begin_ = 0;           // wall seconds
  std::optional<double> next_line_;  // of the log, wall seconds
  std::size_t width_ = 0;            // characters on the line
};

/// Shows progress on the line, which must outlive it, and lets the work go on until the run is interrupted.
Observer observer_on(ProgressLine& line);

/// Reads the models of a command. \throws Cancelled when the run was interrupted before; else as read_scene().
Scene read_models(std::span<const std::filesystem::path> models, const ReadOptions& options, const Observer& observer);

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
