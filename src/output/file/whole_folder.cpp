#include "output/file/whole_folder.h"

#include "patchlight/base/error.h"

#include "output/file/partial_folder.h"
#include "output/file/temporary.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/file.h>
#include <system_error>
#include <unistd.h>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

// The folder itself, absolute, without a slash at its end.
fs::path folder_path(const fs::path& folder) {
  const fs::path path = followed(folder).lexically_normal();
  return path.filename().empty() ? path.parent_path() : path;
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

// Afterwards the new folder bears the name, and the old one, if any, that of the new.
void swap_folders(const fs::path& fresh, const fs::path& target, const fs::path& folder) {
  // An empty folder, or none, is replaced at once.
  if (rename(fresh.c_str(), target.c_str()) == 0) return;
  if (renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
  // Some file systems cannot exchange: then for a moment there is neither.
  const fs::path old = temporary_beside(target).replace_extension(fresh.extension());
  if (rename(target.c_str(), old.c_str()) != 0) fail_writing(folder, "cannot be replaced", errno);
  fs::rename(fresh, target);
  fs::remove_all(old);
}

}  // namespace

void check_folder_writable(const fs::path& folder, const MayReplace& may_replace) {
  try {
    const fs::path target = folder_path(folder);
    check_target(folder, target, may_replace);
    const PartialFolder trial(target, folder);
    remove_left(target.parent_path());
  } catch (const fs::filesystem_error& error) {
    throw OutputError(folder.string(), error.code().message());
  }
}

bool holds_result(const fs::path& folder, const FolderResult& result) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (std::find(result.names.begin(), result.names.end(), name) == result.names.end()) return false;
  }
  std::ifstream stream(folder / result.facts_file);
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  return json.is_object() && json.value("kind", nlohmann::json()) == result.kind;
}

void write_whole_folder(const fs::path& folder, const MayReplace& may_replace,
                        const std::function<void(const fs::path& temporary)>& write) {
  try {
    const fs::path target = folder_path(folder);
    check_target(folder, target, may_replace);
    const PartialFolder temporary(target, folder);
    try {
      write(temporary.path());
    } catch (const OutputError& error) {
      throw renamed(error, temporary.path(), (folder / "").parent_path());
    }
    flush_to_disk(temporary.path(), folder);
    swap_folders(temporary.path(), target, folder);
    flush_to_disk(target.parent_path(), folder);
  } catch (const std::system_error& error) {
    throw OutputError(folder.string(), "cannot be written: " + error.code().message());
  }
}

}  // namespace patchlight
