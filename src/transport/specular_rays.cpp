#include "base/sampling.h"
#include "scene/transmittance.h"
#include "transport/row_tracer.h"

#include <algorithm>

namespace patchlight {
namespace {

bool has_left_the_scene(const Way& way) { return way.empty() || way.back().onward != Onward::ends; }

bool is_specular_side(const SpecularFaces& faces, PolygonIndex polygon, Side side) {
  const SpecularFace* const face = faces.at(polygon);
  return face && face->is_specular(side);
}

}  // namespace

// Of a clear patch, what each ray tells goes with what the patch holds at its angle.
bool RowTracer::starts_clear(PatchIndex patch) const {
  const SpecularFace* const face = occluder_.specular_faces().at(mesh_.polygon[patch]);
  return face && face->is_clear();
}

// What a ray over the hemisphere tells at a stop on its way.
SpecularStop RowTracer::stop_at(PatchIndex patch, const Ray& ray, const WayStop& at) const {
  const SpecularFaces& faces = occluder_.specular_faces();
  const Hit& hit = at.hit;
  SpecularStop stop;
  stop.patch = SpecularStop::at_back;
  stop.form_factor = 1 / static_cast<float>(counts_[patch]);
  if (sights_.has_patches(hit)) {
    stop.patch = lookup_.patch_at(hit.polygon, hit.side, hit.point).value();
    if (bright_.density(stop.patch) > 0) stop.form_factor = entry_of(patch, ray, hit, stop.patch);
  }
  if (at.onward == Onward::ends) {
    stop.set(RayStep::ends, hit.side, 0);
    return stop;
  }
  stop.polygon = hit.polygon;
  stop.set(at.onward == Onward::through ? RayStep::through : RayStep::mirrored, hit.side,
           cosine_between(faces.normal(hit.polygon), hit.direction));
  return stop;
}

void RowTracer::add_stops(PatchIndex patch, const Ray& ray, const SeenWay& seen,
                          std::vector<SpecularStop>& stops) const {
  if (starts_clear(patch)) {
    SpecularStop start;
    start.polygon = mesh_.polygon[patch];
    start.set(RayStep::sent, mesh_.side[patch], cosine_between(mesh_.normal[patch], ray.direction));
    stops.push_back(start);
  }
  for (const WayStop& stop : seen.way) stops.push_back(stop_at(patch, ray, stop));
  if (!has_left_the_scene(seen.way)) {
    if (seen.end == Sight::contact) stops.back().patch = SpecularStop::at_back;
    return;
  }
  SpecularStop last;
  last.patch = seen.end == Sight::nothing ? SpecularStop::in_the_open : SpecularStop::at_back;
  last.form_factor = 1 / static_cast<float>(counts_[patch]);
  last.set(RayStep::ends, Side::front, 0);
  stops.push_back(last);
}

PatchRays RowTracer::trace_specular(PatchIndex patch, RowEntries& entries) const {
  const std::vector<Ray> rays = hemisphere_rays(patch);
  const std::vector<SeenWay> seen = sights_.along_ways(patch, rays, hash({seed_, keys_[patch], 2}));
  const bool is_clear = starts_clear(patch);
  PatchRays told;
  std::vector<PlainHit> hits;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::size_t half = k / counts_[patch];
    const Way& way = seen[k].way;
    if (!way.empty() && way.back().hit.distance > 0) told.inverse_lengths += 1 / way.back().hit.distance;
    const bool is_plain = way.size() < 2 && !(way.size() == 1 && way[0].onward != Onward::ends);
    const bool is_unseen = is_plain && (seen[k].end == Sight::back || seen[k].end == Sight::contact);
    if (is_unseen) ++told.unseen;
    if (is_clear || !is_plain) {
      add_stops(patch, rays[k], seen[k], entries.stops[half]);
    } else if (seen[k].end == Sight::nothing) {
      ++told.escaped;
    } else if (!is_unseen) {
      hits.push_back({k, &way[0].hit});
    }
  }
  add_hits(patch, rays, hits, told, entries);
  return told;
}

// A shadow ray that is specular on its way.
std::vector<SpecularStop> RowTracer::crossing_stops(const ShadowPacket& packet, std::size_t lane, PatchIndex patch,
                                                    const RayEntry& entry,
                                                    std::span<const PolygonIndex> crossed) const {
  const SpecularFaces& faces = occluder_.specular_faces();
  const Vector direction = Vector(packet.toward_x[lane], packet.toward_y[lane], packet.toward_z[lane]).normalized();
  std::vector<SpecularStop> stops;
  const auto add = [&](RayStep step, PolygonIndex polygon, Side side) {
    SpecularStop stop;
    stop.polygon = polygon;
    stop.set(step, side, cosine_between(faces.normal(polygon), direction));
    stops.push_back(stop);
  };
  if (starts_clear(patch)) add(RayStep::sent, mesh_.polygon[patch], mesh_.side[patch]);
  for (const PolygonIndex polygon : crossed)
    add(RayStep::crossed, polygon, faces.normal(polygon).dot(direction) < 0 ? Side::front : Side::back);
  const PolygonIndex end = mesh_.polygon[entry.patch];
  const bool is_held = is_specular_side(faces, end, mesh_.side[entry.patch]);
  add(is_held ? RayStep::kept : RayStep::ends, end, mesh_.side[entry.patch]);
  stops.back().patch = entry.patch;
  stops.back().form_factor = entry.form_factor;
  return stops;
}

// Those of a packet that no opaque polygon blocks.
void RowTracer::add_arriving(const ShadowPacket& packet, PatchIndex patch, std::span<const RayEntry> entries,
                             std::size_t half, RowEntries& into) const {
  const SpecularFaces& faces = occluder_.specular_faces();
  const auto crossings = occluder_.crossings(packet);
  for (std::size_t lane = 0; lane < ShadowPacket::size; ++lane) {
    const RayEntry& entry = entries[lane];
    if (!(entry.form_factor > 0) || !crossings[lane]) continue;
    const bool is_plain = crossings[lane]->empty() && !starts_clear(patch) &&
                          !is_specular_side(faces, mesh_.polygon[entry.patch], mesh_.side[entry.patch]);
    if (is_plain) {
      into.halves[half].push_back(entry);
      continue;
    }
    const std::vector<SpecularStop> stops = crossing_stops(packet, lane, patch, entry, *crossings[lane]);
    into.stops[half].insert(into.stops[half].end(), stops.begin(), stops.end());
  }
}

}  // namespace patchlight
