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
