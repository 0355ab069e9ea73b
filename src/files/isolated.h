#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace patchlight {

/// Serializes values in their memory layout, for a process of the same program.
class MessageWriter {
 public:
  template <typename Value>
  void plain(const Value& value) {
    static_assert(std::is_arithmetic_v<Value>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void text(const std::string& text) {
    plain(text.size());
    bytes_ += text;
  }
  template <typename Vector>
  void numbers(const Vector& values) {
    plain(static_cast<std::size_t>(values.size()));
    for (const auto value : values) plain(value);
  }
  void texels(const std::vector<std::array<float, 3>>& texels) {
    plain(texels.size());
    bytes_.append(reinterpret_cast<const char*>(texels.data()), texels.size() * sizeof texels[0]);
  }
  void field(const Field& values) {
    plain(values.rows());
    plain(values.cols());
    bytes_.append(reinterpret_cast<const char*>(values.data()),
                  static_cast<std::size_t>(values.size()) * sizeof(double));
  }
  std::string bytes() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Deserializes them in the same order. \throws std::runtime_error past the end.
class MessageReader {
 public:
  explicit MessageReader(std::string_view bytes) : bytes_(bytes) {}
  template <typename Value>
  Value plain() {
    if (bytes_.size() < sizeof(Value)) throw std::runtime_error("a message ends early");
    Value value;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }
  /// The number of following items, each of at least one byte.
  std::size_t count() {
    const auto count = plain<std::size_t>();
    if (count > bytes_.size()) throw std::runtime_error("a message ends early");
    return count;
  }
  std::string text() {
    const std::size_t size = count();
    std::string text(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return text;
  }
  Spectrum spectrum() {
    Spectrum values(static_cast<Eigen::Index>(count()));
    for (double& value : values) value = plain<double>();
    return values;
  }
  std::vector<std::array<float, 3>> texels() {
    std::vector<std::array<float, 3>> texels(count());
    const std::size_t size = texels.size() * sizeof(std::array<float, 3>);
    if (size > bytes_.size()) throw std::runtime_error("a message ends early");
    if (size > 0) std::memcpy(texels.data(), bytes_.data(), size);
    bytes_.remove_prefix(size);
    return texels;
  }
  Field field() {
    const auto rows = plain<Eigen::Index>();
    const auto columns = plain<Eigen::Index>();
    const auto most = static_cast<Eigen::Index>(bytes_.size() / sizeof(double));
    if (rows < 0 || columns < 0 || (columns > 0 && rows > most / columns))
      throw std::runtime_error("a message ends early");
    Field values(rows, columns);
    const std::size_t size = static_cast<std::size_t>(values.size()) * sizeof(double);
    if (size > 0) std::memcpy(values.data(), bytes_.data(), size);
    bytes_.remove_prefix(size);
    return values;
  }
  Point point() {
    Point values;
    if (count() != 3) throw std::runtime_error("a point has not three coordinates");
    for (double& value : values) value = plain<double>();
    return values;
  }

 private:
  std::string_view bytes_;
};

/// Limits of a child process. A house of 2 MB takes 0.1 s and 0.1 GB; a damaged number may make a library read forever.
struct ChildLimits {
  unsigned seconds = 10;                          ///< processor time, in addition to 1 s for each 100 kB of the file
  std::uint64_t bytes = std::uint64_t{1} << 30U;  ///< memory, in addition to 300 bytes for each byte of the file
};

/// Runs `read` in a child process and returns its bytes. Libraries for complex formats can crash on damaged files. Then
/// only the child ends, and its output does not reach the terminal. \throws InputError as `read`, or naming `file` when
/// the child crashed, threw another exception or exceeded a limit.
std::string bytes_isolated(const std::string& file, const std::function<std::string()>& read,
                           const ChildLimits& limits = {});

/// A program for a child process without environment variables.
struct Program {
  std::vector<std::string> command;             ///< program file and arguments
  std::vector<std::filesystem::path> readable;  ///< readable folders in addition to those of the system
};

/// The standard output of a program that reads `input` from its standard input, under the same limits. It opens no
/// connections, writes no files and reads no other folders. \throws InputError naming `file` when the program fails,
/// writes nothing or exceeds a limit.
std::string output_isolated(const std::string& file, const Program& program, const std::string& input,
                            const ChildLimits& limits = {});

}  // namespace patchlight
