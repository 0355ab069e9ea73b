#pragma once

#include "patchlight/render/image.h"
#include "patchlight/report/report.h"
#include "patchlight/scene/scene.h"
#include "patchlight/views/views.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// The version of this library, "major.minor.patch".
const char* version();

/// Where a result comes from.
struct Provenance {
  std::string command_line;
  double exposure = 1;       ///< of the colors beside the values
  std::string scene_hash{};  ///< of faces, materials and lights; empty: not recorded, and pictures of the result cannot
                             ///< be taken later
  std::vector<std::string> changes{};  ///< made besides, which the command line does not show
};

/// The extensions write_result() knows: ".vtp", ".vtu", ".ply", ".glb".
const std::vector<std::string>& result_extensions();

/// Writes the solved patches in the format that the extension names. \throws OutputError, also for an unknown one.
void write_result(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance);

/// Writes a report as JSON:
/// - request and plan, facts and notes of the scene;
/// - area, emitted and absorbed flux and irradiance of each material,
/// - readings of sensors;
/// - raw row sums, energy balance, convergence history, seconds, and peak memory of the process.
/// docs/reference/outputs/report-json.md lists the keys. \throws OutputError.
void write_report(const std::filesystem::path& file, const Report& report, const Provenance& provenance);

/// A text that goes with a PNG.
struct PngText {
  std::string keyword;
  std::string text;
};

/// Writes a PNG. \throws OutputError.
void write_png(const std::filesystem::path& file, const DisplayImage& image, const std::vector<PngText>& texts = {});

/// The image with a legend of false colors at its right: a color bar with numbers from `lower` to `upper` and
/// `title`.
DisplayImage with_legend(const DisplayImage& image, double lower, double upper, const std::string& title);

}  // namespace patchlight
