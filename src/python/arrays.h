#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"

#include <array>
#include <cstdint>
#include <pybind11/numpy.h>
#include <vector>

namespace patchlight {

/// A read-only array over memory of `owner`, without a copy.
template <class Number>
pybind11::array array_over(const Number* values, std::vector<pybind11::ssize_t> shape, pybind11::handle owner) {
  pybind11::array array(pybind11::dtype::of<Number>(), std::move(shape), values, owner);
  array.attr("setflags")(pybind11::arg("write") = false);
  return array;
}

inline pybind11::array array_over(const Field& field, pybind11::handle owner) {
  return array_over(field.data(), {field.rows(), field.cols()}, owner);
}

inline pybind11::array array_over(const Eigen::VectorXd& values, pybind11::handle owner) {
  return array_over(values.data(), {values.size()}, owner);
}

/// The corners of patches as rows of four; see corners_text.
inline pybind11::array array_over(const std::vector<std::array<std::uint32_t, 4>>& corners, pybind11::handle owner) {
  return array_over(corners.empty() ? nullptr : corners.front().data(),
                    {static_cast<pybind11::ssize_t>(corners.size()), 4}, owner);
}
inline constexpr const char* corners_text = "indices of vertices, patches x 4; a triangle repeats its last";

/// Points as rows of three.
inline pybind11::array array_over(const std::vector<Point>& points, pybind11::handle owner) {
  static_assert(sizeof(Point) == 3 * sizeof(double));
  return array_over(points.empty() ? nullptr : points.front().data(),
                    {static_cast<pybind11::ssize_t>(points.size()), 3}, owner);
}

template <class Number>
pybind11::array array_over(const std::vector<Number>& values, pybind11::handle owner) {
  return array_over(values.data(), {static_cast<pybind11::ssize_t>(values.size())}, owner);
}

/// Numbers of any kind, in rows; a 1D array is one column.
using NumbersIn = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// \throws InputError unless there are `rows` rows.
Field field_of(const NumbersIn& numbers, Eigen::Index rows);

/// An array that owns the memory of the field.
pybind11::array array_of(Field field);

}  // namespace patchlight
