#pragma once

#include "patchlight/input/read_scene.h"

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patchlight::cli {

/// The options that say which model is read and how, while they are being parsed.
struct ModelOptions {
  std::vector<std::string> models;
  std::string format;
  std::vector<std::string> settings;
  std::optional<double> metres_per_unit;
  std::optional<Vector> up;
  std::vector<std::string> only, leave_out;
  double detail = 0;
  std::optional<double> maintenance_factor;
  bool keep_faces = false;
  DaylightSetting daylight;
  std::string bands;
  std::optional<double> color_error;
  std::string confine;
};

/// Adds the arguments that name the files and their units. The values land in `options`, which must outlive the
/// command; so below.
void add_file_options(CLI::App& command, ModelOptions& options);

/// The same, and the options that change the model: materials, choice of faces, daylight.
void add_model_options(CLI::App& command, ModelOptions& options);

/// Adds --set alone.
void add_set_option(CLI::App& command, std::vector<std::string>& settings);

/// Adds --up alone.
void add_up_option(CLI::App& command, std::optional<Vector>& up);

/// Adds --sky, --sun, --ground and --weather.
void add_daylight_options(CLI::App& command, DaylightSetting& daylight);

/// The model files as paths. \throws UsageError when one is given twice.
std::vector<std::filesystem::path> model_files(const ModelOptions& options);

/// \throws InputError when a --set cannot be understood.
ReadOptions read_options(const ModelOptions& options);

/// \throws InputError when one cannot be understood.
std::vector<MaterialSetting> material_settings(const std::vector<std::string>& texts);

}  // namespace patchlight::cli
