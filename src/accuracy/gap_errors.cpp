#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// A face opposite at this share of a patch's edge takes `allowed` of its hemisphere.
constexpr double near = 0.6;
constexpr double allowed = 0.35;

// What has gone wrong in the gaps of ten rooms, as a share of the irradiance that could have.
constexpr double gap_scale = 0.5;

// Normals of faces that look back at each other have a product below this one.
constexpr double opposed = -0.5;

// The share of the hemisphere of patch i in which there are near faces that look back.
double share_of_near_faces(const PatchMesh& mesh, const ExchangeAreas& S, const Eigen::VectorXd& area, PatchIndex i) {
  const double reach = near * std::sqrt(mesh.area[i]);
  double sum = 0;
  for (PatchIndex j = 0; j < mesh.size(); ++j) {
    if (mesh.normal[i].dot(mesh.normal[j]) > opposed) continue;
    const double distance = (mesh.centroid[i] - mesh.centroid[j]).dot(mesh.normal[j]);
    if (distance < reach) sum += static_cast<double>(S.at(std::min(i, j), std::max(i, j)));
  }
  return sum / area[i];
}

}  // namespace

Field gap_errors(const PatchMesh& mesh, const ExchangeAreas& S, const SolvedProblem& solved) {
  Eigen::ArrayXd share(mesh.size());
  parallel_for(mesh.size(), [&](std::size_t row) {
    const auto i = static_cast<PatchIndex>(row);
    const double taken = share_of_near_faces(mesh, S, solved.problem.area, i);
    share[i] = std::clamp((taken - allowed) / (1 - allowed), 0.0, 1.0);
  });
  return solved.solution.irradiance.colwise() * (gap_scale * share);
}

}  // namespace patchlight
