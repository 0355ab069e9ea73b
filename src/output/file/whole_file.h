#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>

namespace patchlight {

/// Lets `write` fill a temporary file beside `file`, flushes it to disk and renames it to `file`: whoever looks sees
/// the old file or the whole new one. When `write` throws, the temporary file is removed and `file` stays as it was.
/// \throws OutputError when the folder is missing or not writable, or `file` is a folder.
void write_whole_file(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// Fails early: \throws OutputError when write_whole_file could not write here.
void check_writable(const std::filesystem::path& file);

/// Files that appear together: all are written into temporary folders beside their places before the first is renamed.
/// What is not published is gone at the end. A run that is killed between the first rename and the last, which follow
/// one another at once, leaves new files and old ones, each of them whole.
class WholeFiles {
 public:
  WholeFiles();
  ~WholeFiles();
  WholeFiles(const WholeFiles&) = delete;
  WholeFiles& operator=(const WholeFiles&) = delete;

  /// Lets `write` make a file of the same name in another folder. \throws OutputError.
  void write(const std::filesystem::path& file,
             const std::function<void(const std::filesystem::path& temporary)>& write);

  /// Renames all files, folder by folder; two runs one after the other. \throws OutputError.
  void publish();

 private:
  struct Folder;
  std::map<std::filesystem::path, std::unique_ptr<Folder>> folders_;
};

}  // namespace patchlight
