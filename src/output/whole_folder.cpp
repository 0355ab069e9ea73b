#include "patchlight/output/whole_folder.h"

#include "patchlight/base/error.h"

#include "output/temporary.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <string>
#include <sys/file.h>
#include <system_error>
#include <unistd.h>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* temporary_extension = ".partial";

// The folder itself, absolute, without a slash at its end.
fs::path folder_path(const fs::path& folder) {
  const fs::path path = followed(folder).lexically_normal();
  return path.filename().empty() ? path.parent_path() : path;
}

// A new folder, locked as long as this lives: an unlocked one was left by a run that was killed. Whatever bears its
// name at the end is removed.
class TemporaryFolder {
 public:
  TemporaryFolder(const fs::path& target, const fs::path& folder)
      : path_(temporary_beside(target).replace_extension(temporary_extension)) {
    std::error_code error;
    fs::create_directory(path_, error);
    if (error) throw OutputError(folder.string(), "cannot write into the folder above it: " + error.message());
    descriptor_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ >= 0) flock(descriptor_, LOCK_EX);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (descriptor_ >= 0) close(descriptor_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  int descriptor_ = -1;
};

// Removes temporary folders of runs that were killed. A folder whose lock can be had belongs to nobody.
void remove_left_folders(const fs::path& parent) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, ignored)) {
    const fs::path& path = entry.path();
    if (!path.filename().string().starts_with(temporary_prefix) || path.extension() != temporary_extension) continue;
    const int descriptor = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove_all(path, ignored);
    close(descriptor);
  }
}

void check_target(const fs::path& folder, const fs::path& target, const MayReplace& may_replace) {
  if (!fs::is_directory(target.parent_path())) {
    throw OutputError(folder.string(), "there is no folder " + target.parent_path().string() + "; create it first");
  }
  if (!fs::exists(target)) return;
  if (!fs::is_directory(target)) throw OutputError(folder.string(), "is a file; expected the name of a folder");
  if (!fs::is_empty(target) && !may_replace(target)) {
    throw OutputError(folder.string(),
                      "holds other files than an earlier result; give the name of a new folder, or empty it first");
  }
}

// The same error for a user who does not know of the temporary folder.
OutputError renamed(const OutputError& error, const fs::path& temporary, const fs::path& folder) {
  const std::string text = error.what();
  if (!text.starts_with(temporary.string())) return error;
  const std::string rest = text.substr(temporary.string().size());
  const std::size_t colon = std::min(rest.size(), rest.find(": "));
  return {(folder / "").parent_path().string() + rest.substr(0, colon), rest.substr(std::min(rest.size(), colon + 2))};
}

// Afterwards the new folder bears the name, and the old one, if any, that of the new.
void swap_folders(const fs::path& fresh, const fs::path& target, const fs::path& folder) {
  // An empty folder, or none, is replaced at once.
  if (rename(fresh.c_str(), target.c_str()) == 0) return;
  if (renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
  // Some file systems cannot exchange: then for a moment there is neither.
  const fs::path old = temporary_beside(target).replace_extension(temporary_extension);
  if (rename(target.c_str(), old.c_str()) != 0) fail_writing(folder, "cannot be replaced", errno);
  fs::rename(fresh, target);
  fs::remove_all(old);
}

}  // namespace

void check_folder_writable(const fs::path& folder, const MayReplace& may_replace) {
  try {
    const fs::path target = folder_path(folder);
    check_target(folder, target, may_replace);
    const TemporaryFolder trial(target, folder);
    remove_left_folders(target.parent_path());
  } catch (const fs::filesystem_error& error) {
    throw OutputError(folder.string(), error.code().message());
  }
}

void write_whole_folder(const fs::path& folder, const MayReplace& may_replace,
                        const std::function<void(const fs::path& temporary)>& write) {
  try {
    const fs::path target = folder_path(folder);
    check_target(folder, target, may_replace);
    const TemporaryFolder temporary(target, folder);
    try {
      write(temporary.path());
    } catch (const OutputError& error) {
      throw renamed(error, temporary.path(), folder);
    }
    flush_to_disk(temporary.path(), folder);
    swap_folders(temporary.path(), target, folder);
    flush_to_disk(target.parent_path(), folder);
  } catch (const std::system_error& error) {
    throw OutputError(folder.string(), "cannot be written: " + error.code().message());
  }
}

}  // namespace patchlight
