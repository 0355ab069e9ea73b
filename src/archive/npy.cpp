#include "archive/npy.h"

#include "patchlight/base/error.h"
#include "patchlight/output/whole_file.h"

#include <array>
#include <bit>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <optional>
#include <regex>

namespace patchlight {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are little endian");

constexpr std::string_view magic = "\x93NUMPY";
constexpr std::size_t alignment = 64;  // of the first value, as the format asks
constexpr std::size_t longest_header = 65536;
constexpr std::size_t most_values = std::size_t{1} << 60;

std::string header(const std::string& type, const std::string& shape) {
  std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  const std::size_t before = magic.size() + 4;
  text.append(alignment - 1 - (before + text.size()) % alignment, ' ');
  text += '\n';
  const auto length = static_cast<unsigned>(text.size());
  return std::string(magic) + '\1' + '\0' + static_cast<char>(length & 255) + static_cast<char>(length >> 8) + text;
}

void close_or_fail(std::ofstream& stream, const std::filesystem::path& file) {
  stream.close();
  if (!stream) throw OutputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
}

// The bytes that tell how long the header is: two in version 1, four later.
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
  if (length == 0 || length > longest_header) return {};
  std::string text(length, ' ');
  stream.read(text.data(), static_cast<std::streamsize>(length));
  return stream ? std::optional(text) : std::nullopt;
}

// A count in a shape; too large a number, which no file can hold, becomes most_values.
std::size_t count_of(const std::string& digits) {
  return digits.size() > 12 ? most_values : static_cast<std::size_t>(std::stoull(digits));
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& found) {
  throw InputError(file.string(), "found " + found +
                                      "; expected an array of numpy (.npy) of type '<f4' or '<f8', in C order, of one "
                                      "or two dimensions, and as many values as its header says");
}

}  // namespace

void write_npy(const std::filesystem::path& file, std::size_t rows, std::size_t columns,
               const std::function<void(std::size_t row, std::span<float> values)>& fill) {
  write_whole_file(file, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    stream << header("<f4", std::to_string(rows) + ", " + std::to_string(columns));
    std::vector<float> values(columns);
    for (std::size_t row = 0; row < rows && stream; ++row) {
      fill(row, values);
      stream.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(columns * sizeof(float)));
    }
    close_or_fail(stream, file);
  });
}

void write_npy(const std::filesystem::path& file, const Eigen::MatrixXd& values) {
  write_whole_file(file, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    const bool vector = values.cols() == 1;
    stream << header("<f8", std::to_string(values.rows()) + "," + (vector ? "" : " " + std::to_string(values.cols())));
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> in_rows = values;
    stream.write(reinterpret_cast<const char*>(in_rows.data()),
                 static_cast<std::streamsize>(in_rows.size() * static_cast<Eigen::Index>(sizeof(double))));
    close_or_fail(stream, file);
  });
}

NpyReader::NpyReader(const std::filesystem::path& file) : file_(file), stream_(file, std::ios::binary) {
  if (!stream_) throw InputError(file.string(), "cannot be read; is it there?");
  const std::string text = read_header(stream_).value_or("");
  if (text.empty()) refuse(file, "no header");
  static const std::regex type("'descr': *'<f([48])'");
  static const std::regex order("'fortran_order': *False");
  static const std::regex shape(R"('shape': *\((\d+), *(\d*),? *\))");
  std::smatch of_type, of_shape;
  if (!std::regex_search(text, of_type, type) || !std::regex_search(text, order) ||
      !std::regex_search(text, of_shape, shape)) {
    refuse(file, "the header " + text.substr(0, text.find('\n')));
  }
  bytes_per_value_ = of_type.str(1) == "4" ? 4 : 8;
  rows_ = count_of(of_shape.str(1));
  columns_ = of_shape.length(2) == 0 ? 1 : count_of(of_shape.str(2));

  // No product of counts is formed: it might not fit.
  const auto bytes = std::filesystem::file_size(file) - static_cast<std::uintmax_t>(stream_.tellg());
  const auto values = bytes / bytes_per_value_;
  const bool empty = rows_ == 0 || columns_ == 0;
  const bool fits =
      empty ? bytes == 0 : bytes % bytes_per_value_ == 0 && values % rows_ == 0 && values / rows_ == columns_;
  if (!fits) refuse(file, std::to_string(bytes) + " bytes after the header " + text.substr(0, text.find('\n')));
}

std::vector<double> NpyReader::next_row() {
  std::vector<char> bytes(columns_ * bytes_per_value_);
  stream_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream_) throw InputError(file_.string(), "cannot be read to its end");
  std::vector<double> values(columns_);
  for (std::size_t k = 0; k < columns_; ++k) {
    if (bytes_per_value_ == sizeof(double)) {
      std::memcpy(&values[k], &bytes[k * sizeof(double)], sizeof(double));
    } else {
      float value = 0;
      std::memcpy(&value, &bytes[k * sizeof(float)], sizeof(float));
      values[k] = static_cast<double>(value);
    }
  }
  return values;
}

Eigen::MatrixXd read_npy(const std::filesystem::path& file, std::size_t rows, std::size_t columns) {
  NpyReader reader(file);
  if (reader.rows() != rows || reader.columns() != columns) {
    throw InputError(file.string(), "found " + std::to_string(reader.rows()) + " x " +
                                        std::to_string(reader.columns()) + " values; expected " + std::to_string(rows) +
                                        " x " + std::to_string(columns));
  }
  Eigen::MatrixXd values(rows, columns);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::vector<double> next = reader.next_row();
    values.row(static_cast<Eigen::Index>(row)) = Eigen::Map<const Eigen::RowVectorXd>(next.data(), values.cols());
  }
  return values;
}

}  // namespace patchlight
