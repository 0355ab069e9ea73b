#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/plan/effects.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// The part of a solution in a .vtp file that pictures need, as write_vtk() writes it. Indices and values are not
/// checked here: read_solution() does.
struct StoredSolution {
  std::string scene_hash;
  std::vector<Point> vertices;
  std::vector<std::array<std::uint32_t, 4>> corners;  ///< as PatchMesh has them; so are those below
  std::vector<PolygonIndex> polygon;
  std::vector<Side> side;
  std::vector<Middle> middles;
  Field radiosity, exitance, reflectance;  ///< in single precision
  std::vector<Decision> decisions;         ///< without reasons
  bool follows_reflections = false;
  bool converged = false;
  std::uint64_t seed = 1;
};

/// Reads a .vtp file, in a child process because VTK crashes on damaged files. Sizes agree: there is one polygon, one
/// side and one row of each field per patch. \throws InputError when it is no such file.
StoredSolution read_vtk(const std::filesystem::path& file);

}  // namespace patchlight
