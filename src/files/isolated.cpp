#include "files/isolated.h"

#include "patchlight/base/error.h"

#include "files/reason.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <fstream>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <string_view>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace patchlight {
namespace {

constexpr std::uint64_t reading_files = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t changing_files = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                                         LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                                         LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                                         LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
                                         LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

// landlock(7); not available before Linux 5.13.
void confine_files(const std::vector<std::filesystem::path>& readable) {
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = reading_files | changing_files;
  const auto rules = static_cast<int>(syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0));
  if (rules < 0) return;
  for (const std::filesystem::path& folder : readable) {
    landlock_path_beneath_attr rule{};
    rule.allowed_access = reading_files;
    rule.parent_fd = open(folder.c_str(), O_PATH | O_CLOEXEC);
    if (rule.parent_fd < 0) continue;
    syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    ::close(rule.parent_fd);
  }
  syscall(SYS_landlock_restrict_self, rules, 0);
  ::close(rules);
}

// seccomp(2): socket() fails with EACCES; other calls are unaffected.
void forbid_sockets() {
  std::array<sock_filter, 4> filter = {{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                                        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_socket, 0, 1),
                                        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES),
                                        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)}};
  const sock_fprog program = {filter.size(), filter.data()};
  prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

// Restricts this process and its children, as far as the kernel supports it (Landlock, seccomp): no new sockets, no
// writing of files, reading only in these folders. Open files stay usable.
void confine_process(const std::vector<std::filesystem::path>& readable) {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return;
  confine_files(readable);
  forbid_sockets();
}

// The first byte of the child's message.
constexpr char sends_result = 'S';
constexpr char sends_refusal = 'R';  // text of an InputError
constexpr char sends_failure = 'F';  // text of another exception

constexpr rlim_t bytes_per_byte_of_file = 300;
constexpr rlim_t bytes_of_file_per_second = 100'000;

// Limits the additional memory of this process.
void limit_memory(rlim_t bytes_of_file, rlim_t most_bytes) {
  // proc(5): sizes in pages: program, resident, shared, text, lib, data and stack
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  for (int field = 0; field < 6; ++field) statm >> pages;
  if (!statm) return;
  const rlim_t more = most_bytes + bytes_per_byte_of_file * bytes_of_file;
  const rlim_t bytes = pages * static_cast<rlim_t>(sysconf(_SC_PAGE_SIZE)) + more;
  const rlimit limit = {bytes, bytes};
  setrlimit(RLIMIT_DATA, &limit);
}

// A child ends with its parent, without terminal output or a core dump.
void prepare_child(const std::string& file, const ChildLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGALRM}) {
    // Signals that the caller ignores stay ignored.
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  const rlim_t bytes_of_file = error ? 0 : size;
  const rlim_t most_seconds = limits.seconds + bytes_of_file / bytes_of_file_per_second;
  const rlimit seconds = {most_seconds, most_seconds};
  setrlimit(RLIMIT_CPU, &seconds);
  const rlimit no_core_dump = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core_dump);
  limit_memory(bytes_of_file, limits.bytes);
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
}

std::string message_from(const std::function<std::string()>& read) {
  try {
    return sends_result + read();
  } catch (const InputError& error) {
    return sends_refusal + std::string(error.what());
  } catch (const std::exception& error) {
    return sends_failure + reason_of(error);
  }
}

bool write_all(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(pipe, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// Stops after `most` bytes: the parent applies the child's memory limit too.
std::string read_all(int pipe, std::uint64_t most) {
  std::string bytes;
  std::array<char, 65536> block{};
  while (true) {
    const ssize_t count = ::read(pipe, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0 || bytes.size() + static_cast<std::size_t>(count) > most) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(count));
  }
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

std::string how_it_ended(int status) {
  if (!WIFSIGNALED(status)) return "the reader of this format gave up";
  if (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL) {
    return "the reader of this format took too much time or memory";
  }
  return std::string("the reader of this format crashed (") + strsignal(WTERMSIG(status)) + ")";
}

// A signal that stops this program also reaches its children: the file is not the cause.
bool was_stopped(int status) {
  if (!WIFSIGNALED(status)) return false;
  const int signal = WTERMSIG(status);
  return signal == SIGTERM || signal == SIGINT || signal == SIGHUP;
}

void require_good_end(const std::string& message, int status, const std::string& file) {
  if (was_stopped(status)) throw Canceled();
  const bool ended_well = WIFEXITED(status) && WEXITSTATUS(status) == 0 && !message.empty();
  if (!ended_well) throw InputError(file, how_it_ended(status) + "; the file is damaged, export it again");
}

// The result in a message, or the exception that it encodes.
std::string result_in(std::string message, int status, const std::string& file) {
  require_good_end(message, status, file);
  const char kind = message[0];
  std::string content = std::move(message.erase(0, 1));
  if (kind == sends_result) return content;
  if (kind == sends_refusal) {
    // The text of an InputError begins with its place, which the constructor adds again.
    const std::string place = file + ": ";
    throw InputError(file, content.starts_with(place) ? content.substr(place.size()) : content);
  }
  throw InputError(file, "cannot be read: " + content + "\nhint: export it again");
}

// A memory file with the text, positioned at its start.
int file_with(const std::string& text) {
  const int file = memfd_create("patchlight", MFD_CLOEXEC);
  if (file < 0 || !write_all(file, text) || lseek(file, 0, SEEK_SET) != 0) {
    throw std::system_error(errno, std::generic_category(), "memfd_create");
  }
  return file;
}

// The message of a child, and its exit status.
struct Sent {
  std::string message;
  int status = 0;
};

// Runs `run` in a child with the write end of a pipe, and returns its message.
Sent sent_by_child(const std::function<int(int)>& run, std::uint64_t most_bytes) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) {
    ::close(ends[0]);
    _exit(run(ends[1]));
  }
  ::close(ends[1]);
  std::string message = read_all(ends[0], most_bytes);
  ::close(ends[0]);
  return {std::move(message), wait_for(child)};
}

// The folders that programs of the system need.
std::vector<std::filesystem::path> readable_folders(const Program& program) {
  std::vector<std::filesystem::path> folders = {"/usr", "/bin", "/lib", "/lib64", "/etc", "/proc", "/sys", "/dev"};
  folders.insert(folders.end(), program.readable.begin(), program.readable.end());
  return folders;
}

}  // namespace

std::string bytes_isolated(const std::string& file, const std::function<std::string()>& read,
                           const ChildLimits& limits) {
  Sent sent = sent_by_child(
      [&](int pipe) {
        prepare_child(file, limits);
        return write_all(pipe, message_from(read)) ? 0 : 1;
      },
      ~std::uint64_t{0});
  return result_in(std::move(sent.message), sent.status, file);
}

std::string output_isolated(const std::string& file, const Program& program, const std::string& input,
                            const ChildLimits& limits) {
  std::vector<char*> words;
  for (const std::string& word : program.command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const std::vector<std::filesystem::path> readable = readable_folders(program);
  const int text = file_with(input);
  char* const no_environment[] = {nullptr};
  const Sent sent = sent_by_child(
      [&](int pipe) {
        prepare_child(file, limits);
        dup2(text, STDIN_FILENO);
        dup2(pipe, STDOUT_FILENO);
        confine_process(readable);
        execve(words[0], words.data(), no_environment);
        return 1;
      },
      limits.bytes);
  ::close(text);
  require_good_end(sent.message, sent.status, file);
  return sent.message;
}

}  // namespace patchlight
