#pragma once

#include <filesystem>

namespace patchlight {

/// A new folder beside `target`, locked as long as this lives: an unlocked one was left by a run that was killed.
/// Whatever bears its name at the end is removed.
class PartialFolder {
 public:
  /// `known` is the name that the user knows. \throws OutputError.
  PartialFolder(const std::filesystem::path& target, const std::filesystem::path& known);
  ~PartialFolder();
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// Removes temporary files and folders of killed runs from a folder. One whose lock can be had belongs to nobody.
void remove_left(const std::filesystem::path& folder);

}  // namespace patchlight
