#include "transport/random_errors.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "transport/tiles.h"

#include <algorithm>
#include <cassert>
#include <numbers>

namespace patchlight {
namespace {

// S_ij without occluders, from centroid to centroid.
double unoccluded(const PatchMesh& mesh, const Eigen::VectorXd& area, PatchIndex i, PatchIndex j) {
  const Vector way = mesh.centroid[j] - mesh.centroid[i];
  const double square = way.squaredNorm();
  const double cosines = std::max(0.0, mesh.normal[i].dot(way)) * std::max(0.0, -mesh.normal[j].dot(way));
  if (cosines == 0) return 0;
  return std::min(std::min(area[i], area[j]), area[i] * area[j] * cosines / (std::numbers::pi * square * square));
}

struct Drawer {
  const ErrorsOfEntries& of;
  std::uint32_t seed = 0;  // of the signs

  double standard_error(PatchIndex i, PatchIndex j) const;
  double of_unanimous(const SamplingError::Unanimous& unanimous, PatchIndex i, PatchIndex j) const;
  void add_row(PatchIndex j, const FieldView& x, Field& sum) const;
  void add_variances(PatchIndex j, const FieldView& x, Field& sum) const;
};

double Drawer::standard_error(PatchIndex i, PatchIndex j) const {
  switch (of.errors.kind(i, j)) {
    case EntryKind::exact:
      return 0;
    case EntryKind::all_visible:
      return of_unanimous(of.sampling.visible, i, j);
    case EntryKind::all_hidden:
      return of_unanimous(of.sampling.occluded, i, j);
    case EntryKind::estimated:
      return of.errors.standard_error(i, j);
  }
  return 0;
}

double Drawer::of_unanimous(const SamplingError::Unanimous& unanimous, PatchIndex i, PatchIndex j) const {
  const double U = unoccluded(of.mesh, of.area, i, j);
  return U * patchlight::standard_error(unanimous, sampling_effort(U / std::min(of.area[i], of.area[j])));
}

// Adds the part of the entries of row j and the columns before it.
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

// The same of the variances.
void Drawer::add_variances(PatchIndex j, const FieldView& x, Field& sum) const {
  for (PatchIndex i = 0; i < j; ++i) {
    const double sigma = standard_error(i, j);
    if (sigma == 0) continue;
    sum.row(i) += sigma * sigma * x.row(j);
    sum.row(j) += sigma * sigma * x.row(i);
  }
}

}  // namespace

Field random_errors(const ErrorsOfEntries& of, const FieldView& x, int draws, std::uint64_t seed) {
  assert(x.rows() == static_cast<Eigen::Index>(of.errors.size()) && draws >= 1 && draws <= 32);
  const Drawer drawer{of, hash({seed, stream::signs_of_rows})};
  const Field zero = Field::Zero(x.rows(), x.cols() * draws);
  return sum_over_stripes(of.errors.size(), stripes, zero,
                          [&](PatchIndex j, Field& sum) { drawer.add_row(j, x, sum); });
}

Field by_variances(const ErrorsOfEntries& of, const FieldView& x) {
  assert(x.rows() == static_cast<Eigen::Index>(of.errors.size()));
  const Drawer drawer{of};
  const Field zero = Field::Zero(x.rows(), x.cols());
  return sum_over_stripes(of.errors.size(), stripes, zero,
                          [&](PatchIndex j, Field& sum) { drawer.add_variances(j, x, sum); });
}

}  // namespace patchlight
