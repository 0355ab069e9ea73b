#include "patchlight/output/whole_file.h"

#include "patchlight/base/error.h"

#include "output/temporary.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

// An empty file, locked as long as this lives: an unlocked one was left by a run that was killed. Gone at the end,
// unless it was renamed.
class TemporaryFile {
 public:
  /// `file` is the name that the user knows, for the message.
  TemporaryFile(fs::path path, const fs::path& file) : path_(std::move(path)) {
    while (!is_locked()) {
      descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0) fail_writing(file, "cannot write into this folder", errno);
    }
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
    close(descriptor_);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const fs::path& path() const { return path_; }

 private:
  // False when another run took the file for a left one before it was locked.
  bool is_locked() {
    if (descriptor_ < 0) return false;
    // Some file systems know no locks; then nobody can take the file for a left one either.
    flock(descriptor_, LOCK_EX);
    struct stat status {};
    if (fstat(descriptor_, &status) != 0 || status.st_nlink > 0) return true;
    close(descriptor_);
    return false;
  }

  fs::path path_;
  int descriptor_ = -1;
};

// Removes temporary files of runs that were killed. A file whose lock can be had belongs to nobody.
void remove_left_files(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (!entry.path().filename().string().starts_with(temporary_prefix)) continue;
    const int descriptor = open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (entry.is_regular_file(ignored) && flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove(entry.path(), ignored);
    close(descriptor);
  }
}

void check_target(const fs::path& file, const fs::path& target) {
  const fs::path folder = target.parent_path();
  if (target.filename().empty() || fs::is_directory(target)) {
    throw OutputError(file.string(), "is a folder; expected the name of a file to write");
  }
  if (!fs::is_directory(folder)) {
    throw OutputError(file.string(), "there is no folder " + folder.string() + "; create it first");
  }
  if (!fs::exists(target)) return;
  if (!fs::is_regular_file(target)) {
    throw OutputError(file.string(), "is a device or a pipe; expected the name of a file to write");
  }
  if (access(target.c_str(), W_OK) != 0) fail_writing(file, "exists and cannot be replaced", errno);
}

}  // namespace

void check_writable(const fs::path& file) {
  try {
    const fs::path target = followed(file);
    check_target(file, target);
    // Only trying tells: permissions, read-only and full file systems.
    const TemporaryFile trial(temporary_beside(target), file);
    remove_left_files(target.parent_path());
  } catch (const fs::filesystem_error& error) {
    throw OutputError(file.string(), error.code().message());
  }
}

void write_whole_file(const fs::path& file, const std::function<void(const fs::path& temporary)>& write) {
  try {
    const fs::path target = followed(file);
    check_target(file, target);
    const TemporaryFile temporary(temporary_beside(target), file);
    write(temporary.path());
    if (fs::file_size(temporary.path()) == 0) throw OutputError(file.string(), "nothing was written");
    if (fs::exists(target)) fs::permissions(temporary.path(), fs::status(target).permissions());
    flush_to_disk(temporary.path(), file);
    fs::rename(temporary.path(), target);
    flush_to_disk(target.parent_path(), file);
  } catch (const std::system_error& error) {
    // Input and output only: fs::filesystem_error and std::ios_base::failure.
    throw OutputError(file.string(), "cannot be written: " + error.code().message());
  }
}

}  // namespace patchlight
