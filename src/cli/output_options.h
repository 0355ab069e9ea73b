#pragma once

#include "cli/arguments.h"
#include "cli/distinct_files.h"

#include <CLI/App.hpp>
#include <array>
#include <optional>
#include <string>
#include <vector>

// Options for results. The target variables must outlive the command.
namespace patchlight::cli {

/// The smallest and the largest value of --picture-samples.
inline constexpr int least_picture_samples = 4, most_picture_samples = 4096;

/// An example of --camera for messages.
inline constexpr const char* camera_example = "--camera 4,-3,1.6 0,0,1 60";

/// The options of an image, during parsing.
struct PictureGiven {
  std::string file;
  std::filesystem::path error_map;
  std::vector<std::string> views;
  std::optional<Camera> camera;  ///< model units
  std::optional<Projection> projection;
  std::optional<PictureColors> colors;
  std::optional<double> brightest;
  std::optional<Exposure> exposure;
  std::optional<PictureQuality> quality;
  std::optional<std::array<int, 2>> size;
  std::optional<double> error;
  std::optional<int> most_samples;
  bool for_observers = false;  ///< observers need a camera even without an image
};

/// Adds all image options.
void add_picture_options(CLI::App& command, PictureGiven& given);

/// Adds only --camera, --projection, --view and --size.
void add_view_options(CLI::App& command, PictureGiven& given);

/// The requested image; `file_option` names its file. `usual` is the default quality. \throws UsageError for
/// contradictory options.
PictureSettings picture_settings(const PictureGiven& given, const std::string& file_option, PictureQuality usual);

/// One image for each view. Several images have the view in their file names, "room.desk.png" for "room.png".
std::vector<PictureSettings> single_pictures(const PictureSettings& settings);

/// The files of images, with their options.
std::vector<OutputFile> picture_files(const PictureSettings& settings, const std::string& file_option);

/// Adds --lightmap and --texel.
void add_lightmap_options(CLI::App& command, LightmapSettings& settings);

/// \throws UsageError for --texel without a lightmap.
void require_lightmap(const LightmapSettings& settings);

/// \throws UsageError when an output lies in the lightmap folder, which is replaced as a whole.
void require_outside_lightmap(const LightmapSettings& settings, const std::vector<OutputFile>& outputs);

/// One line about a lightmap: size, texels, the reason if they are larger than requested, charts and memory.
std::string lightmap_line(const Lightmap& map, const LightmapSettings& settings);

/// Adds an option with a file whose name has this ending, e.g. ".json".
void add_ending(CLI::App& command, const std::string& name, std::filesystem::path& file, const std::string& ending);

/// Adds --json with one file (.json).
void add_json_option(CLI::App& command, std::filesystem::path& json);

/// Adds --html with one file.
void add_page_option(CLI::App& command, std::filesystem::path& page);

/// \throws UsageError when the page lies in the folder that the command replaces as a whole.
void require_page_elsewhere(const std::filesystem::path& page, const std::filesystem::path& folder);

/// The options of solver and outputs, during parsing.
struct SolutionOptions {
  SolveArguments arguments;  ///< without results, image and sensor outputs
  std::vector<std::string> results, points_outputs;
  PictureGiven picture;
  std::string map_given;  ///< its option
};

/// Adds the options of all results, pictures and sensors.
void add_output_options(CLI::App& command, SolutionOptions& options);

/// Adds the options of closure and solver.
void add_solver_options(CLI::App& command, SolveArguments& arguments);

/// Adds --discard, -q and -v.
void add_verbosity_options(CLI::App& command, SolveArguments& arguments);

/// The arguments with the requested results, after inputs and request are set. `command` is the parsed command.
/// \throws UsageError for contradictory options or identical files.
SolveArguments with_solution(const SolutionOptions& options, const std::string& command);

/// The output files, each with its option.
std::vector<OutputFile> outputs_of(const CheckArguments& arguments);
std::vector<OutputFile> outputs_of(const SolveArguments& arguments);

/// The input files of the command line.
std::vector<std::filesystem::path> given_files(const SolveArguments& arguments);

}  // namespace patchlight::cli
