#include "cli/progress.h"

#include "patchlight/base/error.h"

#include <cmath>
#include <iostream>
#include <unistd.h>
#include <utility>

namespace patchlight::cli {
namespace {

std::string duration(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return std::to_string(whole) + " s";
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole / 60 % 60) + " min";
}

}  // namespace

ProgressLine::~ProgressLine() { hide(); }

void ProgressLine::hide() {
  if (width_ > 0) std::cerr << '\r' << std::string(width_, ' ') << '\r' << std::flush;
  width_ = 0;
}

void ProgressLine::name(std::string work) {
  work_ = std::move(work);
  stage_.reset();
}

std::string ProgressLine::text_of(const Progress& progress, double now) {
  if (stage_ != progress.stage) {
    stage_ = progress.stage;
    stage_begin_ = now;
  }
  std::string text =
      work_ + name_of(progress.stage) + ' ' + std::to_string(std::lround(100 * progress.fraction)) + " %";
  // The time left is extrapolated; early estimates fluctuate.
  const double taken = now - stage_begin_;
  if (taken > 1 && progress.fraction > 0.02 && progress.fraction < 1) {
    text += ", " + duration(taken * (1 - progress.fraction) / progress.fraction) + " left";
  }
  return text;
}

void ProgressLine::show(const Progress& progress, double now) {
  if (shown_ == ProgressShown::nothing) return;
  std::string text = text_of(progress, now);
  if (shown_ == ProgressShown::log) {
    if (!next_line_) next_line_ = now + 10;
    if (now < *next_line_) return;
    next_line_ = now + 10;
    std::cerr << "patchlight: " << text << std::endl;
    return;
  }
  const std::size_t length = text.size();
  if (length < width_) text.append(width_ - length, ' ');  // overwrites the rest of a longer line
  width_ = length;
  std::cerr << '\r' << text << std::flush;
}

ProgressShown progress_shown(bool quiet) {
  if (quiet) return ProgressShown::nothing;
  return isatty(STDERR_FILENO) == 1 ? ProgressShown::line : ProgressShown::log;
}

Observer observer_on(ProgressLine& line) {
  return [&line](const Progress& progress) {
    line.show(progress);
    return !interrupted();
  };
}

Scene read_models(std::span<const std::filesystem::path> models, const ReadOptions& options, const Observer& observer) {
  if (!observer({.stage = Stage::read})) throw Canceled();
  Scene scene = read_scene(models, options);
  print_scene_warnings(scene);
  return scene;
}

}  // namespace patchlight::cli
