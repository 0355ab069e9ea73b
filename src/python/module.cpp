#include "patchlight/base/error.h"

#include "cli/arguments.h"
#include "python/bindings.h"

namespace patchlight {
namespace {

// Exceptions with the messages of the library.
void bind_errors(pybind11::module_& module) {
  static pybind11::exception<InputError> input(module, "InputError", PyExc_ValueError);
  static pybind11::exception<OutputError> output(module, "OutputError", PyExc_OSError);
  pybind11::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      input(error.what());
    } catch (const cli::UsageError& error) {
      input(error.what());
    } catch (const OutputError& error) {
      output(error.what());
    } catch (const MemoryError& error) {
      PyErr_SetString(PyExc_MemoryError, error.what());
    } catch (const Canceled&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
}

}  // namespace
}  // namespace patchlight

// The compiled part of the module patchlight; users see src/python/patchlight.
PYBIND11_MODULE(_core, module) {
  patchlight::bind_errors(module);
  patchlight::bind_scene(module);
  patchlight::bind_transport(module);
  patchlight::bind_simulation(module);
}
