#pragma once

#include "cli/arguments.h"
#include "cli/distinct_files.h"
#include "cli/lightmap_options.h"
#include "cli/picture_options.h"

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

namespace patchlight::cli {

/// The options that say how the equations are solved and what is written, while they are being parsed.
struct SolutionOptions {
  bool solver_given = false;
  std::vector<std::string> results;
  std::string series, report, page, points;
  PictureGiven picture;
  LightmapGiven lightmap;
  std::vector<std::string> points_outputs;
  MapOptions map;
  std::optional<double> ambient_distance;
  std::string map_given;  // the option
  bool discards = false;
  bool quiet = false;
  bool verbose = false;
};

/// Adds -o, --series, --json, --html, --picture with its own, --lightmap, --texel, --points and --points-output. What
/// is parsed lands in `options`, which must outlive the command; so below.
void add_output_options(CLI::App& command, SolutionOptions& options);

/// Adds --no-closure, --solver, --relaxation, --tolerance, --max-iterations and --max-rows, which land in `request`.
void add_solver_options(CLI::App& command, SolutionOptions& options, Request& request);

/// Adds -q and -v.
void add_verbosity_options(CLI::App& command, SolutionOptions& options);

/// `arguments` with what these options ask for, once they hold the inputs and the request. `command`
/// is the one that is being parsed. \throws UsageError when options contradict each other, or files are the same.
SolveArguments with_solution(SolveArguments arguments, const std::string& command, const SolutionOptions& options);

/// What would be written, with the options that ask for it.
std::vector<OutputFile> outputs_of(const SolveArguments& arguments);

/// The files of the command line that are read.
std::vector<std::filesystem::path> given_files(const SolveArguments& arguments);

}  // namespace patchlight::cli
