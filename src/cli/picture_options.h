#pragma once

#include "cli/arguments.h"
#include "cli/distinct_files.h"

#include <CLI/App.hpp>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace patchlight::cli {

/// How --camera is given.
inline constexpr const char* camera_example = "--camera 4,-3,1.6 0,0,1 60";

/// What --picture-samples may be.
inline constexpr int least_picture_samples = 4, most_picture_samples = 4096;

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

/// Adds --false-color, --camera, --projection, --view, --picture-quality, --size, --picture-error, --picture-samples
/// and
/// --picture-error-map.
/// What is parsed lands in `given`, which must outlive the command.
void add_picture_options(CLI::App& command, PictureGiven& given, PictureQuality usual);

/// Adds --camera, --projection, --view and --size of these alone.
void add_view_options(CLI::App& command, PictureGiven& given);

/// What they ask for; `file_option` is the one that names the picture. \throws UsageError when they contradict each
/// other.
PictureSettings picture_settings(const PictureGiven& given, const std::string& file_option, PictureQuality usual);

/// One picture for each view: of several, each with its view in its files' names, "room.desk.png" for "room.png".
std::vector<PictureSettings> single_pictures(const PictureSettings& settings);

/// The files of pictures, with the options that ask for them.
std::vector<OutputFile> picture_files(const PictureSettings& settings, const std::string& file_option);

}  // namespace patchlight::cli
