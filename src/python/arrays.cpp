#include "python/arrays.h"

#include "patchlight/base/error.h"

#include <string>

namespace patchlight {

Field field_of(const NumbersIn& numbers, Eigen::Index rows) {
  const bool fits = (numbers.ndim() == 1 || numbers.ndim() == 2) && numbers.shape(0) == rows;
  if (!fits)
    throw InputError("array", "found " + std::to_string(numbers.ndim()) + " axes and " +
                                  std::to_string(numbers.size()) + " numbers; expected a row for each of " +
                                  std::to_string(rows) + " patches");
  const Eigen::Index columns = numbers.ndim() == 2 ? numbers.shape(1) : 1;
  return Eigen::Map<const Field>(numbers.data(), rows, columns);
}

pybind11::array array_of(Field field) {
  auto* const kept = new Field(std::move(field));
  const pybind11::capsule owner(kept, [](void* pointer) { delete static_cast<Field*>(pointer); });
  return pybind11::array(pybind11::dtype::of<double>(), {kept->rows(), kept->cols()}, kept->data(), owner);
}

}  // namespace patchlight
