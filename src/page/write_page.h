#pragma once

#include "patchlight/output/write_result.h"
#include "patchlight/report/report.h"
#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

struct Comparison;
struct Study;

/// The parts of a page on a scene. A part without a pointer is left out.
struct Page {
  const Scene& scene;
  Provenance provenance = {};
  const SolvedSurface* surface = nullptr;
  const Report* report = nullptr;
  const Readings* readings = nullptr;  ///< of the scene's sensors
  std::vector<const Picture*> pictures = {};
  const Comparison* comparison = nullptr;
  const Study* study = nullptr;
};

/// The page's bytes: HTML, one file that needs nothing else.
std::string page_of(const Page& page);

/// Writes one page for browsers, which needs no other file and no network: the model to turn around, its values, tables
/// and pictures. docs/reference/outputs/page.md describes it. \throws OutputError.
void write_page(const std::filesystem::path& file, const Page& page);

/// The page without its title and its data, which take the places of @TITLE@ and @DATA@. It is put together by
/// cmake/page.cmake when the library is built.
std::string_view page_template();

/// three.js and its controls.
std::string_view page_scripts();

}  // namespace patchlight
