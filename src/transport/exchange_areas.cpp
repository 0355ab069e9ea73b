#include "patchlight/transport/exchange_areas.h"

#include "base/parallel.h"
#include "base/target_clones.h"
#include "transport/tiles.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace patchlight {
namespace {

// Where the tile of block row I and block column J begins among n block rows.
std::size_t first_entry(std::size_t n, PatchIndex I, PatchIndex J) {
  assert(I <= J && J < n);
  return (I * n - static_cast<std::size_t>(I) * (I + 1) / 2 + J) * tile_edge * tile_edge;
}

}  // namespace

ExchangeAreas::ExchangeAreas(PatchIndex size) : size_(size), entries_(bytes(size) / sizeof(float), 0.0F) {}

std::size_t ExchangeAreas::bytes(PatchIndex size) {
  const std::size_t n = (size + tile_edge - 1) / tile_edge;
  return n * (n + 1) / 2 * tile_edge * tile_edge * sizeof(float);
}

float ExchangeAreas::at(PatchIndex i, PatchIndex j) const {
  if (i / tile_edge > j / tile_edge) std::swap(i, j);
  const std::span<const float> entries = Tiles::of(*this, i / tile_edge, j / tile_edge);
  return entries[static_cast<std::size_t>(i % tile_edge) * tile_edge + j % tile_edge];
}

void ExchangeAreas::set(PatchIndex i, PatchIndex j, float value) {
  if (i / tile_edge > j / tile_edge) std::swap(i, j);
  const std::span<float> entries = Tiles::of(*this, i / tile_edge, j / tile_edge);
  const std::size_t r = i % tile_edge;
  const std::size_t c = j % tile_edge;
  entries[r * tile_edge + c] = value;
  if (i / tile_edge == j / tile_edge) entries[c * tile_edge + r] = value;
}

PatchIndex Tiles::blocks(const ExchangeAreas& S) { return (S.size() + tile_edge - 1) / tile_edge; }

std::span<float> Tiles::of(ExchangeAreas& S, PatchIndex I, PatchIndex J) {
  return {S.entries_.data() + first_entry(blocks(S), I, J), static_cast<std::size_t>(tile_edge) * tile_edge};
}

std::span<const float> Tiles::of(const ExchangeAreas& S, PatchIndex I, PatchIndex J) {
  return {S.entries_.data() + first_entry(blocks(S), I, J), static_cast<std::size_t>(tile_edge) * tile_edge};
}

ExchangeAreas changed(ExchangeAreas S, const Change& value) {
  const PatchIndex blocks = Tiles::blocks(S);
  parallel_for(blocks, [&](std::size_t row) {
    const auto I = static_cast<PatchIndex>(row);
    for (PatchIndex J = I; J < blocks; ++J) {
      const std::span<float> tile = Tiles::of(S, I, J);
      for (PatchIndex k = 0; k < tile_edge * tile_edge; ++k) {
        if (tile[k] == 0) continue;
        tile[k] = narrow_toward_zero(
            value(I * tile_edge + k / tile_edge, J * tile_edge + k % tile_edge, static_cast<double>(tile[k])));
      }
    }
  });
  return S;
}

