#pragma once

#include "cli/arguments.h"

#include <CLI/App.hpp>
#include <optional>

namespace patchlight::cli {

/// A request while it is being parsed: lengths are in model units, unless they have a unit of their own.
struct RequestGiven : Request {
  bool max_edge_in_metres = false;
};

/// Adds --sides. What is parsed lands in `request`, which must outlive the command; so below.
void add_sides_option(CLI::App& command, Request& request);

/// What --sides is given. \throws UsageError when it is none of its words.
Sides sides_named(const std::string& text);

/// Adds --max-edge and --patches.
void add_patch_options(CLI::App& command, RequestGiven& request);

/// --graded-edges: not where meshes are halved from one to the next.
void add_graded_option(CLI::App& command, Request& request);

/// Adds --no-closure.
void add_closure_option(CLI::App& command, Request& request);

/// Adds --relaxation, which lands in `relaxation`.
void add_relaxation_option(CLI::App& command, std::optional<double>& relaxation);

/// Adds --samples, --estimator and --seed.
void add_sampling_options(CLI::App& command, Request& request);

/// Adds --threads and --memory.
void add_machine_options(CLI::App& command, Request& request);

/// The request that has been parsed, in metres.
Request in_metres(const RequestGiven& given, double metres_per_unit);

}  // namespace patchlight::cli
