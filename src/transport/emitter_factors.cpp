#include "transport/emitter_factors.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "form_factor/point_polygon.h"
#include "scene/triangulate.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <bit>

namespace patchlight {
namespace {

// A triangle or convex quadrilateral of an emitter.
struct EmitterPiece {
  PatchShape shape;
  SampledPatch sampled;
  double nonspecular = 1;   // the share of arriving light that is neither transmitted nor mirrored
  std::uint32_t key = 0;    // chooses random points
  std::size_t emitter = 0;  // which of the emitters it belongs to
};

// Counter-clockwise from the emitting side.
std::vector<PatchCorners> pieces_of(const Scene& scene, const EmitterSide& emitter) {
  std::vector<Point> points = corner_points(scene, emitter.polygon);
  if (emitter.side == Side::back) std::reverse(points.begin(), points.end());
  std::vector<PatchCorners> pieces;
  for (const std::array<Point, 4>& piece : convex_pieces(points))
    pieces.push_back({piece, piece[2] == piece[3] ? 3 : 4});
  return pieces;
}

// The pieces of all emitters, one emitter after the other. `keys` of the mesh's patches, patch_keys().
std::vector<EmitterPiece> emitter_pieces(const Scene& scene, const PatchMesh& mesh, const Occluder& occluder,
                                         std::span<const EmitterSide> emitters,
                                         const std::vector<std::uint32_t>& keys) {
  std::vector<EmitterPiece> pieces;
  for (std::size_t emitter = 0; emitter < emitters.size(); ++emitter) {
    const auto& [polygon, side] = emitters[emitter];
    const PatchRange patches = mesh.patches_on(polygon, side);
    std::uint32_t key = patches.begin < patches.end ? keys[patches.begin] : 0;
    for (const PatchCorners& corners : pieces_of(scene, emitters[emitter])) {
      const PatchShape shape = patch_shape(corners);
      key = hash(key);
      pieces.push_back({shape, sampled_patch(shape, polygon, occluder.frame()),
                        occluder.optics().nonspecular_fraction(polygon, side), key, emitter});
    }
  }
  return pieces;
}

// Shadow rays of a pair in one half; where it is partly visible four times as many.
std::uint32_t usual_rays(const EmitterSampling& sampling) {
  const std::uint32_t packet = ShadowPacket::size;
  return packet * std::bit_ceil(std::max(static_cast<std::uint32_t>(sampling.rays) / (4 * packet), 1U));
}

// The result of the shadow rays of one half of a pair.
struct EmitterRays {
  float weight = 0;       // summed geometry terms, 1/m^2
  float seen_weight = 0;  // each times what its ray lets through
  float seen = 0;         // summed shares that are let through, of samples with a weight
  std::uint32_t weighted = 0;
  std::uint32_t all = 0;

  double visible_share() const { return weighted > 0 ? static_cast<double>(seen) / weighted : 0; }
  bool is_partial() const { return seen > 0 && seen != static_cast<float>(weighted); }
};

// Errors pooled over pairs by their visible share: none, seven parts between, all, and more, as clear faces have at an
// angle.
struct Pool {
  static constexpr std::size_t bins = 10;
  std::array<double, bins> squares{};  // summed variances of the mean of both halves
  std::array<double, bins> weights{};  // summed squares of the form factors without occluders

  static std::uint8_t bin(double share) {
    if (!(share > 0)) return 0;
    if (share > 1) return bins - 1;
    if (share == 1) return bins - 2;
    return static_cast<std::uint8_t>(1 + static_cast<int>(share * (bins - 3)));
  }
  void add(std::uint8_t at, double square, double weight) {
    squares[at] += square;
    weights[at] += weight;
  }
  double variance(std::uint8_t at) const { return weights[at] > 0 ? squares[at] / weights[at] : 0; }
};

// A patch with a piece, in both halves.
struct EmitterPair {
  std::array<double, 2> form_factor{};
  double unoccluded = 0;
  std::array<std::uint8_t, 2> bin{};
};

struct EmitterSampler {
  const PatchMesh& mesh;
  const Occluder& occluder;
  std::vector<EmitterPiece> pieces;
  std::vector<std::uint32_t> keys;
  std::uint32_t usual;  // rays of a pair in one half
  SampleTable table;
  bool can_occlude;
  double scale;

