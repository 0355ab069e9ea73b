#include "benchmarks/entry_errors.h"

#include "patchlight/solve/problem.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace patchlight::benchmarks {
namespace {

// 1 + u/2 + v (1 - v) + cos(pi w) / 4 with the centroid's place (u, v, w) in the unit cube around the mesh.
Field smooth_field(const PatchMesh& mesh) {
  Box box;
  for (const Point& point : mesh.vertices) box.extend(point);
  Field x(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Vector place = (mesh.centroid[i] - box.min()).cwiseQuotient(box.sizes());
    x(i, 0) = 1 + place.x() / 2 + place.y() * (1 - place.y()) + std::cos(std::numbers::pi * place.z()) / 4;
  }
  return x;
}

}  // namespace

EntryDeviations entry_errors(const PatchMesh& mesh, const ExchangeAreas& S, const ExchangeAreas& reference) {
  EntryDeviations errors;
  double difference = 0;
  double sum = 0;
  std::vector<float> of_pairs;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (PatchIndex j = i + 1; j < mesh.size(); ++j) {
      const double exact = reference.at(i, j);
      const double error = std::abs(S.at(i, j) - exact);
      difference += error;
      sum += exact;
      if (exact == 0) continue;
      for (const PatchIndex k : {i, j}) {
        of_pairs.push_back(static_cast<float>(error / mesh.area[k]));
        errors.mean_F += exact / mesh.area[k];
      }
    }
  }
  const auto place = of_pairs.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(of_pairs.size()));
  std::nth_element(of_pairs.begin(), place, of_pairs.end());
  errors.l1 = difference / sum;
  errors.p999 = *place;
  errors.mean_F /= static_cast<double>(of_pairs.size());

  // F x = A^-1 S x.
  const Field x = smooth_field(mesh);
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
  const Field exact = multiply(reference, x).colwise() / area.array();
  const Field found = multiply(S, x).colwise() / area.array();
  errors.matvec = area_norm(found - exact, area)[0] / area_norm(exact, area)[0];
  return errors;
}

}  // namespace patchlight::benchmarks
