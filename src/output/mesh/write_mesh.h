#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include <Eigen/Core>
#include <filesystem>

namespace patchlight {

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
