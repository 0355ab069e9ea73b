#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/mesh/patch_mesh.h"

#include "mesh/patch_lookup.h"
#include "render/light_samples.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace patchlight {

/// The estimate by rays over a hemisphere.
struct HemisphereIrradiance {
  Spectrum irradiance;  ///< W/m^2
  Spectrum variance;    ///< of it
  Field gradient;       ///< per meter the point is moved along x, y and z (rows), W/m^3 per band
};

/// Directions over a hemisphere, distributed as the cosine: one in each of M rings by N sectors of equal weight.
class Hemisphere {
 public:
  /// About `rays` directions around a unit normal.
  Hemisphere(int rays, const Vector& normal);

  /// Ring by ring; random in their cells.
  std::vector<Vector> directions(std::uint32_t seed) const;

  /// The irradiance by the radiosity that each of these finds, W/m^2, and how far away, meters: its mean, as directions
  /// are distributed as cos / pi. Its translational gradient: Ward and Heckbert 1992, Irradiance Gradients. Its
  /// variance by the differences of neighbors in a ring.
  HemisphereIrradiance irradiance(const FieldView& radiosity, std::span<const double> distances) const;

  /// The harmonic mean of these distances, meters; infinite if all are.
  double harmonic_mean(std::span<const double> distances) const;

 private:
  std::size_t cell(int ring, int sector) const;
  double sine(int ring) const;  // of the polar angle where a ring begins

  int rings_, sectors_;
  Vector normal_, first_, second_;
};

/// The irradiance at a point, and how it changes around it.
struct IrradianceRecord {
  Point point;
  Vector normal;           ///< unit
  double radius = 0;       ///< meters, how far it may serve
  Spectrum irradiance;     ///< W/m^2
  Field gradient;          ///< per meter along x, y and z (rows) and band (columns)
  double uncertainty = 0;  ///< standard error of its luminance by sampling, as cd/m^2 is weighted
};

/// An irradiance from the records around.
struct CachedIrradiance {
  Spectrum irradiance;   ///< W/m^2
  double deviation = 0;  ///< standard error, by those of the records and their differences, weighted as luminance is
};

/// Irradiances at points from which others around are interpolated: Ward, Rubinstein and Clear 1988, with gradients
/// (Ward and Heckbert 1992) and weights that fall to 0 at a record's radius (Tabellion and Lamorlette 2004), so that no
/// seam is left where it ends.
class IrradianceCache {
 public:
  explicit IrradianceCache(Eigen::VectorXd luminous_weights);

  void add(const IrradianceRecord& record);

  /// Several, after which no radius is larger than that of a record which it reaches and a share of the distance to it
  /// (Krivanek and others 2006, neighbor clamping).
  void add_graded(const std::vector<IrradianceRecord>& records);

  std::size_t size() const { return reaches_.size(); }

  /// The sum of the weights of the records that may serve at a place of a surface with this unit normal.
  double weight_at(const Point& point, const Vector& normal) const;

  /// Nothing where there is no such record.
  std::optional<CachedIrradiance> at(const Point& point, const Vector& normal) const;

 private:
  /// The part of a record that decides whether it serves at a place.
  struct Reach {
    Point point;
    Vector normal;
    double radius = 0;
    double uncertainty = 0;
  };
  struct Level {
    int log2_of_edge = 0;  // meters
    double cells_per_metre = 1;
  };
  struct Weighted {
    std::uint32_t index;
    double weight;
  };
  static double weight_of(const Reach& record, const Point& point, const Vector& normal);
  std::vector<Weighted> around(const Point& point, const Vector& normal) const;
  /// Calls see(index, weight) for each record that serves there.
  template <typename See>
  void for_each_around(const Point& point, const Vector& normal, const See& see) const;
  Level level_for(double radius);

  Eigen::VectorXd luminous_weights_;
  std::vector<Reach> reaches_;
  std::vector<double> values_;  // per record and band: irradiance, and its slopes along x, y and z
  std::vector<Level> levels_;   // of cells, those that are in use
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

/// A solved scene for a final gather. Fields have a row per patch and a column per band.
struct SolvedLight {
  const PatchMesh& mesh;
  const Occluder& occluder;  ///< of all faces
  LightSampler lights;
  Field exitance;   ///< W/m^2
  Field reflected;  ///< radiosity without exitance, W/m^2; 0 where nothing is reflected twice
  Field reflectance;
  std::vector<PatchIndex> other_side{};  ///< as Scattering has it
  Field transmittance{};
  Eigen::VectorXd luminous_weights;  ///< per band
  const Scene* scene = nullptr;      ///< whose pictures show; none: patches have one reflectance each
};

/// The reflectance at a point of a patch: that of the texel where a picture is on it, else the patch's.
Spectrum reflectance_at(const SolvedLight& light, PatchIndex patch, const Point& point);

/// The optics of the clear faces and mirrors.
const SurfaceOptics& optics_of(const SolvedLight& light);

/// False where only the solution has the scattered light: at clear faces and mirrors.
bool is_plain(const SolvedLight& light, PatchIndex patch);

/// The patch on the other side of a sheet.
std::optional<PatchIndex> behind(const SolvedLight& light, PatchIndex patch);

/// A place of a patch.
struct PatchPoint {
  Point point;
  PatchIndex patch = 0;
};

/// Per patch its rays to the sky.
using SkyAims = std::map<PatchIndex, SkyAim>;

/// How the light from other patches is gathered at a point.
struct HemisphereOptions {
  int rays = 1024;
  int most_bounces = 3;  ///< before the solution is asked all the same
  std::uint32_t seed = 1;
};

/// The irradiance of points by light that patches have reflected at least once.
class GatheredLight {
 public:
  /// Keeps a reference, which must outlive it.
  explicit GatheredLight(const SolvedLight& solved);

  /// The record of a point, by rays distributed as the cosine over its hemisphere, stratified, into the solution. Where
  /// a ray meets a patch that is wider than the ray is long, it goes on from there by the same rule, with light
  /// straight from lights. Its radius is a share of the harmonic mean of the rays' lengths, and of the length over
  /// which the irradiance changes by itself, and from `least` to `most` meters. Follows from the seed and the point's
  /// `key` alone.
  IrradianceRecord record_at(const PatchPoint& at, std::uint64_t key, double least, double most,
                             const HemisphereOptions& options) const;

  const PatchLookup& lookup() const { return lookup_; }

  /// A point of a patch for light_samples(). It refers to an aim that is kept in `aims`.
  LitPoint lit_point(const PatchPoint& at, std::uint32_t sample, std::uint32_t seed, SkyAims& aims) const;

 private:
  struct Stop;
  /// The rays to the sky that a place of a patch gets.
  SkyAim aim_at(PatchIndex patch) const;
  struct Stops;
  Stops stops_of(std::vector<Ray> rays, std::uint64_t seed) const;
  Field arriving(const std::vector<Stop>& stops, int bounces_left, std::uint32_t seed) const;
  bool is_near(const Stop& stop) const;
  static Field sums_of_rays(const std::vector<Stop>& stops, const Field& arriving, std::size_t rays);

  const SolvedLight& solved_;
  PatchLookup lookup_;
};

}  // namespace patchlight
