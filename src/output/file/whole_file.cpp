#include "output/file/whole_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace patchlight {
namespace {

// The prefix of the names of all temporary files and folders.
constexpr std::string_view temporary_prefix = ".patchlight-";

namespace fs = std::filesystem;

// A name beside `file` that no other process and no other call uses. The extension stays, as writers look at it.
fs::path temporary_beside(const fs::path& file) {
  static std::atomic<unsigned> calls{0};
  const std::string name = std::string(temporary_prefix) + std::to_string(getpid()) + "-" + std::to_string(calls++);
  return file.parent_path() / (name + file.extension().string());
}

// The same error for a user who does not know of the temporary folder: its path is replaced by `known`.
OutputError renamed(const OutputError& error, const fs::path& temporary, const fs::path& known) {
  const std::string text = error.what();
  if (!text.starts_with(temporary.string())) return error;
  const std::string rest = text.substr(temporary.string().size());
  const std::size_t colon = std::min(rest.size(), rest.find(": "));
  return {known.string() + rest.substr(0, colon), rest.substr(std::min(rest.size(), colon + 2))};
}

// Throws OutputError with the meaning of the system's error number.
void fail_writing(const fs::path& file, const std::string& message, int error_number) {
  throw OutputError(file.string(), message + ": " + std::strerror(error_number));
}

// Makes sure that a file or folder is on disk. `file` is the name that the user knows. Throws OutputError.
void flush_to_disk(const fs::path& path, const fs::path& file) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail_writing(file, "cannot be written", errno);
  // Some file systems cannot flush a folder: EINVAL.
  const int error_number = fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;
  close(descriptor);
  if (error_number != 0) fail_writing(file, "cannot be written to disk", error_number);
}

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

// Removes temporary files and folders of killed runs from a folder. One whose lock can be had belongs to nobody.
void remove_left(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().filename().string().starts_with(temporary_prefix)) remove_if_left(entry.path());
  }
}

enum class Kind { file, folder };

// An empty file or folder beside `target`, locked as long as this lives: an unlocked one was left by a run that was
// killed. The destructor removes the file or folder that has the temporary name: after an exchange, the older one.
class Temporary {
 public:
  // `known` is the name that the user knows. \throws OutputError.
  Temporary(const fs::path& target, const fs::path& known, Kind kind) {
    const bool is_folder = kind == Kind::folder;
    const int flags = O_CLOEXEC | (is_folder ? O_RDONLY | O_DIRECTORY | O_NOFOLLOW : O_WRONLY | O_CREAT | O_EXCL);
    for (int tries = 0; !is_locked(); ++tries) {
      path_ = temporary_beside(target);
      if (is_folder) path_.replace_extension(partial_extension);
      if (!is_folder || mkdir(path_.c_str(), 0777) == 0) descriptor_ = open(path_.c_str(), flags, 0666);
      // A name that is taken is another program's.
      const bool is_taken = descriptor_ < 0 && errno == EEXIST && tries < 1000;
      if (descriptor_ < 0 && !is_taken)
        fail_writing(known, is_folder ? "cannot write into the folder above it" : "cannot write into this folder",
                     errno);
    }
  }
  ~Temporary() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    close(descriptor_);
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  const fs::path& path() const { return path_; }

 private:
  // False when another run took it for a left one before it was locked. Some file systems have no locks; then no run
  // can take it for a left one either.
  bool is_locked() {
    if (descriptor_ < 0) return false;
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

// Keeps other runs from renaming at the same time, so that the files of one folder are those of one run. After two
// seconds a run goes on without the lock: another program may hold it.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    for (int k = 0; k < 200 && flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ~FolderLock() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

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

fs::path followed(const fs::path& file) {
  if (file.empty()) throw OutputError("output", "the name of the file to write is empty");
  // Link by link, as many as Linux follows: the last may name a file that is not there yet.
  fs::path target = fs::absolute(file);
  std::error_code error;
  for (int k = 0; k < 40; ++k) {
    if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
    const fs::path next = fs::read_symlink(target, error);
    if (error) break;
    target = target.parent_path() / next;
  }
  throw OutputError(file.string(), "is a link that leads nowhere: too many links follow one another");
}

void check_writable(const fs::path& file) {
  try {
    const fs::path target = followed(file);
    check_target(file, target);
    // Permissions, read-only and full file systems show up only in a trial.
    const Temporary trial(target, file, Kind::file);
    remove_left(target.parent_path());
  } catch (const fs::filesystem_error& error) {
    throw OutputError(file.string(), error.code().message());
  }
}

void write_whole_file(const fs::path& file, const std::function<void(const fs::path& temporary)>& write) {
  try {
    const fs::path target = followed(file);
    check_target(file, target);
    const Temporary temporary(target, file, Kind::file);
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
  Temporary temporary;
  std::vector<fs::path> targets;
};

WholeFiles::WholeFiles() = default;

WholeFiles::~WholeFiles() = default;

void WholeFiles::write(const fs::path& file, const std::function<void(const fs::path& temporary)>& write) {
  try {
    const fs::path target = followed(file);
    check_target(file, target);
    std::unique_ptr<Folder>& folder = folders_[fs::canonical(target.parent_path())];
    if (!folder) folder.reset(new Folder{{target, file, Kind::folder}, {}});
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

void check_folder_writable(const fs::path& folder, const MayReplace& may_replace) {
  try {
    const fs::path target = folder_path(folder);
    check_target(folder, target, may_replace);
    const Temporary trial(target, folder, Kind::folder);
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
    const Temporary temporary(target, folder, Kind::folder);
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

void write_stream(const fs::path& file, const std::function<void(std::ostream& stream)>& write) {
  write_whole_file(file, [&](const fs::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    write(stream);
    // A full disk may show on closing only.
    stream.close();
    if (!stream) fail_writing(file, "cannot be written", errno);
  });
}

void write_bytes(const fs::path& file, std::string_view bytes) {
  write_stream(file, [bytes](std::ostream& stream) { stream << bytes; });
}

std::string replaced(std::string_view text, std::initializer_list<std::pair<char, std::string_view>> words) {
  std::string out;
  out.reserve(text.size());
  for (const char letter : text) {
    const auto* const found =
        std::find_if(words.begin(), words.end(), [letter](const auto& word) { return word.first == letter; });
    found == words.end() ? out.append(1, letter) : out.append(found->second);
  }
  return out;
}

std::string csv_cell(const std::string& name) {
  const bool is_formula = !name.empty() && std::string("=+-@\t\r\n").find(name[0]) != std::string::npos;
  const std::string text = is_formula ? "'" + name : name;
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (const char letter : text) quoted.append(letter == '"' ? 2 : 1, letter);
  return quoted + '"';
}

std::string csv_cell(double number) {
  if (!std::isfinite(number)) return {};
  std::ostringstream text;
  text.precision(9);
  text << number;
  return text.str();
}

}  // namespace patchlight