  double unoccluded(const PatchShape& patch, const EmitterPiece& piece) const;
  void trace(EmitterRays& rays, const SampledPatch& patch, const EmitterPiece& piece, const SampleSet& set,
             std::uint32_t upto) const;
  EmitterPair pair(PatchIndex i, const PatchShape& patch, const SampledPatch& sampled, const EmitterPiece& piece,
                   std::uint64_t& shadow_rays) const;
};

double EmitterSampler::unoccluded(const PatchShape& patch, const EmitterPiece& piece) const {
  // The form factor of a point varies with the square of diameter over distance: a patch 8 diameters away from a piece
  // is taken at its centroid, and one 2 diameters away at three or four points.
  const double distance = (piece.shape.centroid - patch.centroid).norm() - piece.shape.radius;
  const double diameter = 2 * patch.radius;
  if (distance < 2 * diameter) return unoccluded_exchange_area(patch, piece.shape, FarRule::fine) / patch.area;
  if (distance > 8 * diameter) return point_to_polygon(patch.centroid, patch.normal, piece.shape.corners);
  double sum = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(patch.coarse.count); ++k) {
    const Point at(patch.coarse.x[k], patch.coarse.y[k], patch.coarse.z[k]);
    sum += patch.coarse.weight[k] * point_to_polygon(at, patch.normal, piece.shape.corners);
  }
  return sum / patch.area;
}

// Samples up to number `upto`, packet by packet.
void EmitterSampler::trace(EmitterRays& rays, const SampledPatch& patch, const EmitterPiece& piece,
                           const SampleSet& set, std::uint32_t upto) const {
  PairSamples next;
  while (rays.all < upto) {
    add_samples(next, 0, ShadowPacket::size, patch, piece.sampled, set, rays.all, scale);
    const auto arriving = occluder.transmittance(next.rays);
    for (std::size_t lane = 0; lane < ShadowPacket::size; ++lane) {
      if (!(next.weight[lane] > 0)) continue;
      rays.weight += next.weight[lane];
      rays.seen_weight += next.weight[lane] * arriving[lane];
      rays.seen += arriving[lane];
      ++rays.weighted;
    }
    rays.all += ShadowPacket::size;
  }
}

// docs/theory/occluded-form-factors.md, formula (5), as PairSampler::exchange_area(); U is the form factor without
// occluders, w_k = A G_k with the area of the emitter's piece. It is at most `most`.
double form_factor_by(const EmitterRays& rays, double U, double area, double most) {
  const double share = rays.visible_share();
  if (share == 0) return 0;
  const double n = rays.all;
  const double m = rays.weighted;
  if (share == 1 || m < 2) return share * U;
  const double free = area * static_cast<double>(rays.seen_weight);
  const double weight = area * static_cast<double>(rays.weight);
  const double by_others = (static_cast<double>(rays.seen) * ((m - 1) * U - weight) + free) / (m - 1);
  return std::clamp((free + by_others + (n - m) * share * U) / n, 0.0, most);
}

EmitterPair EmitterSampler::pair(PatchIndex i, const PatchShape& patch, const SampledPatch& sampled,
                                 const EmitterPiece& piece, std::uint64_t& shadow_rays) const {
  if (orientation(patch, piece.shape) == Orientation::averted) return {};
  EmitterPair pair;
  if (!can_occlude) {
    pair.unoccluded = piece.nonspecular * unoccluded(patch, piece);
    pair.form_factor = {pair.unoccluded, pair.unoccluded};
    pair.bin = {Pool::bins - 1, Pool::bins - 1};
    return pair;
  }
  // 1. The usual rays of both halves; more where those of the other half disagree.
  std::array<SampleSet, 2> sets;
  std::array<EmitterRays, 2> rays;
  for (std::uint32_t half = 0; half < 2; ++half) {
    sets[half] = table.of_pair(keys[i], piece.key, half);
    trace(rays[half], sampled, piece, sets[half], usual);
  }
  const std::array<bool, 2> more{rays[1].is_partial(), rays[0].is_partial()};
  for (std::size_t half = 0; half < 2; ++half)
    if (more[half]) trace(rays[half], sampled, piece, sets[half], 4 * usual);
  shadow_rays += rays[0].all + rays[1].all;

  // 2. The form factor without occluders is not worth its time where nothing is seen.
  if (rays[0].seen + rays[1].seen > 0) pair.unoccluded = piece.nonspecular * unoccluded(patch, piece);
  // A clear patch may scatter or absorb all light at some angle.
  const double most =
      pair.unoccluded / (piece.nonspecular * occluder.optics().nonspecular_fraction(mesh.polygon[i], mesh.side[i]));
  for (std::size_t half = 0; half < 2; ++half) {
    pair.form_factor[half] = form_factor_by(rays[half], pair.unoccluded, piece.nonspecular * piece.shape.area, most);
    pair.bin[half] = Pool::bin(rays[half].visible_share());
  }
  return pair;
}

// The values of each patch (row) and piece (column) until the pool is known.
struct PieceValues {
  template <typename Value>
  using Table = Eigen::Array<Value, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Table<float> unoccluded;
  std::array<Table<std::uint8_t>, 2> bin;
};

struct EmitterTask {
  Pool pool;
  std::uint64_t shadow_rays = 0;
};

// All pieces with one patch.
void sample_patch(const EmitterSampler& sampler, PatchIndex i, EmitterFactors& factors, PieceValues& values,
                  EmitterTask& task) {
  const PatchShape patch = patch_shape(sampler.mesh, i);
  const SampledPatch sampled = sampled_patch(patch, sampler.mesh.polygon[i], sampler.occluder.frame());
  for (std::size_t k = 0; k < sampler.pieces.size(); ++k) {
    const EmitterPiece& piece = sampler.pieces[k];
    const auto column = static_cast<Eigen::Index>(k);
    const EmitterPair pair = sampler.pair(i, patch, sampled, piece, task.shadow_rays);
    const double difference = 0.5 * (pair.form_factor[0] - pair.form_factor[1]);
    values.unoccluded(i, column) = static_cast<float>(pair.unoccluded);
    for (std::size_t half = 0; half < 2; ++half) {
      factors.halves[half](i, static_cast<Eigen::Index>(piece.emitter)) += static_cast<float>(pair.form_factor[half]);
      values.bin[half](i, column) = pair.bin[half];
      task.pool.add(pair.bin[half], difference * difference, pair.unoccluded * pair.unoccluded);
    }
  }
}

// The variances of the means of both halves, by the visible shares that either half has found.
EmitterValues standard_errors(const EmitterSampler& sampler, const PieceValues& values, const Pool& pool,
                              Eigen::Index emitters) {
  EmitterValues squares = EmitterValues::Zero(values.unoccluded.rows(), emitters);
  for (Eigen::Index i = 0; i < squares.rows(); ++i) {
    for (std::size_t k = 0; k < sampler.pieces.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const auto bin = [&](std::size_t half) { return values.bin[half](i, column); };
      const double variance = 0.5 * (pool.variance(bin(0)) + pool.variance(bin(1)));
      const auto U = static_cast<double>(values.unoccluded(i, column));
      squares(i, static_cast<Eigen::Index>(sampler.pieces[k].emitter)) += static_cast<float>(variance * U * U);
    }
  }
  return squares.sqrt();
}

}  // namespace

