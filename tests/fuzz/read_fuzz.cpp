// Any bytes read as a model of the format PATCHLIGHT_FUZZ_FORMAT give a scene that passes its own check, or an
// InputError of one line and a hint that names the file. For mtl, the bytes are the material file of an OBJ file with
// one face.
#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"

#include "message.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <unistd.h>

using namespace patchlight;

namespace {

constexpr std::string_view format = PATCHLIGHT_FUZZ_FORMAT;

// Files in memory, to avoid disk accesses.
std::string file_named(std::string_view extension) {
  return "/dev/shm/patchlight_fuzz_" + std::to_string(::getpid()) + "." + std::string(extension);
}

const std::string fuzzed = file_named(format);
const std::string model = file_named(format == "mtl" ? "obj" : format);

void remove_files() {
  std::remove(fuzzed.c_str());
  std::remove(model.c_str());
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (format == "mtl") {
    std::ofstream(model) << "mtllib " << fuzzed.substr(fuzzed.rfind('/') + 1)
                         << "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  }
  return std::atexit(remove_files);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  std::ofstream(fuzzed, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  try {
    const Scene scene = read_scene(model);
    check(scene);
    if (scene.sha256.empty() || scene.file != model) std::abort();
  } catch (const InputError& error) {
    const std::string message = error.what();
    const bool is_named = message.find(fuzzed) == 0 || message.find(model) == 0;
    if (!is_named || !is_good_message(message)) std::abort();
  }
  return 0;
}
