#pragma once

#include "patchlight/base/large_array.h"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <vector>

namespace patchlight {

/// Writes an array of 32-bit floats, shape rows x columns, in C order: numpy's .npy, version 1.0 (NEP 1). `fill` is
/// asked for one row after the other. \throws OutputError, and what `fill` throws.
void write_npy(const std::filesystem::path& file, std::size_t rows, std::size_t columns,
               const std::function<void(std::size_t row, std::span<float> values)>& fill);

/// Writes an array of doubles; of one dimension if it has one column. \throws OutputError.
void write_npy(const std::filesystem::path& file, const Eigen::MatrixXd& values);

/// Writes an array of bytes of one dimension. \throws OutputError.
void write_npy(const std::filesystem::path& file, std::span<const std::uint8_t> values);

/// Writes numbers of one dimension as they are: of 32 or 64 bits, whole or floats, or signed bytes. \throws
/// OutputError.
template <class Number>
void write_npy_numbers(const std::filesystem::path& file, std::span<const Number> values);

/// Reads such an array with `count` numbers of this very type. \throws InputError.
template <class Number>
LargeArray<Number> read_npy_numbers(const std::filesystem::path& file, std::size_t count);

/// The same piece by piece, each small enough for a cache: what becomes another array takes no copy of the whole.
/// \throws InputError, and what `take` throws.
template <class Number>
void read_npy_pieces(const std::filesystem::path& file, std::size_t count,
                     const std::function<void(std::span<const Number> piece)>& take);

/// Such an array, of Stored numbers, as another array has them; `check` throws at a piece with a number that cannot be.
/// \throws InputError, and what `check` throws.
template <class Array, class Stored, class Check>
Array read_npy_as(const std::filesystem::path& file, std::size_t count, const Check& check) {
  Array values;
  read_npy_pieces<Stored>(file, count, [&](std::span<const Stored> piece) {
    check(piece);
    if (values.empty()) values.reserve(count);
    values.insert(values.end(), piece.begin(), piece.end());
  });
  return values;
}
template <class Array, class Stored>
Array read_npy_as(const std::filesystem::path& file, std::size_t count) {
  return read_npy_as<Array, Stored>(file, count, [](std::span<const Stored>) {});
}

/// How many numbers an array of one dimension has. \throws InputError.
std::size_t npy_count(const std::filesystem::path& file);

/// Reads an array of 32 or 64-bit floats in C order of one dimension (one column) or two, row by row.
class NpyReader {
 public:
  /// \throws InputError if the file is not such an array, or its number of values differs from its header.
  explicit NpyReader(const std::filesystem::path& file);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  /// The next rows, one after the other; they must be there. \throws InputError when the file cannot be read.
  std::vector<double> next_rows(std::size_t count);

 private:
  std::filesystem::path file_;
  std::ifstream stream_;
  std::size_t rows_ = 0;
  std::size_t columns_ = 0;
  std::size_t bytes_per_value_ = 0;
};

/// A whole array. \throws InputError, also when its shape is not this.
Eigen::MatrixXd read_npy(const std::filesystem::path& file, std::size_t rows, std::size_t columns);

/// A whole array of so many bytes, of one dimension. \throws InputError, also when it is another array.
std::vector<std::uint8_t> read_npy_bytes(const std::filesystem::path& file, std::size_t count);

}  // namespace patchlight
