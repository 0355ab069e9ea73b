#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace patchlight {
namespace {

// A face opposite at this share of a patch's edge takes `allowed` of its hemisphere.
constexpr double near = 0.6;
constexpr double allowed = 0.35;

// What has gone wrong in the gaps of ten rooms, as a share of the irradiance that could have.
constexpr double gap_scale = 0.5;

// Normals of faces that look back at each other have a product below this one.
constexpr double opposed = -0.5;

// True when patch j is nearer to patch i than this share of its edge and looks back at it.
bool is_near(const PatchMesh& mesh, PatchIndex i, PatchIndex j, double within) {
  if (mesh.normal[i].dot(mesh.normal[j]) > opposed) return false;
  const double distance = (mesh.centroid[i] - mesh.centroid[j]).dot(mesh.normal[j]);
  return distance >= 0 && distance < within * std::sqrt(mesh.area[i]);
}

// The share of the hemisphere of patch i in which there are near faces that look back.
double share_of_near_faces(const PatchMesh& mesh, const ExchangeAreas& S, const Eigen::VectorXd& area, PatchIndex i) {
  double sum = 0;
  for (PatchIndex j = 0; j < mesh.size(); ++j)
    if (is_near(mesh, i, j, near)) sum += static_cast<double>(S.at(std::min(i, j), std::max(i, j)));
  return sum / area[i];
}

double share_of_near_faces(const PatchMesh& mesh, const RayRows& rows, PatchIndex i, double within) {
  double sum = 0;
  for (std::uint64_t k = rows.first_hit[i]; k < rows.first_hit[i + 1]; ++k)
    if (is_near(mesh, i, rows.hits[k], within)) sum += rows.hit_weight[i];
  for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k)
    if (is_near(mesh, i, rows.entries[k].patch, within)) sum += static_cast<double>(rows.entries[k].form_factor);
  return sum;
}

// H_i / 2 times what near faces take of the hemisphere beyond what one does.
template <typename Share>
Field errors_by_share(const PatchMesh& mesh, const Field& irradiance, const Share& share_of) {
  Eigen::ArrayXd share(mesh.size());
  parallel_for(mesh.size(), [&](std::size_t row) {
    const double taken = share_of(static_cast<PatchIndex>(row));
    share[static_cast<Eigen::Index>(row)] = std::clamp((taken - allowed) / (1 - allowed), 0.0, 1.0);
  });
  return irradiance.colwise() * (gap_scale * share);
}

}  // namespace

Field gap_errors(const PatchMesh& mesh, const ExchangeAreas& S, const SolvedProblem& solved) {
  return errors_by_share(mesh, solved.solution.irradiance,
                         [&](PatchIndex i) { return share_of_near_faces(mesh, S, solved.problem.area, i); });
}

Field gap_errors(const PatchMesh& mesh, const RayTransport& transport, const SolvedProblem& solved, int cuts) {
  const double within = std::ldexp(near, -cuts);
  return errors_by_share(mesh, solved.solution.irradiance, [&](PatchIndex i) {
    return 0.5 * (share_of_near_faces(mesh, transport.rows(0), i, within) +
                  share_of_near_faces(mesh, transport.rows(1), i, within));
  });
}

}  // namespace patchlight
