#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/output/write_result.h"
#include "patchlight/scene/scene.h"
#include "patchlight/views/views.h"

#include <Eigen/Core>
#include <array>
#include <bit>
#include <concepts>
#include <filesystem>
#include <string>

namespace patchlight {

/// Appends a number as it stands in memory, least significant byte first.
template <class Number>
requires std::integral<Number> || std::floating_point<Number>
void append_bytes(std::string& bytes, Number number) {
  static_assert(std::endian::native == std::endian::little, "the formats written are little endian");
  const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  bytes.append(raw.data(), raw.size());
}

/// glTF's y points up: of a scene whose z does, (x, y, z) becomes (x, z, -y).
Vector y_up(const Vector& vector, const Scene& scene);

/// Writes the patches as a colored surface for viewers and the web: binary glTF 2.0, unlit (KHR_materials_unlit), one
/// sided, triangles, vertex colors of the interpolated radiance at the recorded exposure. glTF is Y up: a scene whose
/// z points up is turned, (x, y, z) becomes (x, z, -y). Positions are floats relative to the center of the bounds,
/// which is the node's translation. \throws OutputError, also when the file would exceed the format's 4 GiB.
void write_glb(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance);

/// Writes the patches as a colored surface for viewers: binary little-endian PLY, positions in meters in double, per
/// vertex the display color (sRGB, 8 bits) of the interpolated radiance at the recorded exposure, one face per patch.
/// \throws OutputError.
void write_ply(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance);

/// The patches of form factors and the sums of their rows.
struct MeshOfRows {
  const PatchMesh& mesh;
  Eigen::VectorXd area;         ///< the exposed part, m^2
  Eigen::VectorXd row_sum;      ///< of the form factors
  Eigen::VectorXd raw_row_sum;  ///< before closure; empty where rows were never otherwise
};

/// Writes the patches that form factors belong to, in their order, as VTK XML PolyData (.vtp). Cell arrays: area (the
/// exposed part, m^2), row_sum, raw_row_sum (unless it is empty), material_id, object_id, source_polygon. FieldData:
/// material_names, object_names. \throws OutputError.
void write_mesh(const std::filesystem::path& file, const Scene& scene, const MeshOfRows& rows);

}  // namespace patchlight
