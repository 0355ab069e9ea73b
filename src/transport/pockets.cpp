#include "transport/pockets.h"

#include "transport/ray_transport.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// Light that is still there after as many bounces, first among all patches, then among those that have kept it so far.
constexpr int first_bounces = 4;
constexpr std::array<int, 2> more_bounces{8, 16};
constexpr double kept = 0.5;
// Half of it is left after 12 bounces where each leaves .944.
constexpr double least_reflectance = 0.94;
// More are no pockets, but the room.
constexpr PatchIndex largest_part = 8;
// What a row may lack to 1 by rounding.
constexpr double least_escape = 1e-6;

// Fill of the incomplete factors, relative to the matrix, and what is dropped, relative to its row.
constexpr double dropped = 0.01;
constexpr int fill = 2;

std::vector<PatchIndex> chosen(const std::vector<PatchIndex>& patches, const Eigen::VectorXd& share) {
  std::vector<PatchIndex> those;
  for (std::size_t k = 0; k < patches.size(); ++k)
    if (share[static_cast<Eigen::Index>(k)] > kept) those.push_back(patches[k]);
  return those;
}

// F among some patches.
Rows rows_among(const RayTransport& transport, const std::vector<PatchIndex>& patches) {
  constexpr int none = -1;
  std::vector<int> number(transport.size(), none);
  for (std::size_t k = 0; k < patches.size(); ++k) number[patches[k]] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const PatchIndex i = patches[k];
    const auto add = [&](PatchIndex j, double form_factor) {
      if (number[j] != none) entries.emplace_back(static_cast<int>(k), number[j], 0.5 * form_factor);
    };
    for (const std::size_t half : {0, 1}) {
      const RayRows& rows = transport.rows(half);
      for (std::uint64_t hit = rows.first_hit[i]; hit < rows.first_hit[i + 1]; ++hit)
        add(rows.hits[hit], rows.hit_weight[i]);
      for (std::uint64_t e = rows.first_entry[i]; e < rows.first_entry[i + 1]; ++e)
        add(rows.entries[e].patch, static_cast<double>(rows.entries[e].form_factor));
    }
  }
  const auto size = static_cast<Eigen::Index>(patches.size());
  Rows among(size, size);
  among.setFromTriplets(entries.begin(), entries.end());
  return among;
}

Eigen::VectorXd of(const Eigen::VectorXd& values, const std::vector<PatchIndex>& patches) {
  Eigen::VectorXd those(static_cast<Eigen::Index>(patches.size()));
  for (std::size_t k = 0; k < patches.size(); ++k) those[static_cast<Eigen::Index>(k)] = values[patches[k]];
  return those;
}

// The patches of which half of the light stays among them; all where they are too many to be pockets.
std::vector<PatchIndex> keeping(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  std::vector<PatchIndex> patches(transport.size());
  std::iota(patches.begin(), patches.end(), PatchIndex{0});
  Eigen::VectorXd left = Eigen::VectorXd::Ones(reflectance.size());
  for (int bounce = 0; bounce < first_bounces; ++bounce)
    left = reflectance.cwiseProduct(transport.apply(left).col(0).matrix());
  patches = chosen(patches, left);
  for (const int bounces : more_bounces) {
    if (patches.size() > transport.size() / largest_part) break;
    const Rows among = rows_among(transport, patches);
    const Eigen::VectorXd reflected = of(reflectance, patches);
    left = Eigen::VectorXd::Ones(among.rows());
    for (int bounce = 0; bounce < bounces; ++bounce) left = reflected.cwiseProduct(among * left);
    patches = chosen(patches, left);
  }
  return patches;
}

// Which of some patches lose light: they absorb, some leaves, or it gets to others that do.
std::vector<std::uint8_t> losing(const Rows& among, const Eigen::VectorXd& reflectance) {
  const Eigen::VectorXd row_sum = among * Eigen::VectorXd::Ones(among.rows());
  Eigen::VectorXd loses = (reflectance.array() < 1 || row_sum.array() < 1 - least_escape).cast<double>().matrix();
  for (double before = -1; loses.sum() > before;) {
    before = loses.sum();
    loses = (loses.array() > 0 || (among * loses).array() > 0).cast<double>().matrix();
  }
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(loses.size()));
  for (std::size_t k = 0; k < marks.size(); ++k) marks[k] = loses[static_cast<Eigen::Index>(k)] > 0 ? 1 : 0;
  return marks;
}

}  // namespace

Rows inner_system(const Rows& form_factors, const Eigen::VectorXd& reflectance) {
  Rows one(form_factors.rows(), form_factors.cols());
  one.setIdentity();
  return one - form_factors * reflectance.asDiagonal();
}

std::shared_ptr<const Pockets> pockets_of(const RayTransport& transport, const Eigen::VectorXd& reflectance) {
  if (!(reflectance.array() > least_reflectance).any()) return nullptr;
  const std::vector<PatchIndex> patches = keeping(transport, reflectance);
  if (patches.empty() || patches.size() > transport.size() / largest_part) return nullptr;

  auto pockets = std::make_shared<Pockets>();
  const std::vector<std::uint8_t> loses = losing(rows_among(transport, patches), of(reflectance, patches));
  for (std::size_t k = 0; k < patches.size(); ++k)
    (loses[k] != 0 ? pockets->patches : pockets->closed).push_back(patches[k]);
  pockets->form_factors = rows_among(transport, pockets->patches);
  pockets->nearly_solved.setDroptol(dropped);
  pockets->nearly_solved.setFillfactor(fill);
  pockets->nearly_solved.compute(inner_system(pockets->form_factors, of(reflectance, pockets->patches)));
  return pockets;
}

}  // namespace patchlight
