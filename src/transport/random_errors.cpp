#include "patchlight/transport/random_errors.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"

#include <algorithm>
#include <cassert>
#include <numbers>
#include <vector>

namespace patchlight {
namespace {

// Partial sums are kept per stripe of rows; their number is fixed, so that the bits do not depend on the threads.
constexpr PatchIndex stripes = 8;

// S_ij without occluders, from centroid to centroid.
double unoccluded(const PatchMesh& mesh, const Eigen::VectorXd& area, PatchIndex i, PatchIndex j) {
  const Vector way = mesh.centroid[j] - mesh.centroid[i];
  const double square = way.squaredNorm();
  const double cosines = std::max(0.0, mesh.normal[i].dot(way)) * std::max(0.0, -mesh.normal[j].dot(way));
  if (cosines == 0) return 0;
  return std::min(std::min(area[i], area[j]), area[i] * area[j] * cosines / (std::numbers::pi * square * square));
}

struct Drawer {
  const PatchMesh& mesh;
  const Eigen::VectorXd& area;
  const EntryErrors& errors;
  double of_visible;  // relative
  double of_hidden;
  std::uint32_t seed;

  double standard_error(PatchIndex i, PatchIndex j) const;
  void add_row(PatchIndex j, const FieldView& x, Field& sum) const;
};

double Drawer::standard_error(PatchIndex i, PatchIndex j) const {
  switch (errors.kind(i, j)) {
    case EntryKind::exact:
      return 0;
    case EntryKind::all_visible:
      return of_visible > 0 ? of_visible * unoccluded(mesh, area, i, j) : 0;
    case EntryKind::all_hidden:
      return of_hidden > 0 ? of_hidden * unoccluded(mesh, area, i, j) : 0;
    case EntryKind::estimated:
      return errors.standard_error(i, j);
  }
  return 0;
}

// Adds what the entries of row j and the columns before it contribute.
void Drawer::add_row(PatchIndex j, const FieldView& x, Field& sum) const {
  const Eigen::Index columns = x.cols();
  const Eigen::Index draws = sum.cols() / columns;
  for (PatchIndex i = 0; i < j; ++i) {
    const double sigma = standard_error(i, j);
    if (sigma == 0) continue;
    const std::uint32_t signs = hash(hash(i ^ seed) + j);
    for (Eigen::Index draw = 0; draw < draws; ++draw) {
      const double error = (signs >> draw & 1) != 0 ? sigma : -sigma;
      for (Eigen::Index c = 0; c < columns; ++c) {
        sum(i, draw * columns + c) += error * x(j, c);
        sum(j, draw * columns + c) += error * x(i, c);
      }
    }
  }
}

}  // namespace

Field random_errors(const ErrorsOfEntries& of, const FieldView& x, int draws, std::uint64_t seed) {
  const auto& [mesh, area, errors, sampling] = of;
  assert(x.rows() == static_cast<Eigen::Index>(errors.size()) && draws >= 1 && draws <= 32);
  const Drawer drawer{mesh,
                      area,
                      errors,
                      standard_error(sampling.visible),
                      standard_error(sampling.occluded),
                      hash({seed, 0x64726177})};
  std::vector<Field> partial(stripes, Field::Zero(x.rows(), x.cols() * draws));
  parallel_for(stripes, [&](std::size_t stripe) {
    for (auto j = static_cast<PatchIndex>(stripe); j < errors.size(); j += stripes) {
      drawer.add_row(j, x, partial[stripe]);
    }
  });
  for (std::size_t stripe = 1; stripe < stripes; ++stripe) partial[0] += partial[stripe];
  return partial[0];
}

}  // namespace patchlight
