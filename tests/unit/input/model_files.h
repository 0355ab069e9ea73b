#pragma once

#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>
#include <vector>

namespace patchlight {

/// What InputError says when the file is read; fails when there is none.
inline std::string refusal(const std::filesystem::path& file, const ReadOptions& options = {}) {
  try {
    read_scene(file, options);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << file << " was read";
  return {};
}

inline bool any_contains(const std::vector<std::string>& texts, const std::string& part) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

/// A PNG of two pixels, black and red, green, blue = 255, 0, 128 in sRGB.
inline std::string two_pixels() {
  const std::string hexadecimal =
      "89504e470d0a1a0a0000000d49484452000000020000000108020000007b40e8dd0000000f4944415478da63606060f8cfd000000384018"
      "0be6d0c380000000049454e44ae426082";
  std::string bytes;
  for (std::size_t k = 0; k < hexadecimal.size(); k += 2)
    bytes += static_cast<char>(std::stoi(hexadecimal.substr(k, 2), nullptr, 16));
  return bytes;
}

/// A test with a folder of its own for small model files; it is removed afterwards.
class ModelFiles : public ::testing::Test {
 protected:
  ModelFiles() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::path(::testing::TempDir()) / ("patchlight_" + std::to_string(::getpid()) + "_" + test->name());
    std::filesystem::create_directories(folder_);
  }
  ~ModelFiles() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  std::filesystem::path folder_;
};

}  // namespace patchlight
