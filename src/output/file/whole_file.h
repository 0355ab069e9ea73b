#pragma once

#include "patchlight/base/error.h"

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace patchlight {

/// The absolute path of the file. A symbolic link is resolved, also if its target does not exist yet, as renaming would
/// replace the link. \throws OutputError if the name is empty, or links form a circle.
std::filesystem::path followed(const std::filesystem::path& file);

/// Calls `write` for a temporary file beside `file`, flushes it to disk and renames it to `file`. A reader sees the old
/// file or the whole new one. If `write` throws, the temporary file is removed and `file` stays unchanged. \throws
/// OutputError if the folder is missing or not writable, or `file` is a folder.
void write_whole_file(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// Fails early: \throws OutputError when write_whole_file could not write here.
void check_writable(const std::filesystem::path& file);

/// Files that appear together: all are written to temporary folders beside their places before the first is renamed.
/// The destructor removes unpublished files. A run that is killed between the first rename and the last leaves both new
/// and old files, each of them whole.
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

/// True for a folder that may be replaced: one with an earlier result.
using MayReplace = std::function<bool(const std::filesystem::path& folder)>;

/// A result that has a folder of its own.
struct FolderResult {
  std::string facts_file;          ///< JSON
  std::string kind;                ///< its entry "kind"
  std::vector<std::string> names;  ///< of all that may be there
};

/// True for a folder that holds such a result, and nothing that was not written with it.
bool holds_result(const std::filesystem::path& folder, const FolderResult& result);

/// Calls `write` for a temporary folder beside `folder` and renames it to `folder`. A reader sees the old folder or the
/// whole new one. If `write` throws, the temporary folder is removed and `folder` stays unchanged. \throws OutputError
/// if the place is not writable, or `folder` is a file or holds files that may not be replaced.
void write_whole_folder(const std::filesystem::path& folder, const MayReplace& may_replace,
                        const std::function<void(const std::filesystem::path& temporary)>& write);

/// Fails early: \throws OutputError when write_whole_folder could not write here. Removes leftovers of killed runs.
void check_folder_writable(const std::filesystem::path& folder, const MayReplace& may_replace);

/// Lets `write` fill a whole file, see write_whole_file(). \throws OutputError, also when the disk is full.
void write_stream(const std::filesystem::path& file, const std::function<void(std::ostream& stream)>& write);

/// Writes `bytes` as a whole file. \throws OutputError.
void write_bytes(const std::filesystem::path& file, std::string_view bytes);

/// The text with words in place of some letters.
std::string replaced(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> words);

/// A name as a cell of a CSV file (RFC 4180): in quotes where a comma, a quote or a line break would end it early.
/// Before a first letter that makes spreadsheets take a cell for a formula (= + - @, tab, line break) stands an
/// apostrophe, so that it is text.
std::string csv_cell(const std::string& name);

/// A number as a cell, with nine digits; an empty cell stands for one that is not finite.
std::string csv_cell(double number);

}  // namespace patchlight
