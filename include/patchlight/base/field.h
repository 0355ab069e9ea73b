#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace patchlight {

/// Index of a patch, 0 to size - 1.
using PatchIndex = std::uint32_t;

/// A half-open range of patches [begin, end).
struct PatchRange {
  PatchIndex begin = 0;
  PatchIndex end = 0;
};

/// One value per patch (row) and spectral band (column).
using Field = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A read-only view of a Field.
using FieldView = Eigen::Ref<const Field>;

}  // namespace patchlight
