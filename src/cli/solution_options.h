#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

namespace patchlight::cli {

/// The options that say how the equations are solved and what is written, while they are being parsed.
struct SolutionOptions {
  Request request;  ///< solver, tolerance, iterations, closure
  bool solver_given = false;
  std::vector<std::string> results;
  std::string series, report, picture, points, view;
  std::vector<std::string> points_outputs;
  std::optional<Vector> up;
  std::optional<Camera> camera;  ///< model units
  std::optional<PictureColors> colors;
  bool quiet = false;
  bool verbose = false;
};

/// Adds --up. What is parsed lands in `options`, which must outlive the command; so below.
void add_up_option(CLI::App& command, SolutionOptions& options);

/// Adds -o, --series, --report, --picture, --false-color, --camera, --view, --points and --points-output.
void add_output_options(CLI::App& command, SolutionOptions& options);

/// Adds --no-closure, --solver, --relaxation, --tolerance, --max-iterations and --max-rows.
void add_solver_options(CLI::App& command, SolutionOptions& options);

/// Adds -q and -v.
void add_verbosity_options(CLI::App& command, SolutionOptions& options);

/// `arguments` with what these options ask for, once they hold the inputs and the request for form factors. `command`
/// is the one that is being parsed. \throws UsageError when options contradict each other, or files are the same.
SolveArguments with_solution(SolveArguments arguments, const std::string& command, const SolutionOptions& options);

}  // namespace patchlight::cli
