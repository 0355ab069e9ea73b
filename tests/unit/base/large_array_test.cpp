#include "patchlight/base/large_array.h"

#include <cstdint>
#include <gtest/gtest.h>

namespace patchlight::large_array_test {
namespace {

std::uintptr_t place(const void* memory) { return reinterpret_cast<std::uintptr_t>(memory); }

// Rows of 64 bytes start at a cache line for every size. The sizes lie below and above 8 MiB, from which memory comes
// in pages of 2 MiB.
TEST(LargeArray, StartsAtACacheLine) {
  for (const std::size_t count : {1, 7, 64, 4096, 100001, (1 << 20) + 1, 3000000}) {
    const LargeArray<double> doubles(count, 1.5);
    const LargeArray<float> floats(count, 0.5F);
    EXPECT_EQ(place(doubles.data()) % 64, 0U) << count;
    EXPECT_EQ(place(floats.data()) % 64, 0U) << count;
    EXPECT_EQ(doubles.back(), 1.5);
    EXPECT_EQ(floats.back(), 0.5F);
  }
}

TEST(LargeArray, StartsAtALargePageWhenItIsLarge) {
  const LargeArray<double> values((std::size_t{8} << 20) / sizeof(double));
  EXPECT_EQ(place(values.data()) % (std::size_t{2} << 20), 0U);
}

TEST(LargeArray, KeepsItsValuesWhenItGrows) {
  LargeArray<int> values;
  for (int k = 0; k < 100000; ++k) values.push_back(k);
  EXPECT_EQ(place(values.data()) % 64, 0U);
  for (int k = 0; k < 100000; ++k) ASSERT_EQ(values[static_cast<std::size_t>(k)], k);
}

}  // namespace
}  // namespace patchlight::large_array_test
