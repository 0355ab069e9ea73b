#include "transport/tile_kernel.h"

#include "base/target_clones.h"
#include "transport/tiles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t width = 8;  // patches side by side: doubles of an AVX-512 register

// The compiler makes of these what the instruction set has.
using Doubles [[gnu::vector_size(sizeof(double) * width), gnu::aligned(sizeof(double)), gnu::may_alias]] = double;

// Floats fetched ahead of their use: about what arrives in the time of a memory access.
constexpr std::size_t ahead = 2048;

// Some of the bands of a packed field.
struct BandRange {
  std::size_t first;
  std::size_t of;
};

// `bands` bands from range.first on; in one piece, as the sums have to stay in registers. Four rows at once, so that
// b_J and out_J are loaded a quarter as often.
template <std::size_t bands, bool gather, bool push>
PATCHLIGHT_INLINE void multiply(const float* tile, const BandRange range, const TileProduct product) {
  constexpr std::size_t rows = 4;
  for (std::size_t r = 0; r < tile_edge; r += rows) {
    Doubles sums[rows][bands];
    const std::size_t place_sums = (r * range.of + range.first) * width;
    if constexpr (gather) {
      for (std::size_t k = 0; k < rows; ++k) {
        for (std::size_t band = 0; band < bands; ++band) {
          sums[k][band] =
              *reinterpret_cast<const Doubles*>(product.sums_I + place_sums + (k * range.of + band) * width);
        }
      }
    }
    Doubles b[rows][bands];
    // Where row r is in a packed block; the next rows and bands follow.
    const std::size_t place_r = (r / width * range.of + range.first) * width + r % width;
    if constexpr (push) {
      for (std::size_t k = 0; k < rows; ++k) {
        for (std::size_t band = 0; band < bands; ++band) {
          b[k][band] = Doubles{} + product.b_I[place_r + band * width + k];
        }
      }
    }
    // The rows in double, and those of later on their way into the cache, be it beyond the last tile.
    alignas(64) double wide[rows * tile_edge];
    const auto later = reinterpret_cast<std::uintptr_t>(tile + r * tile_edge) + ahead * sizeof(float);
    for (std::size_t line = 0; line < rows * tile_edge * sizeof(float); line += 64) {
      __builtin_prefetch(reinterpret_cast<const void*>(later + line));
    }
    for (std::size_t c = 0; c < rows * tile_edge; ++c) wide[c] = static_cast<double>(tile[r * tile_edge + c]);

    for (std::size_t c = 0; c < tile_edge; c += width) {
      const std::size_t place = c * range.of + range.first * width;
      Doubles s[rows];
      for (std::size_t k = 0; k < rows; ++k) s[k] = *reinterpret_cast<const Doubles*>(&wide[k * tile_edge + c]);
      for (std::size_t band = 0; band < bands; ++band) {
        if constexpr (gather) {
          const Doubles from = *reinterpret_cast<const Doubles*>(product.b_J + place + band * width);
          for (std::size_t k = 0; k < rows; ++k) sums[k][band] += s[k] * from;
        }
        if constexpr (push) {
          Doubles* const out = reinterpret_cast<Doubles*>(product.out_J + place + band * width);
          Doubles sum = *out;
          for (std::size_t k = 0; k < rows; ++k) sum += s[k] * b[k][band];
          *out = sum;
        }
      }
    }
    if constexpr (gather) {
      for (std::size_t k = 0; k < rows; ++k) {
        for (std::size_t band = 0; band < bands; ++band) {
          *reinterpret_cast<Doubles*>(product.sums_I + place_sums + (k * range.of + band) * width) = sums[k][band];
        }
      }
    }
  }
}

// Three bands at a time: their sums fit into the registers.
template <bool gather, bool push>
PATCHLIGHT_INLINE void for_bands(const float* tile, int bands, const TileProduct& product) {
  const auto of = static_cast<std::size_t>(bands);
  std::size_t first = 0;
  for (; first + 3 <= of; first += 3) multiply<3, gather, push>(tile, {first, of}, product);
  if (of - first == 2) multiply<2, gather, push>(tile, {first, of}, product);
  if (of - first == 1) multiply<1, gather, push>(tile, {first, of}, product);
}

}  // namespace

PATCHLIGHT_TARGET_CLONES
void gather_tile(const float* tile, int bands, const double* b_J, double* sums_I) {
  for_bands<true, false>(tile, bands, {nullptr, b_J, sums_I, nullptr});
}

PATCHLIGHT_TARGET_CLONES
void push_tile(const float* tile, int bands, const double* b_I, double* out_J) {
  for_bands<false, true>(tile, bands, {b_I, nullptr, nullptr, out_J});
}

PATCHLIGHT_TARGET_CLONES
void multiply_tile(const float* tile, int bands, const TileProduct& product) {
  for_bands<true, true>(tile, bands, product);
}

RowSums::RowSums(int bands) : lanes(tile_edge * static_cast<std::size_t>(bands) * width, 0.0) {}

void add_sums(const RowSums& sums, int bands, double* out_I) {
  const auto of = static_cast<std::size_t>(bands);
  for (std::size_t r = 0; r < tile_edge; ++r) {
    for (std::size_t band = 0; band < of; ++band) {
      const double* const v = &sums.lanes[(r * of + band) * width];
      out_I[(r / width * of + band) * width + r % width] +=
          ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
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
  for (Eigen::Index r = 0; r < rows; ++r) {
    const auto i = static_cast<std::size_t>(begin + r);
    for (int band = 0; band < bands; ++band) {
      field(r, band) = values[(i / width * bands + static_cast<std::size_t>(band)) * width + i % width];
    }
  }
  return field;
}

void PackedField::set_rows(Eigen::Index begin, const FieldView& field) {
  for (Eigen::Index r = 0; r < field.rows(); ++r) {
    const auto i = static_cast<std::size_t>(begin + r);
    for (int band = 0; band < bands; ++band) {
      values[(i / width * bands + static_cast<std::size_t>(band)) * width + i % width] = field(r, band);
    }
  }
}

}  // namespace patchlight
