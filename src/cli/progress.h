#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/input/read_scene.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace patchlight::cli {

/// One line on stderr that is rewritten while the work goes on: stage, percent, time left. Erased at the end.
class ProgressLine {
 public:
  /// An invisible line shows nothing.
  explicit ProgressLine(bool visible) : visible_(visible) {}
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// What is at work, before stage, percent and time left; nothing at first.
  void name(std::string work);
  void show(const Progress& progress);
  /// Erases the line, so that something else can be printed.
  void hide();

 private:
  bool visible_;
  std::string work_;
  std::optional<Stage> stage_;
  double stage_begin_ = 0;  // wall seconds
  std::size_t width_ = 0;   // characters on the line
};

/// True when stderr is a terminal.
bool stderr_is_terminal();

/// Shows progress on the line, which must outlive it, and lets the work go on until the run is interrupted.
Observer observer_on(ProgressLine& line);

/// Reads what a sub-command is given. \throws Cancelled when the run was interrupted before; else as read_scene().
Scene read_models(std::span<const std::filesystem::path> models, const ReadOptions& options, const Observer& observer);

}  // namespace patchlight::cli
