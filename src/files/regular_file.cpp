#include "files/regular_file.h"

#include "patchlight/base/error.h"

#include <system_error>

namespace patchlight {

void require_regular_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return;
  const char* const what = std::filesystem::is_directory(status) ? "folder"
                           : std::filesystem::is_fifo(status)    ? "pipe"
                                                                 : "device";
  throw InputError(file.string(), std::string("is a ") + what + "; expected a regular file");
}

}  // namespace patchlight
