// Any bytes as a file of the format PATCHLIGHT_FUZZ_FORMAT (a scene file, a photometric file, a weather file, a
// spectrum, an array of numpy) are understood, or refused by an InputError of one line.
#include "patchlight/base/error.h"

#include "archive/npy.h"
#include "input/read_epw.h"
#include "input/read_ies.h"
#include "input/read_spectrum.h"
#include "input/scene_file.h"
#include "scene/photometric_web.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <unistd.h>

using namespace patchlight;

namespace {

constexpr std::string_view format = PATCHLIGHT_FUZZ_FORMAT;

// A folder in memory, so that the disk is left alone; a scene file may read nothing outside of it.
const std::filesystem::path folder = "/dev/shm/patchlight_fuzz_" + std::to_string(::getpid());
const std::filesystem::path fuzzed = folder / ("fuzzed." + std::string(format));

void remove_folder() { std::filesystem::remove_all(folder); }

void read(const std::string& text) {
  if (format == "ies") {
    parse_ies(text, fuzzed.string());
  } else if (format == "epw") {
    parse_epw(text, fuzzed.string(), {2001, 6, 21, 11});
  } else if (format == "spd") {
    parse_spectrum(text, fuzzed);
  } else if (format == "toml") {
    read_scene_file(fuzzed, folder);
  } else {
    NpyReader reader(fuzzed);
    if (reader.rows() > 0) reader.next_rows(reader.rows());
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  std::filesystem::create_directory(folder);
  return std::atexit(remove_folder);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  std::ofstream(fuzzed, std::ios::binary) << text;
  try {
    read(text);
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.empty() || message.find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
