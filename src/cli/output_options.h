#pragma once

#include "cli/arguments.h"
#include "cli/distinct_files.h"

#include <CLI/App.hpp>
#include <array>
#include <optional>
#include <string>
#include <vector>

// The options that name results. The values land in structures that must outlive the command.
namespace patchlight::cli {

/// The smallest and the largest value of --picture-samples.
inline constexpr int least_picture_samples = 4, most_picture_samples = 4096;

/// An example of --camera for messages.
inline constexpr const char* camera_example = "--camera 4,-3,1.6 0,0,1 60";

/// The options of a picture while they are being parsed.
struct PictureGiven {
  std::string file, error_map;
  std::vector<std::string> views;
  std::optional<Camera> camera;  ///< model units
  std::optional<Projection> projection;
  std::optional<PictureColors> colors;
  std::optional<PictureQuality> quality;
  std::optional<std::array<int, 2>> size;
  std::optional<double> error;
  std::optional<int> most_samples;
  bool for_observers = false;  ///< where the eye is, is asked for without a picture too
};

/// Adds all options of pictures; a quality that is not given is `usual`.
void add_picture_options(CLI::App& command, PictureGiven& given);

/// Adds --camera, --projection, --view and --size of these alone.
void add_view_options(CLI::App& command, PictureGiven& given);

/// The picture that is asked for; `file_option` is the one that names it. \throws UsageError when options contradict
/// each other.
PictureSettings picture_settings(const PictureGiven& given, const std::string& file_option, PictureQuality usual);

/// One picture for each view: of several, each with its view in its files' names, "room.desk.png" for "room.png".
std::vector<PictureSettings> single_pictures(const PictureSettings& settings);

/// The files of pictures, with the options that ask for them.
std::vector<OutputFile> picture_files(const PictureSettings& settings, const std::string& file_option);

/// Adds --lightmap and --texel.
void add_lightmap_options(CLI::App& command, LightmapSettings& settings);

/// \throws UsageError for texels of no lightmap.
void require_lightmap(const LightmapSettings& settings);

/// \throws UsageError when an output lies in the folder of the lightmap, which is replaced as a whole.
void require_outside_lightmap(const LightmapSettings& settings, const std::vector<OutputFile>& outputs);

/// One line about a lightmap: size, texels, and why they are larger than was asked for, charts and the memory it took.
std::string lightmap_line(const Lightmap& map, const LightmapSettings& settings);

/// Adds --json with one file (.json).
void add_json_option(CLI::App& command, std::filesystem::path& json);

/// Adds --html with one file.
void add_page_option(CLI::App& command, std::filesystem::path& page);

/// \throws UsageError when the page would lie in the folder that the command replaces as a whole.
void require_page_elsewhere(const std::filesystem::path& page, const std::filesystem::path& folder);

/// The options of the solver and the outputs, while they are being parsed.
struct SolutionOptions {
  SolveArguments arguments;  ///< but for the results, the picture and the outputs of sensors
  std::vector<std::string> results, points_outputs;
  PictureGiven picture;
  std::string map_given;  ///< the option
};

/// Adds the options of all results, pictures and sensors.
void add_output_options(CLI::App& command, SolutionOptions& options);

/// Adds the options of closure and solver.
void add_solver_options(CLI::App& command, SolveArguments& arguments);

/// Adds --discard, -q and -v.
void add_verbosity_options(CLI::App& command, SolveArguments& arguments);

/// The arguments with the results that these options ask for, once they hold the inputs and the request. `command` is
/// the one that is being parsed. \throws UsageError when options contradict each other, or files are the same.
SolveArguments with_solution(const SolutionOptions& options, const std::string& command);

/// The files that would be written, each with its option.
std::vector<OutputFile> outputs_of(const CheckArguments& arguments);
std::vector<OutputFile> outputs_of(const SolveArguments& arguments);

/// The files of the command line that are read.
std::vector<std::filesystem::path> given_files(const SolveArguments& arguments);

}  // namespace patchlight::cli
