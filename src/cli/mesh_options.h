#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <optional>

namespace patchlight::cli {

/// The options that say how a model is cut into patches and how form factors are sampled, while they are being parsed.
struct MeshOptions {
  Request request;
  std::optional<double> max_edge;  ///< model units
};

/// Adds --sides. What is parsed lands in `options`, which must outlive the command; so below.
void add_sides_option(CLI::App& command, MeshOptions& options);

/// What --sides is given. \throws UsageError when it is none of its words.
Sides sides_named(const std::string& text);

/// Adds --max-edge and --patches.
void add_patch_options(CLI::App& command, MeshOptions& options);

/// Adds --no-closure and --relaxation.
void add_equation_options(CLI::App& command, Request& request);

/// Adds --samples, --estimator and --seed.
void add_sampling_options(CLI::App& command, MeshOptions& options);

/// Adds --threads and --memory.
void add_machine_options(CLI::App& command, Request& request);

/// The request in metres. \throws UsageError when options contradict each other.
Request mesh_request(const MeshOptions& options, double metres_per_unit);

}  // namespace patchlight::cli
