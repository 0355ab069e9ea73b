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

/// Puts values one after the other as they lie in memory, for a process of the same program.
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

/// Takes them out again in the same order. \throws std::runtime_error where there are none left.
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
  /// How many things follow, each of a byte or more.
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

/// Limits of a child process. A house of 2 MB takes 0.1 s and 0.1 GB; after a damaged number assimp may read on
/// without end.
struct ChildLimits {
  unsigned seconds = 60;                          ///< of processor time
  std::uint64_t bytes = std::uint64_t{1} << 30U;  ///< of memory, besides 300 for each byte of the file
};

/// The bytes that `read` returns in a child process. Libraries that read rich formats can crash on damaged files; then
/// only the child ends, and nothing that they print reaches the terminal. \throws InputError as `read` does, and naming
/// `file` when the child crashed, threw anything else or exceeded a limit.
std::string bytes_isolated(const std::string& file, const std::function<std::string()>& read,
                           const ChildLimits& limits = {});

/// A program that runs in a child process, without any environment variables.
struct Program {
  std::vector<std::string> command;             ///< its file and its arguments
  std::vector<std::filesystem::path> readable;  ///< folders that it reads, besides those of the system
};

/// The standard output of a program that reads `input` from its standard input, under the same limits. It opens no
/// connections, writes no files and reads no other folders. \throws InputError naming `file` when the program fails,
/// writes nothing or exceeds a limit.
std::string output_isolated(const std::string& file, const Program& program, const std::string& input,
                            const ChildLimits& limits = {});

}  // namespace patchlight