namespace {

constexpr std::size_t simd_width = 8;  // patches side by side: doubles of an AVX-512 register

// Doubles of one register. Wider vectors than the machine has, compilers keep in memory.
template <std::size_t lanes>
using Doubles [[gnu::vector_size(sizeof(double) * lanes), gnu::aligned(sizeof(double)), gnu::may_alias]] = double;

// Floats fetched ahead of their use: about as many arrive in the time of a memory access.
constexpr std::size_t prefetch_distance = 2048;

// Doubles of a register that the whole library is compiled for.
constexpr std::size_t plain_lanes = __BIGGEST_ALIGNMENT__ / sizeof(double);

// Some of the bands of a packed field.
struct BandRange {
  std::size_t first;
  std::size_t of;
};

// Rows at once, so that b_J and out_J are loaded a quarter as often.
constexpr std::size_t tile_rows = 4;

// Bands for which a row is turned into doubles once: their part of b_J and out_J stays in the nearest cache.
constexpr std::size_t most_bands = 18;

// Bands at once whose sums fit into the registers: AVX-512 has 32 of them, narrower ones 16.
template <std::size_t lanes>
constexpr std::size_t bands_at_once = lanes == simd_width ? 3 : 2;

// One value for each of the rows and bands at once.
template <std::size_t lanes, std::size_t bands>
using Block = Doubles<lanes>[tile_rows][bands];

// Calls use(k, band) for each of them: unrolled also where a build does not do so by itself, as a block has to stay in
// registers.
template <std::size_t bands, typename Use>
PATCHLIGHT_INLINE void for_block(const Use& use) {
  PATCHLIGHT_UNROLL
  for (std::size_t k = 0; k < tile_rows; ++k) {
    PATCHLIGHT_UNROLL
    for (std::size_t band = 0; band < bands; ++band) use(k, band);
  }
}

// s_k (columns) b_J into the sums, and s_k (columns) b_I onto out_J, for some columns of one band after the other.
template <std::size_t lanes, std::size_t bands, bool gather, bool push>
PATCHLIGHT_INLINE void multiply_columns(const double* wide, const Block<lanes, bands>& b, const double* b_J,
                                        Block<lanes, bands>& sums, double* out_J) {
  using Lanes = Doubles<lanes>;
  Lanes s[tile_rows];
  PATCHLIGHT_UNROLL
  for (std::size_t k = 0; k < tile_rows; ++k) s[k] = *reinterpret_cast<const Lanes*>(wide + k * tile_edge);
  PATCHLIGHT_UNROLL
  for (std::size_t band = 0; band < bands; ++band) {
    if constexpr (gather) {
      const Lanes from = *reinterpret_cast<const Lanes*>(b_J + band * simd_width);
      PATCHLIGHT_UNROLL
      for (std::size_t k = 0; k < tile_rows; ++k) sums[k][band] += s[k] * from;
    }
    if constexpr (push) {
      Lanes* const out = reinterpret_cast<Lanes*>(out_J + band * simd_width);
      Lanes sum = *out;
      PATCHLIGHT_UNROLL
      for (std::size_t k = 0; k < tile_rows; ++k) sum += s[k] * b[k][band];
      *out = sum;
    }
  }
}

// Rows r to r + 3 of a tile, in double, with `bands` bands from range.first on: of every eight columns those from
// `part` on that fill a register.
template <std::size_t lanes, std::size_t bands, bool gather, bool push>
PATCHLIGHT_INLINE void multiply(const double* wide, std::size_t r, std::size_t part, const BandRange range,
                                const TileProduct product) {
  const auto place_of_sums = [&](std::size_t k, std::size_t band) {
    double* const sums_r = product.row_sums + (r * range.of + range.first) * simd_width + part;
    return reinterpret_cast<Doubles<lanes>*>(sums_r + (k * range.of + band) * simd_width);
  };
  Block<lanes, bands> sums;
  if constexpr (gather)
    for_block<bands>([&](std::size_t k, std::size_t band) { sums[k][band] = *place_of_sums(k, band); });
  Block<lanes, bands> b;
  if constexpr (push) {
    // Where row r is in a packed block; the next rows and bands follow.
    const double* const b_r = product.b_rows + (r / simd_width * range.of + range.first) * simd_width + r % simd_width;
    for_block<bands>(
        [&](std::size_t k, std::size_t band) { b[k][band] = Doubles<lanes>{} + b_r[band * simd_width + k]; });
  }
  for (std::size_t c = 0; c < tile_edge; c += simd_width) {
    const std::size_t place = c * range.of + range.first * simd_width + part;
    multiply_columns<lanes, bands, gather, push>(wide + c + part, b, product.b_columns + place, sums,
                                                 product.column_sums + place);
  }
  if constexpr (gather)
    for_block<bands>([&](std::size_t k, std::size_t band) { *place_of_sums(k, band) = sums[k][band]; });
}

// Four rows with `bands` bands. The sums are the same for registers of any size.
template <std::size_t lanes, std::size_t bands, bool gather, bool push>
PATCHLIGHT_INLINE void multiply_parts(const double* wide, std::size_t r, const BandRange range,
                                      const TileProduct product) {
  for (std::size_t part = 0; part < simd_width; part += lanes)
    multiply<lanes, bands, gather, push>(wide, r, part, range, product);
}

// Four rows with the bands [first, end).
template <std::size_t lanes, bool gather, bool push>
PATCHLIGHT_INLINE void multiply_rows(const double* wide, std::size_t r, BandRange range, std::size_t end,
                                     const TileProduct product) {
  for (; range.first + bands_at_once<lanes> <= end; range.first += bands_at_once<lanes>)
    multiply_parts<lanes, bands_at_once<lanes>, gather, push>(wide, r, range, product);
  if constexpr (bands_at_once < lanes >> 2)
    if (end - range.first == 2) multiply_parts<lanes, 2, gather, push>(wide, r, range, product);
  if (end - range.first == 1) multiply_parts<lanes, 1, gather, push>(wide, r, range, product);
}

template <std::size_t lanes, bool gather, bool push>
PATCHLIGHT_INLINE void for_bands(const float* tile, int bands, const TileProduct& product) {
  const auto of = static_cast<std::size_t>(bands);
  for (std::size_t first = 0; first < of; first += most_bands) {
    for (std::size_t r = 0; r < tile_edge; r += tile_rows) {
      // The rows in double, and those of later on their way into the cache, be it beyond the last tile.
      alignas(64) double wide[tile_rows * tile_edge];
      const auto later = reinterpret_cast<std::uintptr_t>(tile + r * tile_edge) + prefetch_distance * sizeof(float);
      for (std::size_t line = 0; line < tile_rows * tile_edge * sizeof(float); line += 64) {
        // NOLINTNEXTLINE(performance-no-int-to-ptr): a pointer past the array would be undefined
        __builtin_prefetch(reinterpret_cast<const void*>(later + line));
      }
      for (std::size_t c = 0; c < tile_rows * tile_edge; ++c) wide[c] = static_cast<double>(tile[r * tile_edge + c]);
      multiply_rows<lanes, gather, push>(wide, r, {first, of}, std::min(of, first + most_bands), product);
    }
  }
}

// The product by registers of `lanes` doubles. It gathers where there are row sums, and pushes where there are column
// sums.
template <std::size_t lanes>
PATCHLIGHT_INLINE void product_by(const float* tile, int bands, const TileProduct& product) {
  if (product.column_sums == nullptr) return for_bands<lanes, true, false>(tile, bands, product);
  if (product.row_sums == nullptr) return for_bands<lanes, false, true>(tile, bands, product);
  for_bands<lanes, true, true>(tile, bands, product);
}

// A version for each instruction set, by the simd_width of its registers.
PATCHLIGHT_TARGET_PLAIN void product_here(const float* tile, int bands, const TileProduct& product) {
  product_by<plain_lanes>(tile, bands, product);
}
#ifdef PATCHLIGHT_HAS_TARGETS
PATCHLIGHT_TARGET_AVX2 void product_here(const float* tile, int bands, const TileProduct& product) {
  product_by<4>(tile, bands, product);
}
PATCHLIGHT_TARGET_AVX512 void product_here(const float* tile, int bands, const TileProduct& product) {
  product_by<8>(tile, bands, product);
}
#endif

}  // namespace

