#pragma once

#include <pybind11/pybind11.h>

namespace patchlight {

/// Scene, materials and options.
void bind_scene(pybind11::module_& module);
/// solve(), and the views of a solution.
void bind_simulation(pybind11::module_& module);
/// Form factors as an operator, and the solvers.
void bind_transport(pybind11::module_& module);

}  // namespace patchlight
