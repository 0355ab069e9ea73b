#pragma once

#include "transport/ray_exchange.h"
#include "transport/rows_by_class.h"

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace patchlight {

// The files of rays that are specular on their way, in a folder of rows of rays.
// docs/reference/outputs/form-factor-folder.md describes them.

/// Writes those of one half. \throws OutputError.
void write_stops(const std::filesystem::path& folder, std::size_t half, const RayRows& rows);

/// Writes RayExchange::specular_kinds. \throws OutputError.
void write_kinds(const std::filesystem::path& file, const RayExchange& exchange);

/// Writes the form factors by each class of ways. \throws OutputError.
void write_classes(const std::filesystem::path& folder, const RowsByClass& by_class);

/// What stops may name.
struct NumbersOf {
  std::size_t patches = 0;
  std::size_t polygons = 0;
};

/// Reads those of one half into rows. \throws InputError when they cannot be.
void read_stops(const std::filesystem::path& folder, std::size_t half, const NumbersOf& there, RayRows& rows);

/// \throws InputError.
std::vector<std::array<double, 2>> read_kinds(const std::filesystem::path& file);

/// What each of these files has, by its name.
std::map<std::string, std::string> meaning_of_stop_files();

}  // namespace patchlight
