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
#include <utility>
#include <vector>

namespace patchlight::cli {

/// The display of progress: none, one updated line, or a new line every ten seconds.
enum class ProgressShown { nothing, line, log };

/// The updated line if stderr is a terminal, else the log.
ProgressShown progress_shown(bool quiet);

/// Estimates the finished share of a run from its stages. The share never falls.
class RunShare {
 public:
  /// The stages of the run, and the share of the first mesh in the work on all meshes. Initially no stages: no share of
  /// the run is known.
  void expect(std::vector<Stage> stages, double first_mesh);
  bool is_known() const { return !stages_.empty(); }
  /// The share after another report.
  double after(const Progress& progress);
  /// The next reports are those of another mesh. Meshes up to now were the share `done` of the work on all meshes, and
  /// with the next one it will be `next`.
  void next_mesh(double done, double next);
  /// The number of the mesh of a stage, from 1; 0 for stages that belong to the whole run.
  int mesh_of(Stage stage) const;

 private:
  double finished_part_of_stage(const Progress& progress);

  std::vector<Stage> stages_;
  int mesh_ = 1;
  bool meshes_are_done_ = false;
  double mesh_begin_ = 0, mesh_end_ = 1;  // of the work on all meshes
  std::optional<Stage> stage_;
  double pass_begin_ = 0, pass_end_ = 0, fraction_ = 0;  // a stage may run through its work more than once
  double share_ = 0;
};

/// Prints mesh, stage, share of the run and time left on stderr. An updated line is erased at the end.
class ProgressLine {
 public:
  explicit ProgressLine(ProgressShown shown) : shown_(shown) {}
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Sets the name of the work, printed first; initially empty.
  void name(std::string work);
  /// As RunShare::expect(), with the limit on the wall seconds of the run if it has one. Without this call only the
  /// share of each stage is printed, and no time left.
  void expect(std::vector<Stage> stages, double first_mesh = 1, std::optional<double> limit = {});
  /// The next reports are those of another mesh. The last one has the relative error `error`; `wanted` is the target.
  void next_mesh(double error, std::optional<double> wanted);
  void show(const Progress& progress) { show(progress, wall_seconds()); }
  /// `now` is in wall seconds.
  void show(const Progress& progress, double now);
  /// Erases the line before other output.
  void hide();

 private:
  std::string text_of(const Progress& progress, double now);
  double seconds_left(double share, double now);

  ProgressShown shown_;
  std::string work_;
  RunShare run_;
  std::optional<double> limit_;      // seconds
  std::optional<double> begin_;      // wall seconds, as the others
  std::optional<double> left_;       // seconds
  double left_at_ = 0;               // the time of left_
  std::optional<double> next_line_;  // of the log
  std::size_t width_ = 0;            // characters on the line
};

/// The finished share of the work on all meshes, once a mesh has the relative error `error` and `wanted` is the target:
/// the work grows as the power 1.5 of the accuracy. 1 without a target.
double share_of_meshes(double error, std::optional<double> wanted);

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
