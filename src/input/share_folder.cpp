#include "input/share_folder.h"

#include <cstdlib>
#include <dlfcn.h>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

// The program's file and that of the shared library with this code, which may be Python's module.
std::vector<fs::path> own_files() {
  std::error_code error;
  std::vector<fs::path> files = {fs::read_symlink("/proc/self/exe", error)};
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&shared_file), &info) != 0 && info.dli_fname != nullptr) {
    files.push_back(fs::canonical(info.dli_fname, error));
  }
  return files;
}

// $XDG_DATA_DIRS (XDG Base Directory Specification)
std::vector<fs::path> data_folders() {
  const char* const stated = std::getenv("XDG_DATA_DIRS");
  std::istringstream list(stated != nullptr && *stated != '\0' ? stated : "/usr/local/share:/usr/share");
  std::vector<fs::path> folders;
  for (std::string folder; std::getline(list, folder, ':');)
    if (fs::path(folder).is_absolute()) folders.emplace_back(folder);
  return folders;
}

}  // namespace

fs::path shared_file(const fs::path& name) {
  std::vector<fs::path> folders;
  for (const fs::path& file : own_files()) {
    for (fs::path above = file.parent_path(); above.has_relative_path(); above = above.parent_path())
      folders.push_back(above / "share");
  }
  for (const fs::path& folder : data_folders()) folders.push_back(folder);
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::path found = fs::canonical(folder / "patchlight" / name, error);
    if (!error && fs::is_regular_file(found, error)) return found;
  }
  return {};
}

}  // namespace patchlight
