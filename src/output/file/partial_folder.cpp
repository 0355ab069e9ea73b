#include "output/file/partial_folder.h"

#include "output/file/temporary.h"

#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* partial_extension = ".partial";

// An unlocked file, or an unlocked folder with our extension.
void remove_if_left(const fs::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  std::error_code ignored;
  struct stat status {};
  const bool is_known = fstat(descriptor, &status) == 0;
  const bool is_ours =
      is_known && (S_ISREG(status.st_mode) || (S_ISDIR(status.st_mode) && path.extension() == partial_extension));
  if (is_ours && flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove_all(path, ignored);
  close(descriptor);
}

}  // namespace

PartialFolder::PartialFolder(const fs::path& target, const fs::path& known) {
  // A name that is taken is another program's.
  for (int tries = 0; descriptor_ < 0; ++tries) {
    path_ = temporary_beside(target).replace_extension(partial_extension);
    if (mkdir(path_.c_str(), 0777) != 0) {
      if (errno == EEXIST && tries < most_tries) continue;
      fail_writing(known, "cannot write into the folder above it", errno);
    }
    descriptor_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor_ < 0) fail_writing(known, "cannot write into the folder above it", errno);
    // Some file systems know no locks; then nobody can take the folder for a left one either. Another run may have done
    // so before it was locked.
    flock(descriptor_, LOCK_EX);
    struct stat status {};
    if (fstat(descriptor_, &status) == 0 && status.st_nlink == 0) {
      close(descriptor_);
      descriptor_ = -1;
    }
  }
}

PartialFolder::~PartialFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  close(descriptor_);
}

void remove_left(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().filename().string().starts_with(temporary_prefix)) remove_if_left(entry.path());
  }
}

}  // namespace patchlight
