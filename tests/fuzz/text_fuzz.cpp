// Any bytes read as a file of the format PATCHLIGHT_FUZZ_FORMAT are accepted, or refused with an InputError of one
// line and a hint. The formats are scene files, photometric files, weather files, spectra, points, NumPy arrays,
// solutions, and the two JSON files of stored form factors. VTK may crash in its process, but sanitizers may not end
// it.
#include "patchlight/base/error.h"

#include "archive/form_factor_files.h"
#include "archive/npy.h"
#include "archive/scene_file.h"
#include "input/tables/read_tables.h"
#include "input/toml/scene_file.h"
#include "message.h"
#include "output/vtk/read_vtk.h"
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

// A folder in memory, to avoid disk accesses; a scene file may read nothing outside of it.
const std::filesystem::path folder = "/dev/shm/patchlight_fuzz_" + std::to_string(::getpid());
const std::filesystem::path fuzzed = folder / ("fuzzed." + std::string(format));

void remove_folder() { std::filesystem::remove_all(folder); }

// A file of stored form factors with this name.
template <typename Read>
void read_as(const char* name, const std::string& text, const Read& read) {
  std::ofstream(folder / name, std::ios::binary) << text;
  try {
    read(folder);
  } catch (const InputError&) {
  }
}

void read(const std::string& text) {
  if (format == "ies") {
    parse_ies(text, fuzzed.string());
  } else if (format == "epw") {
    parse_epw(text, fuzzed.string(), {2001, 6, 21, 11});
  } else if (format == "spd") {
    parse_spectrum(text, fuzzed);
  } else if (format == "toml") {
    read_scene_file(fuzzed, folder);
  } else if (format == "pts") {
    parse_points(text, fuzzed, 1);
  } else if (format == "vtp") {
    read_vtk(fuzzed);
  } else if (format == "json") {
    read_as("info.json", text, read_form_factor_info);
    read_as("scene.json", text, read_stored_scene);
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
    const bool is_of_sanitizer =
        format == "vtp" && message.find("the reader of this format gave up") != std::string::npos;
    if (!is_good_message(message) || is_of_sanitizer) std::abort();
  }
  return 0;
}
