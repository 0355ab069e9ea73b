#include "archive/npy.h"

#include "patchlight/base/error.h"

#include "files/reason.h"
#include "output/file/whole_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <optional>
#include <string_view>
#include <type_traits>

namespace patchlight {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are little endian");

constexpr std::string_view magic = "\x93NUMPY";
constexpr std::size_t alignment = 64;  // of the first value, as the format asks

std::string header(const std::string& type, const std::string& shape) {
  std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  const std::size_t before = magic.size() + 4;
  text.append(alignment - 1 - (before + text.size()) % alignment, ' ');
  text += '\n';
  const auto length = static_cast<unsigned>(text.size());
  return std::string(magic) + '\1' + '\0' + static_cast<char>(length & 255) + static_cast<char>(length >> 8) + text;
}

template <class Number>
void write_values(std::ostream& stream, std::span<const Number> values) {
  stream.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
}

// The length of the header: two bytes in version 1, four later.
std::size_t header_length(std::ifstream& stream, int version) {
  std::array<unsigned char, 4> bytes{};
  const std::size_t count = version == 1 ? 2 : 4;
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
  std::size_t length = 0;
  for (std::size_t k = 0; k < count; ++k) length |= std::size_t{bytes[k]} << (8 * k);
  return stream ? length : 0;
}

// The dictionary at the beginning of the file; nothing when there is none.
std::optional<std::string> read_header(std::ifstream& stream) {
  std::array<char, 8> start{};
  stream.read(start.data(), start.size());
  if (!stream || std::string_view(start.data(), magic.size()) != magic || start[6] < 1 || start[6] > 3) return {};
  const std::size_t length = header_length(stream, start[6]);
  if (length == 0 || length > 65536) return {};
  std::string text(length, ' ');
  stream.read(text.data(), static_cast<std::streamsize>(length));
  return stream ? std::optional(text) : std::nullopt;
}

// The text after a key of the dictionary; empty if there is no such key.
std::string_view value_of(std::string_view dictionary, std::string_view key) {
  const std::size_t place = dictionary.find(key);
  if (place == std::string_view::npos) return {};
  const std::string_view rest = dictionary.substr(place + key.size());
  return rest.substr(std::min(rest.size(), rest.find_first_not_of(' ')));
}

// The numbers of a shape "(12, 34)" or "(12,)"; nothing when it is none.
std::vector<std::size_t> shape_of(std::string_view text) {
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos) return {};
  std::vector<std::size_t> shape;
  for (std::size_t begin = 1; begin < end; begin = text.find_first_not_of(", ", begin)) {
    std::size_t count = 0;
    const auto [rest, error] = std::from_chars(text.data() + begin, text.data() + end, count);
    if (error != std::errc()) return {};
    shape.push_back(count);
    begin = static_cast<std::size_t>(rest - text.data());
  }
  return shape;
}

// Opens the file and returns its dictionary; empty when it has none.
std::string open_npy(const std::filesystem::path& file, std::ifstream& stream) {
  require_regular_file(file);
  stream.open(file, std::ios::binary);
  if (!stream) throw InputError(file.string(), "cannot be read; is it there?");
  return read_header(stream).value_or("");
}

// The first line of a header, which may have 65,536 characters.
std::string start_of(const std::string& header) {
  constexpr std::size_t most = 120;
  return header.substr(0, std::min(most, header.find('\n')));
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& found) {
  throw InputError(file.string(), "found " + found +
                                      "; expected an array of numpy (.npy) of type '<f4' or '<f8', in C order, of one "
                                      "or two dimensions, and as many values as its header states");
}

template <class Number>
std::string type_of() {
  if constexpr (sizeof(Number) == 1) return std::is_signed_v<Number> ? "|i1" : "|u1";
  return std::string(std::is_floating_point_v<Number> ? "<f" : "<i") + std::to_string(sizeof(Number));
}

}  // namespace

template <class Number>
void write_npy_numbers(const std::filesystem::path& file, std::span<const Number> values) {
  write_stream(file, [&](std::ostream& stream) {
    stream << header(type_of<Number>(), std::to_string(values.size()) + ',');
    write_values(stream, values);
  });
}

std::size_t npy_count(const std::filesystem::path& file) {
  std::ifstream stream;
  const std::vector<std::size_t> shape = shape_of(value_of(open_npy(file, stream), "'shape':"));
  if (shape.size() == 1) return shape[0];
  throw InputError(file.string(), "found another array than one of one dimension; compute the form factors again");
}

template <class Number>
void read_npy_pieces(const std::filesystem::path& file, std::size_t count,
                     const std::function<void(std::span<const Number> piece)>& take) {
  std::ifstream stream;
  const std::string text = open_npy(file, stream);
  const std::uintmax_t bytes = std::filesystem::file_size(file) - static_cast<std::uintmax_t>(stream.tellg());
  const bool good = value_of(text, "'descr':").starts_with("'" + type_of<Number>() + "'") &&
                    shape_of(value_of(text, "'shape':")) == std::vector{count} && bytes % sizeof(Number) == 0 &&
                    bytes / sizeof(Number) == count;
  if (!good)
    throw InputError(file.string(), "found another array than one of " + std::to_string(count) + " numbers of type '" +
                                        type_of<Number>() + "'; compute the form factors again");
  std::vector<Number> piece(std::min(count, (std::size_t{1} << 18) / sizeof(Number)));
  for (std::size_t first = 0; first < count; first += piece.size()) {
    const std::span<Number> part = std::span(piece).first(std::min(piece.size(), count - first));
    stream.read(reinterpret_cast<char*>(part.data()), static_cast<std::streamsize>(part.size_bytes()));
    if (!stream) throw InputError(file.string(), "cannot be read to its end");
    take(part);
  }
}

