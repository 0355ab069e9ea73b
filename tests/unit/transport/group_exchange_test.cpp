#include "transport/closure.h"

#include <gtest/gtest.h>
#include <vector>

namespace patchlight::group_exchange_test {
namespace {

// Entries are small whole numbers, so that all sums are exact.
ExchangeAreas numbered(PatchIndex size) {
  ExchangeAreas S(size);
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = i + 1; j < size; ++j) S.set(i, j, static_cast<float>((i * 7 + j * 13) % 11));
  }
  return S;
}

TEST(GroupExchange, IsTheSumOfTheEntries) {
  constexpr PatchIndex size = 150;
  const ExchangeAreas S = numbered(size);
  std::vector<std::uint32_t> group_of(size);
  for (PatchIndex i = 0; i < size; ++i) group_of[i] = i * i % 3;
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 3);
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = 0; j < size; ++j) expected(group_of[i], group_of[j]) += static_cast<double>(S.at(i, j));
  }
  EXPECT_EQ(exchange_between_groups(S, group_of, 3), expected);
}

// One group of all patches exchanges the sum of all rows.
TEST(GroupExchange, OneGroupIsAll) {
  const ExchangeAreas S = numbered(100);
  const std::vector<std::uint32_t> one(100, 0);
  EXPECT_EQ(exchange_between_groups(S, one, 1)(0, 0), row_sums(S).sum());
}

}  // namespace
}  // namespace patchlight::group_exchange_test
