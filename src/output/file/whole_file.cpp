#include "output/file/whole_file.h"

#include "patchlight/base/error.h"

#include "output/file/partial_folder.h"
#include "output/file/temporary.h"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

// An empty file, locked as long as this lives: an unlocked one was left by a run that was killed. Gone at the end,
// unless it was renamed.
class TemporaryFile {
 public:
  /// `file` is the name that the user knows, for the message.
  TemporaryFile(const fs::path& target, const fs::path& file) {
    for (int tries = 0; !is_locked(); ++tries) {
      path_ = temporary_beside(target);
      descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      // A name that is taken is another program's.
      const bool is_taken = descriptor_ < 0 && errno == EEXIST && tries < most_tries;
      if (descriptor_ < 0 && !is_taken) fail_writing(file, "cannot write into this folder", errno);
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
    descriptor_ = -1;
    return false;
  }

  fs::path path_;
  int descriptor_ = -1;
};

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

// Keeps other runs from renaming at the same time, so that the files of one folder are those of one run. Who cannot
// have the lock in time goes on without: somebody else may hold it for reasons of his own.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    constexpr int most_waits = 200;
    constexpr auto wait = std::chrono::milliseconds(10);
    for (int k = 0; k < most_waits && flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; ++k) {
      std::this_thread::sleep_for(wait);
    }
  }
  ~FolderLock() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace

void check_writable(const fs::path& file) {
  try {
    const fs::path target = followed(file);
    check_target(file, target);
    // Only trying tells: permissions, read-only and full file systems.
    const TemporaryFile trial(target, file);
    remove_left(target.parent_path());
  } catch (const fs::filesystem_error& error) {
    throw OutputError(file.string(), error.code().message());
  }
}

void write_whole_file(const fs::path& file, const std::function<void(const fs::path& temporary)>& write) {
  try {
    const fs::path target = followed(file);
    check_target(file, target);
    const TemporaryFile temporary(target, file);
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

// The targets of one folder, and the temporary folder beside them.
struct WholeFiles::Folder {
  PartialFolder temporary;
  std::vector<fs::path> targets;
};

WholeFiles::WholeFiles() = default;

WholeFiles::~WholeFiles() = default;

void WholeFiles::write(const fs::path& file, const std::function<void(const fs::path& temporary)>& write) {
  try {
    const fs::path target = followed(file);
    check_target(file, target);
    std::unique_ptr<Folder>& folder = folders_[fs::canonical(target.parent_path())];
    if (!folder) folder.reset(new Folder{{target, file}, {}});
    const fs::path temporary = folder->temporary.path() / target.filename();
    try {
      write(temporary);
    } catch (const OutputError& error) {
      throw renamed(error, temporary, file);
    }
    if (!fs::exists(temporary)) throw OutputError(file.string(), "nothing was written");
    if (fs::exists(target)) fs::permissions(temporary, fs::status(target).permissions());
    folder->targets.push_back(target);
  } catch (const std::system_error& error) {
    throw OutputError(file.string(), "cannot be written: " + error.code().message());
  }
}

void WholeFiles::publish() {
  for (const auto& [path, folder] : folders_) {
    try {
      for (const fs::path& target : folder->targets) check_target(target, target);
      flush_to_disk(folder->temporary.path(), path);
    } catch (const std::system_error& error) {
      throw OutputError(path.string(), "cannot be written: " + error.code().message());
    }
  }
  std::vector<std::unique_ptr<FolderLock>> locks;
  for (const auto& [path, folder] : folders_) locks.push_back(std::make_unique<FolderLock>(path));
  for (const auto& [path, folder] : folders_) {
    for (const fs::path& target : folder->targets) {
      const fs::path temporary = folder->temporary.path() / target.filename();
      if (rename(temporary.c_str(), target.c_str()) != 0) fail_writing(target, "cannot be replaced", errno);
    }
  }
  for (const auto& [path, folder] : folders_) flush_to_disk(path, path);
  folders_.clear();
}

}  // namespace patchlight