template <class Number>
LargeArray<Number> read_npy_numbers(const std::filesystem::path& file, std::size_t count) {
  return read_npy_as<LargeArray<Number>, Number>(file, count);
}

template void write_npy_numbers(const std::filesystem::path&, std::span<const std::int8_t>);
template void write_npy_numbers(const std::filesystem::path&, std::span<const std::int32_t>);
template void write_npy_numbers(const std::filesystem::path&, std::span<const std::int64_t>);
template void write_npy_numbers(const std::filesystem::path&, std::span<const float>);
template void write_npy_numbers(const std::filesystem::path&, std::span<const double>);
template LargeArray<std::int8_t> read_npy_numbers(const std::filesystem::path&, std::size_t);
template LargeArray<std::int32_t> read_npy_numbers(const std::filesystem::path&, std::size_t);
template void read_npy_pieces(const std::filesystem::path&, std::size_t,
                              const std::function<void(std::span<const std::int32_t>)>&);
template LargeArray<std::int64_t> read_npy_numbers(const std::filesystem::path&, std::size_t);
template void read_npy_pieces(const std::filesystem::path&, std::size_t,
                              const std::function<void(std::span<const std::int64_t>)>&);
template LargeArray<float> read_npy_numbers(const std::filesystem::path&, std::size_t);
template void read_npy_pieces(const std::filesystem::path&, std::size_t,
                              const std::function<void(std::span<const float>)>&);
template LargeArray<double> read_npy_numbers(const std::filesystem::path&, std::size_t);
template void read_npy_pieces(const std::filesystem::path&, std::size_t,
                              const std::function<void(std::span<const double>)>&);

void write_npy(const std::filesystem::path& file, std::size_t rows, std::size_t columns,
               const std::function<void(std::size_t row, std::span<float> values)>& fill) {
  write_stream(file, [&](std::ostream& stream) {
    stream << header("<f4", std::to_string(rows) + ", " + std::to_string(columns));
    std::vector<float> values(columns);
    for (std::size_t row = 0; row < rows && stream; ++row) {
      fill(row, values);
      write_values<float>(stream, values);
    }
  });
}

void write_npy(const std::filesystem::path& file, const Eigen::MatrixXd& values) {
  write_stream(file, [&](std::ostream& stream) {
    std::string shape = std::to_string(values.rows()) + ',';
    if (values.cols() > 1) shape.append(1, ' ').append(std::to_string(values.cols()));
    stream << header("<f8", shape);
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> in_rows = values;
    write_values<double>(stream, {in_rows.data(), static_cast<std::size_t>(in_rows.size())});
  });
}

void write_npy(const std::filesystem::path& file, std::span<const std::uint8_t> values) {
  write_npy_numbers(file, values);
}

NpyReader::NpyReader(const std::filesystem::path& file) : file_(file) {
  const std::string text = open_npy(file, stream_);
  if (text.empty()) refuse(file, "no header");
  const std::string_view type = value_of(text, "'descr':");
  const std::vector<std::size_t> shape = shape_of(value_of(text, "'shape':"));
  if (!(type.starts_with("'<f4'") || type.starts_with("'<f8'")) ||
      !value_of(text, "'fortran_order':").starts_with("False") || shape.empty() || shape.size() > 2) {
    refuse(file, "the header " + start_of(text));
  }
  bytes_per_value_ = type[3] == '4' ? 4 : 8;
  rows_ = shape[0];
  columns_ = shape.size() == 2 ? shape[1] : 1;

  // No product of counts is formed: it might not fit.
  const auto bytes = std::filesystem::file_size(file) - static_cast<std::uintmax_t>(stream_.tellg());
  const auto values = bytes / bytes_per_value_;
  const bool empty = rows_ == 0 || columns_ == 0;
  const bool fits =
      empty ? bytes == 0 : bytes % bytes_per_value_ == 0 && values % rows_ == 0 && values / rows_ == columns_;
  if (!fits) refuse(file, std::to_string(bytes) + " bytes after the header " + start_of(text));
}

std::vector<double> NpyReader::next_rows(std::size_t count) {
  const auto read = [this](auto& values) {
    stream_.read(reinterpret_cast<char*>(values.data()),
                 static_cast<std::streamsize>(values.size() * sizeof(values[0])));
    if (!stream_) throw InputError(file_.string(), "cannot be read to its end");
  };
  std::vector<double> values(count * columns_);
  if (bytes_per_value_ == sizeof(double)) {
    read(values);
    return values;
  }
  std::vector<float> narrow(values.size());
  read(narrow);
  std::copy(narrow.begin(), narrow.end(), values.begin());
  return values;
}

Eigen::MatrixXd read_npy(const std::filesystem::path& file, std::size_t rows, std::size_t columns) {
  NpyReader reader(file);
  if (reader.rows() != rows || reader.columns() != columns) {
    throw InputError(file.string(), "found " + std::to_string(reader.rows()) + " x " +
                                        std::to_string(reader.columns()) + " values; expected " + std::to_string(rows) +
                                        " x " + std::to_string(columns));
  }
  const std::vector<double> values = reader.next_rows(rows);
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
}

std::vector<std::uint8_t> read_npy_bytes(const std::filesystem::path& file, std::size_t count) {
  return read_npy_as<std::vector<std::uint8_t>, std::uint8_t>(file, count);
}

}  // namespace patchlight
