#include "cli/progress.h"

#include "patchlight/base/error.h"

#include "cli/option_names.h"

#include <algorithm>
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

std::string percent_of(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

// The typical work of a stage, in percent of a run with all stages of one mesh.
double weight_of(Stage stage) {
  if (stage == Stage::trace_paths || stage == Stage::render) return 60;
  if (stage == Stage::error_bars) return 50;
  if (stage == Stage::form_factors) return 25;
  if (stage == Stage::gather) return 10;
  return stage == Stage::direct_light || stage == Stage::solve ? 5 : 1;
}

bool is_of_mesh(Stage stage) { return stage >= Stage::mesh && stage <= Stage::error_bars; }

}  // namespace

void RunShare::expect(std::vector<Stage> stages, double first_mesh) {
  stages_ = std::move(stages);
  mesh_end_ = first_mesh;
}

double RunShare::finished_part_of_stage(const Progress& progress) {
  if (stage_ != progress.stage) {
    stage_ = progress.stage;
    pass_begin_ = 0;
    pass_end_ = progress.stage < Stage::trace_paths ? 0.6 : 1;
  } else if (progress.fraction < fraction_) {  // another pass, whose work is assumed to be most of the rest
    pass_begin_ = pass_end_;
    pass_end_ += 0.6 * (1 - pass_end_);
  }
  fraction_ = progress.fraction;
  return pass_begin_ + progress.fraction * (pass_end_ - pass_begin_);
}

double RunShare::after(const Progress& progress) {
  const double part = finished_part_of_stage(progress);
  if (progress.stage > Stage::error_bars) meshes_are_done_ = true;
  double of_run = 0, before = 0, meshes = 0, in_meshes = 0;  // weights
  for (const Stage stage : stages_) {
    const double weight = weight_of(stage);
    const double finished = stage < progress.stage ? weight : stage == progress.stage ? part * weight : 0;
    of_run += weight;
    if (is_of_mesh(stage)) {
      meshes += weight;
      in_meshes += finished;
    } else {
      before += finished;
    }
  }
  if (of_run == 0) return share_;
  const double in_mesh = meshes > 0 ? in_meshes / meshes : 0;
  const double of_meshes = meshes_are_done_ ? 1 : mesh_begin_ + in_mesh * (mesh_end_ - mesh_begin_);
  share_ = std::max(share_, (before + of_meshes * meshes) / of_run);
  return share_;
}

void RunShare::next_mesh(double done, double next) {
  ++mesh_;
  mesh_begin_ = std::max(mesh_begin_, done);
  mesh_end_ = std::max(mesh_begin_, next);
  stage_.reset();
}

int RunShare::mesh_of(Stage stage) const { return is_known() && !meshes_are_done_ && is_of_mesh(stage) ? mesh_ : 0; }

double share_of_meshes(double error, std::optional<double> wanted) {
  if (!wanted || !(error > *wanted)) return 1;
  return std::pow(*wanted / error, 1.5);
}

ProgressLine::~ProgressLine() { hide(); }

void ProgressLine::hide() {
  if (width_ > 0) std::cerr << '\r' << std::string(width_, ' ') << '\r' << std::flush;
  width_ = 0;
}

void ProgressLine::name(std::string work) { work_ = std::move(work); }

void ProgressLine::expect(std::vector<Stage> stages, double first_mesh, std::optional<double> limit) {
  run_.expect(std::move(stages), first_mesh);
  limit_ = limit;
}

// The time left follows slowly from the share, so that a wrong weight does not make it jump.
double ProgressLine::seconds_left(double share, double now) {
  const double expected = (now - *begin_) * (1 - share) / share;
  if (left_) {
    const double passed = now - left_at_;
    const double planned = std::max(0.0, *left_ - passed);
    left_ = planned + (expected - planned) * -std::expm1(-passed / std::clamp((now - *begin_) / 4, 2.0, 20.0));
  } else {
    left_ = expected;
  }
  left_at_ = now;
  return *left_;
}

std::string ProgressLine::text_of(const Progress& progress, double now) {
  if (!begin_) begin_ = now;
  double share = run_.after(progress);
  const int mesh = run_.mesh_of(progress.stage);
  std::string text = work_ + (mesh > 0 ? "mesh " + std::to_string(mesh) + ": " : "") + name_of(progress.stage);
  if (!run_.is_known()) return text + ", " + percent_of(progress.fraction) + " of this stage";
  if (limit_) share = std::max(share, std::min((now - *begin_) / *limit_, 0.99));
  text += ", " + percent_of(share) + " of the run";
  // The first estimates are not reliable.
  if (now - *begin_ > 2 && share > 0.03 && share < 1) text += ", " + duration(seconds_left(share, now)) + " left";
  return text;
}

void ProgressLine::next_mesh(double error, std::optional<double> wanted) {
  run_.next_mesh(share_of_meshes(error, wanted), share_of_meshes(error / 2, wanted));
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
  Scene scene = with_option_names(read_scene(models, options));
  print_scene_warnings(scene);
  return scene;
}

}  // namespace patchlight::cli
