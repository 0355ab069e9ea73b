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

/// The display of progress: none, one updated line, or a new line every ten seconds.
enum class ProgressShown { nothing, line, log };

/// The updated line if stderr is a terminal, else the log.
ProgressShown progress_shown(bool quiet);

/// Prints stage, percentage and time left on stderr. An updated line is erased at the end.
class ProgressLine {
 public:
  explicit ProgressLine(ProgressShown shown) : shown_(shown) {}
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Sets the name of the work, printed first; initially empty.
  void name(std::string work);
  void show(const Progress& progress) { show(progress, wall_seconds()); }
  /// `now` is in wall seconds.
  void show(const Progress& progress, double now);
  /// Erases the line before other output.
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

/// Shows progress on the line, which must outlive the observer, and continues until the run is interrupted.
Observer observer_on(ProgressLine& line);

/// Reads the models of a command. \throws `Canceled` after an interrupt; else as read_scene().
Scene read_models(std::span<const std::filesystem::path> models, const ReadOptions& options, const Observer& observer);

/// Starts to handle SIGINT, SIGTERM and SIGHUP, unless the caller ignores them: interrupted() becomes true. If the
/// current stage does not check it within half a second, the program exits. No result is lost while none is being
/// written.
void watch_interrupts();

/// True after a signal to stop.
bool interrupted();

/// The exit code of an interrupted run: 128 plus the number of the last signal.
ExitCode interrupted_run();

/// From now on the first signal only requests a stop, without a time limit, because there are results to write. A
/// second signal exits.
void keep_what_is_there();

/// Resets the first signal, so that the results so far can be written; the next signal exits. Returns false if the run
/// must end now.
bool may_write_what_is_there();

/// Protects the writing of results: the current file is finished or removed before the run stops.
class WritingGuard {
 public:
  WritingGuard();
  ~WritingGuard();
  WritingGuard(const WritingGuard&) = delete;
  WritingGuard& operator=(const WritingGuard&) = delete;
};

}  // namespace patchlight::cli
