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

/// What write_vtk() has written of a solution, as far as pictures need it.
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

/// Reads a .vtp file. \throws InputError when it is none, or not that of a solution.
StoredSolution read_vtk(const std::filesystem::path& file);

}  // namespace patchlight
