// Stands in for read_isolated(): what a child process does is hidden from the fuzzer, so the reader runs in this one.
#include "patchlight/base/error.h"

#include "input/isolated.h"

namespace patchlight {

Scene read_isolated(const std::string& file, const std::function<Scene()>& read, const ChildLimits&) {
  try {
    return read();
  } catch (const InputError&) {
    throw;
  } catch (const std::exception&) {
    throw InputError(file, "cannot be read");
  }
}

}  // namespace patchlight
