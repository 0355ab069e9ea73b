#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace patchlight {

/// The irradiance at a point, and how it changes around it.
struct IrradianceRecord {
  Point point;
  Vector normal;           ///< unit
  double radius = 0;       ///< metres, how far it may serve
  Spectrum irradiance;     ///< W/m^2
  Field gradient;          ///< per metre along x, y and z (rows) and band (columns)
  double uncertainty = 0;  ///< standard error of its luminance by sampling, as cd/m^2 is weighted
};

/// An irradiance from the records around.
struct CachedIrradiance {
  Spectrum irradiance;   ///< W/m^2
  double deviation = 0;  ///< standard error, by what the records say of their own and differ, weighted as luminance is
};

/// Irradiances at points from which others around are interpolated: Ward, Rubinstein and Clear 1988, with gradients
/// (Ward and Heckbert 1992) and weights that fall to 0 at a record's radius (Tabellion and Lamorlette 2004), so that no
/// seam is left where it ends.
class IrradianceCache {
 public:
  explicit IrradianceCache(Eigen::VectorXd luminous_weights);

  void add(const IrradianceRecord& record);

  /// Several, after which no radius is larger than that of a record which it reaches and a share of the distance to it:
  /// what one finds near an edge others do not cover up (Krivanek and others 2006, neighbour clamping).
  void add_graded(const std::vector<IrradianceRecord>& records);

  std::size_t size() const { return reaches_.size(); }

  /// The sum of the weights of the records that may serve at a place of a surface with this unit normal.
  double weight_at(const Point& point, const Vector& normal) const;

  /// Nothing where there is no such record.
  std::optional<CachedIrradiance> at(const Point& point, const Vector& normal) const;

 private:
  /// What decides whether a record serves at a place.
  struct Reach {
    Point point;
    Vector normal;
    double radius = 0;
    double uncertainty = 0;
  };
  struct Level {
    int log2_of_edge = 0;  // metres
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

}  // namespace patchlight
