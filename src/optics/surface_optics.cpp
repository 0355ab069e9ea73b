#include "optics/surface_optics.h"

#include "base/sampling.h"
#include "light/photometry.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

namespace patchlight {

double cosine_between(const Vector& normal, const Vector& direction) {
  return std::min(1.0, std::abs(normal.dot(direction)));
}

SpecularSurface::SpecularSurface(const Scene& scene, PolygonIndex polygon, Reflections reflections)
    : reflections_(reflections), bands_(number_of_bands(scene)) {
  const Spectrum shares = luminous_shares(bands_of(scene));
  const bool is_clear = is_opening(scene, polygon);
  for (const Side side : {Side::front, Side::back}) {
    const Material& material = scene.materials[material_on(scene.polygons[polygon], side)];
    const auto s = static_cast<std::size_t>(side);
    if (is_clear) panes_[s] = panes_of(material.index, material.transmittance);
    const std::vector<Pane>& panes = panes_[s];
    if (is_clear) index_ += material.index / 2;
    for (std::size_t band = 0; band < panes.size() && is_clear; ++band) {
      const auto found =
          std::find_if(parts_.begin(), parts_.end(), [&](const Part& part) { return part.pane == panes[band]; });
      const double weight = shares[static_cast<Eigen::Index>(band)] / 2;
      if (found == parts_.end()) {
        parts_.push_back({weight, panes[band]});
      } else {
        found->weight += weight;
      }
    }
    if (is_clear || reflections == Reflections::kept) continue;
    mirrors_[s] = material.specular_reflectance;
    is_mirror_[s] = is_mirror(scene, polygon, side) ? 1 : 0;
    for (Eigen::Index band = 0; band < material.specular_reflectance.size(); ++band)
      mirrored_[s] += shares[band] * material.specular_reflectance[band];
    nonspecular_[s] = nonspecular_rest(mirrored_[s]);
  }
  if (is_clear) tabulate_nonspecular();
}

Spectrum SpecularSurface::spectral_transmittance(Side side, double cosine) const {
  const std::vector<Pane>& panes = panes_[static_cast<std::size_t>(side)];
  return panes.empty() ? Spectrum(Spectrum::Zero(bands_)) : patchlight::transmittance(panes, cosine);
}

Spectrum SpecularSurface::spectral_reflectance(Side side, double cosine) const {
  const auto s = static_cast<std::size_t>(side);
  if (reflections_ == Reflections::followed && !panes_[s].empty()) return specular_reflectance(panes_[s], cosine);
  return mirrors_[s].size() > 0 ? mirrors_[s] : Spectrum(Spectrum::Zero(bands_));
}

bool SpecularSurface::transmits_colour() const {
  return std::ranges::any_of(panes_, [](const std::vector<Pane>& panes) {
    return std::ranges::adjacent_find(panes, std::not_equal_to()) != panes.end();
  });
}

void SpecularSurface::tabulate_nonspecular() {
  nonspecular_upto_.push_back(0);
  for (std::size_t k = 0; k < cosine_steps; ++k)
    nonspecular_upto_.push_back(nonspecular_upto_.back() + irradiance_of_step(k) * kept(cosine_of_step(k)));
  nonspecular_.fill(nonspecular_upto_.back());
  for (double& upto : nonspecular_upto_) upto /= nonspecular_[0];
}

PaneShares SpecularSurface::by_panes(double cosine) const {
  PaneShares sum;
  for (const Part& part : parts_) {
    const auto [transmitted, reflected] = patchlight::shares(part.pane, cosine);
    sum.transmitted += part.weight * transmitted;
    if (reflections_ != Reflections::kept) sum.reflected += part.weight * reflected;
  }
  return sum;
}

double SpecularSurface::transmittance(double cosine) const { return by_panes(cosine).transmitted; }

double SpecularSurface::reflectance(Side side, double cosine) const {
  return parts_.empty() ? mirrored_[static_cast<std::size_t>(side)] : by_panes(cosine).reflected;
}

double SpecularSurface::kept(double cosine) const {
  const auto [transmitted, reflected] = by_panes(cosine);
  return nonspecular_rest(transmitted + reflected);
}

double SpecularSurface::nonspecular_fraction(Side side) const { return nonspecular_[static_cast<std::size_t>(side)]; }

SpecularShares SpecularSurface::shares(Side side, double cosine) const {
  if (parts_.empty()) {
    const auto s = static_cast<std::size_t>(side);
    return {0, mirrored_[s], nonspecular_[s], 1};
  }
  const auto [transmitted, reflected] = by_panes(cosine);
  SpecularShares shares{transmitted, reflected, 0, 0};
  shares.nonspecular = nonspecular_rest(shares.transmitted + shares.mirrored);
  shares.nonspecular_profile = shares.nonspecular / nonspecular_[0];
  return shares;
}

double SpecularSurface::mirrored_rays(Side side, double cosine) const {
  if (parts_.empty()) return is_mirror_[static_cast<std::size_t>(side)];
  return reflections_ == Reflections::kept ? 0 : specular_reflectance(Pane{index_, 1}, cosine);
}

double SpecularSurface::kind(Side side) const {
  if (parts_.empty()) return is_mirror_[static_cast<std::size_t>(side)];
  return reflections_ == Reflections::kept ? -1 : 1 + index_;
}

// A mirror keeps the same share at all angles.
double SpecularSurface::nonspecular_profile(double cosine) const {
  return parts_.empty() ? 1 : kept(cosine) / nonspecular_[0];
}

// Within a step the density is taken as even.
double SpecularSurface::sample_nonspecular_cosine(double u) const {
  if (parts_.empty()) return std::sqrt(u);
  const auto next = std::upper_bound(nonspecular_upto_.begin() + 1, nonspecular_upto_.end() - 1, u);
  const double before = *(next - 1);
  const auto step = static_cast<double>(next - nonspecular_upto_.begin() - 1);
  return std::clamp((step + (u - before) / (*next - before)) / cosine_steps, 0.0, 1.0);
}

SurfaceOptics::SurfaceOptics(const Scene& scene, Reflections reflections)
    : bands_(number_of_bands(scene)), reflections_(reflections) {
  std::map<std::pair<MaterialIndex, MaterialIndex>, std::uint32_t> known;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_opening(scene, p) && !is_mirror(scene, p, Side::front) && !is_mirror(scene, p, Side::back)) continue;
    if (faces_.empty()) {
      of_polygon_.assign(scene.polygons.size(), not_specular);
      normals_.assign(scene.polygons.size(), Vector::Zero());
    }
    const Polygon& polygon = scene.polygons[p];
    const auto [place, is_new] = known.insert({{material_on(polygon, Side::front), material_on(polygon, Side::back)},
                                               static_cast<std::uint32_t>(faces_.size())});
    if (is_new) faces_.emplace_back(scene, p, reflections);
    of_polygon_[p] = place->second;
    normals_[p] = front_normal(scene, p);
  }
}

