// Counts the process's calls of the functions below, which rename, remove, create and flush files and folders, and
// kills it just before call number KILL_AT_CALL. Loaded in front of the C library (LD_PRELOAD), so that a test can stop
// a run between any two of them.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

void count_call() {
  static const char* const wanted = std::getenv("KILL_AT_CALL");
  static const int last = wanted != nullptr ? std::atoi(wanted) : 0;
  static int calls = 0;
  if (++calls == last) std::raise(SIGKILL);
}

template <typename Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int rename(const char* from, const char* to) noexcept {
  count_call();
  return next<int (*)(const char*, const char*)>("rename")(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  count_call();
  return next<int (*)(int, const char*, int, const char*, unsigned)>("renameat2")(from_folder, from, to_folder, to,
                                                                                  flags);
}

int unlink(const char* path) noexcept {
  count_call();
  return next<int (*)(const char*)>("unlink")(path);
}

int unlinkat(int folder, const char* path, int flags) noexcept {
  count_call();
  return next<int (*)(int, const char*, int)>("unlinkat")(folder, path, flags);
}

int remove(const char* path) noexcept {
  count_call();
  return next<int (*)(const char*)>("remove")(path);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  count_call();
  return next<int (*)(int, const char*, int, const char*)>("renameat")(from_folder, from, to_folder, to);
}

int rmdir(const char* path) noexcept {
  count_call();
  return next<int (*)(const char*)>("rmdir")(path);
}

int mkdir(const char* path, mode_t mode) noexcept {
  count_call();
  return next<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}

int fsync(int file) {
  count_call();
  return next<int (*)(int)>("fsync")(file);
}
}
