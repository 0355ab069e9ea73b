#include "archive/npy.h"

#include "patchlight/base/error.h"

#include "unit/output/temporary_folder.h"

#include <gtest/gtest.h>

namespace patchlight::npy_test {
namespace {

constexpr const char* start_of_version_1 = "\x93NUMPY\x01";

// A file with this dictionary, padded to the format's size, and this many bytes of values.
void put_array(const std::filesystem::path& file, std::string dictionary, std::size_t bytes, char version = 1) {
  dictionary.resize(118, ' ');
  std::ofstream stream(file, std::ios::binary);
  stream << "\x93NUMPY" << version << '\0' << static_cast<char>(dictionary.size()) << '\0';
  if (version > 1) stream << '\0' << '\0';
  stream << dictionary << std::string(bytes, '\0');
}

TEST(Npy, DoublesComeBackToTheBit) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.npy";
  Eigen::MatrixXd values(3, 2);
  values << 1.0 / 3, -2, 1e-300, 4e300, 0, 5;
  write_npy(file, values);
  EXPECT_EQ(read_npy(file, 3, 2), values);
  const Eigen::VectorXd column = values.col(0);
  write_npy(file, column);
  EXPECT_EQ(read_npy(file, 3, 1), column);
}

TEST(Npy, BytesComeBack) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.npy";
  const std::vector<std::uint8_t> bytes{0, 1, 127, 128, 255};
  write_npy(file, bytes);
  EXPECT_EQ(read_npy_bytes(file, 5), bytes);
  EXPECT_NE(content_of(file).find("{'descr': '|u1', 'fortran_order': False, 'shape': (5,), }"), std::string::npos);
  EXPECT_THROW(read_npy_bytes(file, 4), InputError);
  EXPECT_THROW(NpyReader{file}, InputError);
  write_npy(file, std::vector<std::uint8_t>());
  EXPECT_TRUE(read_npy_bytes(file, 0).empty());
  put_array(file, "{'descr': '<f8', 'fortran_order': False, 'shape': (5,), }", 40);
  EXPECT_THROW(read_npy_bytes(file, 5), InputError);
}

TEST(Npy, FloatsComeRowByRow) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.npy";
  write_npy(file, 3, 4, [](std::size_t row, std::span<float> values) {
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<float>(10 * row + k) / 3;
  });
  NpyReader reader(file);
  ASSERT_EQ(reader.rows(), 3U);
  ASSERT_EQ(reader.columns(), 4U);
  const std::vector<double> first = reader.next_rows(1);
  const std::vector<double> others = reader.next_rows(2);
  ASSERT_EQ(first.size(), 4U);
  ASSERT_EQ(others.size(), 8U);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t k = 0; k < 4; ++k) {
      const double value = row == 0 ? first[k] : others[4 * (row - 1) + k];
      EXPECT_EQ(value, static_cast<double>(static_cast<float>(10 * row + k) / 3));
    }
  }
}

// NEP 1: the magic string, the version, and a header that ends in a line feed at a multiple of 64 bytes.
TEST(Npy, TheHeaderIsNumpys) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.npy";
  write_npy(file, 2, 2, [](std::size_t, std::span<float> values) { values[0] = values[1] = 1; });
  const std::string content = content_of(file);
  EXPECT_EQ(content.substr(0, 7), start_of_version_1);
  const std::size_t header = content.size() - 4 * sizeof(float);
  EXPECT_EQ(header % 64, 0U);
  EXPECT_EQ(content[header - 1], '\n');
  EXPECT_NE(content.find("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }"), std::string::npos);
}

TEST(Npy, LaterVersionsAreRead) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.npy";
  put_array(file, "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }", 48, 2);
  EXPECT_EQ(read_npy(file, 2, 3), Eigen::MatrixXd::Zero(2, 3));
}

TEST(Npy, WhatIsNotSuchAnArrayIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.npy";
  EXPECT_THROW(NpyReader{file}, InputError);
  for (const char* text : {"", "\x93NUM", "PK\3\4 a zip file", "\x93NUMPY\x01"}) {
    put(file, text);
    EXPECT_THROW(NpyReader{file}, InputError) << text;
  }
  for (const char* dictionary : {"{'descr': '>f4', 'fortran_order': False, 'shape': (2, 2), }",
                                 "{'descr': '<i4', 'fortran_order': False, 'shape': (2, 2), }",
                                 "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 2), }",
                                 "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 1), }",
                                 "{'descr': '<f4', 'fortran_order': False, 'shape': (), }",
                                 "{'descr': '<f4', 'fortran_order': False, 'shape': (-2, -2), }", "no dictionary"}) {
    put_array(file, dictionary, 16);
    EXPECT_THROW(NpyReader{file}, InputError) << dictionary;
  }
}

// The header's numbers are accepted only if the file has the matching length, even if their product overflows.
TEST(Npy, AShapeThatTheFileCannotHoldIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.npy";
  for (const char* shape : {"(2, 3)", "(4,)", "(0, 2)", "(4294967296, 4294967296)", "(99999999999999999999, 1)",
                            "(1152921504606846976, 16)"}) {
    put_array(file, std::string("{'descr': '<f4', 'fortran_order': False, 'shape': ") + shape + ", }", 20);
    EXPECT_THROW(NpyReader{file}, InputError) << shape;
  }
  put_array(file, "{'descr': '<f4', 'fortran_order': False, 'shape': (5,), }", 20);
  EXPECT_EQ(NpyReader(file).rows(), 5U);
  EXPECT_THROW(read_npy(file, 4, 1), InputError);
}

TEST(Npy, MessagesQuoteTheStartOfALongHeader) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.npy";
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (4,), }";
  header.resize(0x8000, 'x');
  std::ofstream(file, std::ios::binary) << "\x93NUMPY" << '\1' << '\0' << '\0' << '\x80' << header;
  try {
    const NpyReader reader(file);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_LT(std::string(error.what()).size(), file.string().size() + 400);
  }
}

}  // namespace
}  // namespace patchlight::npy_test
