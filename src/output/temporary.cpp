#include "output/temporary.h"

#include "patchlight/base/error.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

namespace patchlight {

namespace fs = std::filesystem;

fs::path temporary_beside(const fs::path& file) {
  static std::atomic<unsigned> calls{0};
  const std::string name = std::string(temporary_prefix) + std::to_string(getpid()) + "-" + std::to_string(calls++);
  return file.parent_path() / (name + file.extension().string());
}

fs::path followed(const fs::path& file) {
  if (file.empty()) throw OutputError("output", "the name of the file to write is empty");
  std::error_code ignored;
  return fs::is_symlink(file, ignored) ? fs::weakly_canonical(file) : fs::absolute(file);
}

void fail_writing(const fs::path& file, const std::string& message, int error_number) {
  throw OutputError(file.string(), message + ": " + std::strerror(error_number));
}

void flush_to_disk(const fs::path& path, const fs::path& file) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_writing(file, "cannot be written", errno);
  // Some file systems cannot flush a folder: EINVAL.
  const int error_number = fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;
  close(descriptor);
  if (error_number != 0) fail_writing(file, "cannot be written to disk", error_number);
}

}  // namespace patchlight
