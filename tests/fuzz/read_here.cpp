// Replaces the isolated reader: a fuzzer measures the coverage of its own process only.
#include "patchlight/base/error.h"

#include "files/isolated.h"

namespace patchlight {

std::string bytes_isolated(const std::string& file, const std::function<std::string()>& read, const ChildLimits&) {
  try {
    return read();
  } catch (const InputError&) {
    throw;
  } catch (const std::exception&) {
    throw InputError(file, "cannot be read");
  }
}

// Programs are not run.
std::string output_isolated(const std::string& file, const Program&, const std::string&, const ChildLimits&) {
  throw InputError(file, "cannot be read");
}

}  // namespace patchlight