void gather_tile(const float* tile, int bands, const double* b_J, double* sums_I) {
  product_here(tile, bands, {nullptr, b_J, sums_I, nullptr});
}

void push_tile(const float* tile, int bands, const double* b_I, double* out_J) {
  product_here(tile, bands, {b_I, nullptr, nullptr, out_J});
}

void multiply_tile(const float* tile, int bands, const TileProduct& product) { product_here(tile, bands, product); }

namespace {

// Where a row of a packed field of so many bands has its value of a band.
std::size_t place_of(Eigen::Index row, Eigen::Index band, Eigen::Index bands) {
  constexpr auto width = static_cast<Eigen::Index>(simd_width);
  return static_cast<std::size_t>((row / width * bands + band) * width + row % width);
}

}  // namespace

RowSums::RowSums(int bands) : lanes(tile_edge * static_cast<std::size_t>(bands) * simd_width, 0.0) {}

void add_sums(const RowSums& sums, int bands, double* out_I) {
  const Eigen::Index of = bands;
  for (Eigen::Index r = 0; r < Eigen::Index{tile_edge}; ++r) {
    for (Eigen::Index band = 0; band < of; ++band) {
      const double* const v = &sums.lanes[static_cast<std::size_t>(r * of + band) * simd_width];
      out_I[place_of(r, band, of)] += ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
    }
  }
}

