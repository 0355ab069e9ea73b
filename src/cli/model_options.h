#pragma once

#include "patchlight/input/read_scene.h"

#include <CLI/App.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// The options that say which model is read and how, while they are being parsed.
struct ModelOptions {
  std::vector<std::string> models;
  std::string format;
  std::vector<std::string> settings;
  double metres_per_unit = 1;
};

/// Adds MODEL, --format, --unit and --set to a command. What is parsed lands in `options`, which must outlive it.
void add_model_options(CLI::App& command, ModelOptions& options);

/// Adds --set alone.
void add_set_option(CLI::App& command, std::vector<std::string>& settings);

/// The model files as paths. \throws UsageError when one is given twice.
std::vector<std::filesystem::path> model_files(const ModelOptions& options);

/// \throws InputError when a --set cannot be understood.
ReadOptions read_options(const ModelOptions& options);

/// \throws InputError when one cannot be understood.
std::vector<MaterialSetting> material_settings(const std::vector<std::string>& texts);

}  // namespace patchlight::cli
