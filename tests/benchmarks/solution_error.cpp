#include "benchmarks/solution_error.h"

#include "patchlight/solve/solve.h"
#include "patchlight/transport/lost_share.h"

#include "transport/closure.h"
#include "transport/dense.h"
#include "visibility/occluder.h"

#include <cmath>

namespace patchlight::benchmarks {
namespace {

constexpr int lost_share_rays = 1024;

// Lamps are the patches that face down and lie within a tenth of the room's width from the middle of its ceiling.
Field lamps(const PatchMesh& mesh) {
  Box box;
  for (const Point& point : mesh.vertices) box.extend(point);
  Field exitance = Field::Zero(mesh.size(), 2);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Vector place = (mesh.centroid[i] - box.center()).cwiseQuotient(box.sizes());
    const bool is_lamp = mesh.normal[i].z() < -0.9 && place.z() > 0.499 && place.head<2>().cwiseAbs().maxCoeff() < 0.1;
    if (is_lamp) exitance.row(i) = 1;
  }
  return exitance;
}

RadiosityProblem problem_in(const PatchMesh& mesh, const Eigen::VectorXd& area) {
  RadiosityProblem problem{{Field(mesh.size(), 2)}, lamps(mesh), area};
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    problem.scattering.reflectance(i, 0) = mesh.normal[i].z() > 0.9 ? 0.3 : 0.8;
    problem.scattering.reflectance(i, 1) = 0.99;
  }
  return problem;
}

Field radiosity(const PatchMesh& mesh, const ExchangeAreas& raw, const LostShare& lost) {
  const Eigen::VectorXd area = exposed_area(mesh, lost, row_sums(raw));
  const auto transport = dense_transport(close_exchange_areas(raw, area, lost), area);
  return solve(*transport, problem_in(mesh, area), {.max_iterations = 10000}).radiosity;
}

}  // namespace

SolutionErrors solution_errors(const Room& room, const ExchangeAreas& S, const ExchangeAreas& reference) {
  const LostShare lost = measure_lost_share(room.mesh, Occluder(room.scene), lost_share_rays, 1);
  const Field exact = radiosity(room.mesh, reference, lost);
  const Field found = radiosity(room.mesh, S, lost);
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(room.mesh.area.data(), room.mesh.size());
  const Eigen::ArrayXd error = area_norm(exact - found, area) / area_norm(exact - lamps(room.mesh), area);
  return {error[0], error[1]};
}

}  // namespace patchlight::benchmarks
