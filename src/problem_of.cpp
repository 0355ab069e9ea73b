#include "problem_of.h"

namespace patchlight {

RadiosityProblem problem_of(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                            bool emit_from_back) {
  const Eigen::Index bands = scene.materials.front().reflectance.size();
  RadiosityProblem problem{Field(mesh.size(), bands), Field::Zero(mesh.size(), bands), exposed_area};
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Material& material = scene.materials[mesh.material[i]];
    problem.reflectance.row(i) = material.reflectance;
    const bool is_a_front = mesh.side[i] == Side::front || scene.polygons[mesh.polygon[i]].back_material.has_value();
    if (is_a_front || emit_from_back) problem.exitance.row(i) = material.exitance;
  }
  return problem;
}

}  // namespace patchlight
