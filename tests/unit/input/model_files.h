#pragma once

#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"

#include "support/diagnostics_of.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>
#include <vector>

namespace patchlight {

/// The message of InputError for this file. The test fails if the file can be read.
inline std::string refusal(const std::filesystem::path& file, const ReadOptions& options = {}) {
  try {
    read_scene(file, options);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << file << " was read";
  return {};
}

using test::has;

/// Sum of the counts in the diagnostics of a code.
inline std::size_t number_of(const Scene& scene, DiagnosticCode code) {
  std::size_t number = 0;
  for (const Diagnostic& found : scene.diagnostics) number += found.code == code ? found.count : 0;
  return number;
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

/// A PNG of 8 bits per channel in sRGB, row by row: red, green, blue, and alpha with four channels. PNG specification,
/// sections 5 and 10, with stored blocks (RFC 1951, section 3.2.4).
inline std::string png_of(std::uint32_t width, std::uint32_t height, const std::string& pixels,
                          std::size_t channels = 3) {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFFU);
    return bytes;
  };
  const auto chunk = [&](const std::string& name_and_bytes) {
    std::uint32_t crc = ~0U;
    for (const char byte : name_and_bytes) {
      crc ^= static_cast<unsigned char>(byte);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1U ^ (0xEDB88320U & (0U - (crc & 1U)));
    }
    return number(static_cast<std::uint32_t>(name_and_bytes.size() - 4)) + name_and_bytes + number(~crc);
  };
  std::string rows;
  for (std::uint32_t row = 0; row < height; ++row)
    rows += std::string(1, '\0') + pixels.substr(channels * row * width, channels * width);
  std::uint32_t low = 1;
  std::uint32_t high = 0;
  for (const char byte : rows) {
    low = (low + static_cast<unsigned char>(byte)) % 65521U;
    high = (high + low) % 65521U;
  }
  const auto size = static_cast<std::uint32_t>(rows.size());  // at most 65535
  std::string stored = "\x78\x01\x01";
  for (const std::uint32_t value : {size, ~size}) {
    stored += static_cast<char>(value & 0xFFU);
    stored += static_cast<char>(value >> 8U & 0xFFU);
  }
  stored += rows + number(high << 16U | low);
  const std::string form(channels == 4 ? "\x08\x06\0\0\0" : "\x08\x02\0\0\0", 5);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR" + number(width) + number(height) + form) + chunk("IDAT" + stored) +
         chunk("IEND");
}

/// A test with its own folder for small model files, which is removed afterwards.
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
