#include "input/isolated.h"

#include "patchlight/base/error.h"

#include "input/scene_bytes.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <new>
#include <string_view>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

namespace patchlight {
namespace {

// The first byte of what the child sends.
constexpr char sends_scene = 'S';
constexpr char sends_refusal = 'R';  // the text of an InputError
constexpr char sends_failure = 'F';  // any other exception's

constexpr rlim_t bytes_per_byte_of_file = 300;

// Limits the memory that this process takes beyond what it has.
void limit_memory(const std::string& file, rlim_t most_bytes) {
  // proc(5): the sizes, in pages, of the program, what is resident, shared, text, lib, data and stack
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  for (int field = 0; field < 6; ++field) statm >> pages;
  if (!statm) return;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  const rlim_t more = most_bytes + (error ? 0 : bytes_per_byte_of_file * size);
  const rlim_t bytes = pages * static_cast<rlim_t>(sysconf(_SC_PAGE_SIZE)) + more;
  const rlimit limit = {bytes, bytes};
  setrlimit(RLIMIT_DATA, &limit);
}

// A child ends with its parent, without a trace on the terminal or the disk.
void prepare_child(const std::string& file, const ChildLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGALRM}) {
    // What the caller ignores stays ignored.
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
  const rlimit seconds = {limits.seconds, limits.seconds};
  setrlimit(RLIMIT_CPU, &seconds);
  const rlimit no_core_dump = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core_dump);
  limit_memory(file, limits.bytes);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
}

std::string message_from(const std::function<Scene()>& read) {
  try {
    return sends_scene + scene_bytes(read());
  } catch (const InputError& error) {
    return sends_refusal + std::string(error.what());
  } catch (const std::bad_alloc&) {
    return sends_failure + std::string("the memory does not suffice");
  } catch (const std::exception& error) {
    return sends_failure + std::string(error.what());
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

std::string read_all(int pipe) {
  std::string bytes;
  std::array<char, 65536> block{};
  while (true) {
    const ssize_t count = ::read(pipe, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
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

Scene scene_from(const std::string& message, int status, const std::string& file) {
  const bool ended_well = WIFEXITED(status) && WEXITSTATUS(status) == 0 && !message.empty();
  if (!ended_well) throw InputError(file, how_it_ended(status) + "; the file is damaged, export it anew");
  const std::string_view content = std::string_view(message).substr(1);
  if (message[0] == sends_scene) {
    try {
      return scene_from_bytes(content);
    } catch (const std::exception& error) {
      throw InputError(file, std::string("the reader of this format was damaged: ") + error.what());
    }
  }
  if (message[0] == sends_refusal) {
    // The InputError is put together again from its two parts.
    const std::string place = file + ": ";
    throw InputError(file, std::string(content.starts_with(place) ? content.substr(place.size()) : content));
  }
  throw InputError(file, "cannot be read: " + std::string(content) + "; export it anew");
}

}  // namespace

Scene read_isolated(const std::string& file, const std::function<Scene()>& read, const ChildLimits& limits) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) {
    ::close(ends[0]);
    prepare_child(file, limits);
    _exit(write_all(ends[1], message_from(read)) ? 0 : 1);
  }
  ::close(ends[1]);
  const std::string message = read_all(ends[0]);
  ::close(ends[0]);
  return scene_from(message, wait_for(child), file);
}

}  // namespace patchlight
