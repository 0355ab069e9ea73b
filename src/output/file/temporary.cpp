#include "output/file/temporary.h"

#include <algorithm>
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
  // Link by link: the last may name a file that is not there yet.
  constexpr int most_links = 40;  // as Linux follows
  fs::path target = fs::absolute(file);
  std::error_code error;
  for (int k = 0; k < most_links; ++k) {
    if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
    const fs::path next = fs::read_symlink(target, error);
    if (error) break;
    target = target.parent_path() / next;
  }
  throw OutputError(file.string(), "is a link that leads nowhere: too many links follow one another");
}

OutputError renamed(const OutputError& error, const fs::path& temporary, const fs::path& known) {
  const std::string text = error.what();
  if (!text.starts_with(temporary.string())) return error;
  const std::string rest = text.substr(temporary.string().size());
  const std::size_t colon = std::min(rest.size(), rest.find(": "));
  return {known.string() + rest.substr(0, colon), rest.substr(std::min(rest.size(), colon + 2))};
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
