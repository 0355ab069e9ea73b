// Any bytes read as a model of the format PATCHLIGHT_FUZZ_FORMAT give a scene that passes its own check, or an
// InputError of one line that names the file.
#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <unistd.h>

using namespace patchlight;

namespace {

// In memory, so that the disk is left alone; removed when the process ends.
const std::string& model_file() {
  static const std::string file =
      "/dev/shm/patchlight_fuzz_" + std::to_string(::getpid()) + "." + PATCHLIGHT_FUZZ_FORMAT;
  static const int registered = std::atexit([] { std::remove(file.c_str()); });
  static_cast<void>(registered);
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  std::ofstream(model_file(), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  try {
    const Scene scene = read_scene(model_file());
    check(scene);
    if (scene.sha256.empty() || scene.file != model_file()) std::abort();
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.find(model_file()) != 0 || message.find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
