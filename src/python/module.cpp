#include "python/bindings.h"

// The part of the module patchlight that is compiled; src/python/patchlight is what its users see.
PYBIND11_MODULE(_core, module) {
  patchlight::bind_errors(module);
  patchlight::bind_scene(module);
  patchlight::bind_transport(module);
  patchlight::bind_simulation(module);
}
