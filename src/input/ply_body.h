#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  ///< of a list's length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

/// What a PLY file says about itself.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  ///< where the values begin
  std::uint32_t lines = 0;
};

/// \throws InputError naming the line.
PlyHeader read_ply_header(std::string_view bytes, const std::string& file);

/// Hands out the values of a PLY file one after the other.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header, std::string file);

  /// The next number, of this type. \throws InputError when there is none.
  double next(PlyType type);
  /// All numbers of the next property: one, or a list. \throws InputError when they are missing.
  std::vector<double> next(const PlyProperty& property);
  /// "room.ply:12", or "room.ply" where values are binary.
  std::string place() const;
  /// The line in an ASCII file; 0 otherwise.
  std::uint32_t line() const { return encoding_ == PlyEncoding::ascii ? line_ : 0; }

 private:
  double next_word();
  double next_bytes(PlyType type);

  std::string_view rest_;
  PlyEncoding encoding_;
  std::uint32_t line_;
  std::string file_;
};

}  // namespace patchlight