bool SurfaceOptics::transmits_colour() const {
  return std::any_of(faces_.begin(), faces_.end(), [](const SpecularSurface& face) { return face.transmits_colour(); });
}

const SpecularSurface* SurfaceOptics::at(PolygonIndex polygon) const {
  if (polygon >= of_polygon_.size() || of_polygon_[polygon] == not_specular) return nullptr;
  return &faces_[of_polygon_[polygon]];
}

double SurfaceOptics::transmittance(PolygonIndex polygon, const Vector& direction) const {
  const SpecularSurface* const face = at(polygon);
  return face ? face->transmittance(cosine_between(normals_[polygon], direction)) : 0;
}

double SurfaceOptics::reflectance(PolygonIndex polygon, const Vector& direction) const {
  const SpecularSurface* const face = at(polygon);
  return face ? face->reflectance(side_met(polygon, direction), cosine_between(normals_[polygon], direction)) : 0;
}

// Light meets a front against its normal.
Side SurfaceOptics::side_met(PolygonIndex polygon, const Vector& direction) const {
  return normals_[polygon].dot(direction) < 0 ? Side::front : Side::back;
}

Spectrum SurfaceOptics::spectral_transmittance(PolygonIndex polygon, const Vector& direction) const {
  const SpecularSurface* const face = at(polygon);
  if (!face) return Spectrum::Zero(bands_);
  return face->spectral_transmittance(side_met(polygon, direction), cosine_between(normals_[polygon], direction));
}

Spectrum SurfaceOptics::spectral_reflectance(PolygonIndex polygon, const Vector& direction) const {
  const SpecularSurface* const face = at(polygon);
  if (!face) return Spectrum::Zero(bands_);
  return face->spectral_reflectance(side_met(polygon, direction), cosine_between(normals_[polygon], direction));
}

SpecularShares SurfaceOptics::shares(PolygonIndex polygon, Side side, double cosine) const {
  const SpecularSurface* const face = at(polygon);
  return face ? face->shares(side, cosine) : SpecularShares();
}

std::vector<std::array<double, 2>> SurfaceOptics::kinds(std::size_t polygons) const {
  std::vector<std::array<double, 2>> kinds(polygons, {0, 0});
  for (PolygonIndex p = 0; p < polygons; ++p) {
    if (const SpecularSurface* const face = at(p)) kinds[p] = {face->kind(Side::front), face->kind(Side::back)};
  }
  return kinds;
}

Vector SurfaceOptics::mirrored(PolygonIndex polygon, const Vector& direction) const {
  const Vector& normal = normals_[polygon];
  return direction - 2 * normal.dot(direction) * normal;
}

double SurfaceOptics::nonspecular_fraction(PolygonIndex polygon, Side side) const {
  const SpecularSurface* const face = at(polygon);
  return face ? face->nonspecular_fraction(side) : 1;
}

double SurfaceOptics::nonspecular_profile(PolygonIndex polygon, const Vector& direction) const {
  const SpecularSurface* const face = at(polygon);
  return face ? face->nonspecular_profile(cosine_between(normals_[polygon], direction)) : 1;
}

Vector SurfaceOptics::sample_nonspecular_direction(PolygonIndex polygon, double u, double v) const {
  const SpecularSurface* const face = at(polygon);
  if (!face) return square_to_cosine_hemisphere(u, v);
  const double cosine = face->sample_nonspecular_cosine(u);
  const double sine = std::sqrt(1 - cosine * cosine);
  const double angle = 2 * std::numbers::pi * v;
  return {sine * std::cos(angle), sine * std::sin(angle), cosine};
}

}  // namespace patchlight
