#pragma once

#include "cli/arguments.h"
#include "cli/distinct_files.h"

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

namespace patchlight::cli {

/// The options of a lightmap while they are being parsed.
struct LightmapGiven {
  std::string folder;
  std::optional<double> texel;  ///< metres
};

/// Adds --lightmap and --texel. What is parsed lands in `given`, which must outlive the command.
void add_lightmap_options(CLI::App& command, LightmapGiven& given);

/// What they ask for. \throws UsageError for texels of no lightmap.
LightmapSettings lightmap_settings(const LightmapGiven& given);

/// \throws UsageError when an output lies in the folder of the lightmap, which is replaced as a whole.
void require_outside_lightmap(const LightmapSettings& settings, const std::vector<OutputFile>& outputs);

/// One line about a lightmap: size, texels, and why they are larger than was asked for, charts and the memory it took.
std::string lightmap_line(const Lightmap& map, const LightmapSettings& settings);

}  // namespace patchlight::cli
