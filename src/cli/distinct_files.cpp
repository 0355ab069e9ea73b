#include "cli/distinct_files.h"

#include "cli/arguments.h"
#include "output/file/whole_file.h"

#include <algorithm>
#include <optional>
#include <sys/stat.h>
#include <tuple>

namespace patchlight::cli {
namespace {

using std::filesystem::path;

// Device, inode and an empty name; for a missing file, those of its folder and its name.
using Identity = std::tuple<dev_t, ino_t, std::string>;

std::optional<Identity> identity_of(const path& file, const std::string& name = {}) {
  struct stat status {};
  if (stat(file.empty() ? "." : file.c_str(), &status) != 0) return std::nullopt;
  return Identity{status.st_dev, status.st_ino, name};
}

std::optional<Identity> identity_of_output(const path& file) {
  const path target = followed(file);
  if (std::optional<Identity> identity = identity_of(target)) return identity;
  return identity_of(target.parent_path(), target.filename().string());
}

[[noreturn]] void refuse(const OutputFile& output, const std::string& reason) {
  throw UsageError(output.option + ": '" + output.file.string() + "' " + reason);
}

}  // namespace

void require_distinct(const std::vector<OutputFile>& outputs) {
  std::vector<std::pair<Identity, const OutputFile*>> seen;
  for (const OutputFile& output : outputs) {
    if (output.file.empty()) continue;
    const std::optional<Identity> identity = identity_of_output(output.file);
    if (!identity) continue;
    for (const auto& [other, where] : seen) {
      if (other == *identity) refuse(output, "is also " + where->option + "; expected different files");
    }
    seen.emplace_back(*identity, &output);
  }
}

void require_not_read(const std::vector<OutputFile>& outputs, const std::vector<path>& inputs) {
  for (const OutputFile& output : outputs) {
    if (output.file.empty()) continue;
    const std::optional<Identity> identity = identity_of_output(output.file);
    if (!identity) continue;
    const auto is_same = [&](const path& input) { return identity_of(input) == identity; };
    const auto input = std::find_if(inputs.begin(), inputs.end(), is_same);
    if (input == inputs.end()) continue;
    refuse(output, "is also read (" + input->string() + "); expected another file for the result");
  }
}

void require_not_read_from(const OutputFile& output, const std::vector<path>& inputs) {
  const std::optional<Identity> folder = identity_of(output.file);
  if (!folder) return;
  for (const path& input : inputs) {
    std::error_code error;
    path place = std::filesystem::canonical(input, error);
    while (!error && place != place.root_path()) {
      place = place.parent_path();
      if (identity_of(place) != folder) continue;
      refuse(output, "holds a file that is read (" + input.string() + "); expected another folder for the result");
    }
  }
}

}  // namespace patchlight::cli