PackedField summed(PackedField parts, PatchIndex count) {
  const std::size_t size = parts.values.size() / count;
  double* const sum = parts.values.data();
  for (std::size_t part = 1; part < count; ++part) {
    for (std::size_t k = 0; k < size; ++k) sum[k] += sum[part * size + k];
  }
  parts.values.resize(size);
  return parts;
}

PackedField::PackedField(PatchIndex blocks, int bands_of_each)
    : bands(bands_of_each), values(static_cast<std::size_t>(blocks) * tile_edge * bands_of_each, 0.0) {}

PackedField::PackedField(const FieldView& field, PatchIndex blocks)
    : PackedField(blocks, static_cast<int>(field.cols())) {
  set_rows(0, field);
}

Field PackedField::rows(Eigen::Index begin, Eigen::Index rows) const {
  Field field(rows, bands);
  for (Eigen::Index r = 0; r < rows; ++r)
    for (Eigen::Index band = 0; band < bands; ++band) field(r, band) = values[place_of(begin + r, band, bands)];
  return field;
}

void PackedField::set_rows(Eigen::Index begin, const FieldView& field) {
  for (Eigen::Index r = 0; r < field.rows(); ++r)
    for (Eigen::Index band = 0; band < bands; ++band) values[place_of(begin + r, band, bands)] = field(r, band);
}

namespace {

std::array<float, std::size_t{tile_edge} * tile_edge> squared(std::span<const float> tile) {
  std::array<float, std::size_t{tile_edge} * tile_edge> squares;
  for (std::size_t k = 0; k < squares.size(); ++k) squares[k] = tile[k] * tile[k];
  return squares;
}

// Sums that take the products of one stripe.
struct Sums {
  PackedField& field;
  PatchIndex first;  // block at which they begin
  double* block(PatchIndex I) const { return field.block(first + I); }
};

// Adds the products of the tiles of block row I with b.
void multiply_row(const ExchangeAreas& S, PatchIndex I, const PackedField& b, int power, const Sums& sum) {
  RowSums row_sums(b.bands);
  for (PatchIndex J = I; J < Tiles::blocks(S); ++J) {
    const auto multiply_with = [&](const float* tile) {
      if (I == J) return gather_tile(tile, b.bands, b.block(J), row_sums.lanes.data());
      multiply_tile(tile, b.bands, {b.block(I), b.block(J), row_sums.lanes.data(), sum.block(J)});
    };
    if (power == 1) {
      multiply_with(Tiles::of(S, I, J).data());
    } else {
      multiply_with(squared(Tiles::of(S, I, J)).data());
    }
  }
  add_sums(row_sums, b.bands, sum.block(I));
}

}  // namespace

Field multiply(const ExchangeAreas& S, const FieldView& B, int power) {
  assert(B.rows() == static_cast<Eigen::Index>(S.size()) && (power == 1 || power == 2));
  const PackedField b(B, Tiles::blocks(S));

  // Stripe s takes the block rows s, s + stripes, ...: long and short rows spread evenly.
  PackedField partial(stripes * Tiles::blocks(S), b.bands);
  parallel_for(stripes, [&](std::size_t stripe) {
    for (auto I = static_cast<PatchIndex>(stripe); I < Tiles::blocks(S); I += stripes) {
      multiply_row(S, I, b, power, {partial, static_cast<PatchIndex>(stripe) * Tiles::blocks(S)});
    }
  });
  return summed(std::move(partial), stripes).rows(0, B.rows());
}

Eigen::VectorXd row_sums(const ExchangeAreas& S) {
  return multiply(S, Field::Ones(static_cast<Eigen::Index>(S.size()), 1)).matrix().col(0);
}

}  // namespace patchlight