std::size_t piece_count(const Scene& scene, const EmitterSide& emitter) { return pieces_of(scene, emitter).size(); }

EmitterFactors emitter_factors(const Scene& scene, const PatchMesh& mesh, const Occluder& occluder,
                               std::span<const EmitterSide> emitters, const EmitterSampling& sampling,
                               const Observer& observer) {
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  const std::uint32_t usual = usual_rays(sampling);
  const EmitterSampler sampler{mesh,
                               occluder,
                               emitter_pieces(scene, mesh, occluder, emitters, keys),
                               keys,
                               usual,
                               SampleTable(4 * usual, hash({sampling.seed, stream::points_on_emitters})),
                               occluder.can_occlude(),
                               occluder.frame().scale};
  const auto rows = static_cast<Eigen::Index>(mesh.size());
  const auto count = static_cast<Eigen::Index>(emitters.size());
  const auto pieces = static_cast<Eigen::Index>(sampler.pieces.size());
  EmitterFactors factors;
  for (EmitterValues& half : factors.halves) half = EmitterValues::Zero(rows, count);
  PieceValues values;
  values.unoccluded.resize(rows, pieces);
  for (auto& bin : values.bin) bin.resize(rows, pieces);

  // 1. Both halves of every pair.
  constexpr PatchIndex at_once = 256;
  std::vector<EmitterTask> tasks((mesh.size() + at_once - 1) / at_once);
  parallel_for(tasks.size(), Stage::form_factors, observer, [&](std::size_t t) {
    const auto begin = static_cast<PatchIndex>(t * at_once);
    for (PatchIndex i = begin; i < std::min(begin + at_once, mesh.size()); ++i)
      sample_patch(sampler, i, factors, values, tasks[t]);
  });

  // 2. The errors that their differences show.
  Pool pool;
  for (const EmitterTask& task : tasks) {
    factors.shadow_rays += task.shadow_rays;
    for (std::uint8_t bin = 0; bin < Pool::bins; ++bin) pool.add(bin, task.pool.squares[bin], task.pool.weights[bin]);
  }
  factors.standard_error = standard_errors(sampler, values, pool, count);
  return factors;
}

}  // namespace patchlight
