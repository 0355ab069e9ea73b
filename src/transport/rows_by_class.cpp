#include "transport/rows_by_class.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// Numbers for classes, in the order in which they are first met.
class NumberedClasses {
 public:
  std::uint32_t number_of(WayClass way_class) {
    std::sort(way_class.begin(), way_class.end());
    const auto [place, is_new] = numbers_.insert({way_class, static_cast<std::uint32_t>(classes_.size())});
    if (is_new) classes_.push_back(std::move(way_class));
    return place->second;
  }
  std::vector<WayClass> taken() { return std::move(classes_); }

 private:
  std::map<WayClass, std::uint32_t> numbers_;
  std::vector<WayClass> classes_;
};

SpecularMeeting meeting_of(const SpecularStop& stop, const Scene& scene) {
  return {material_on(scene.polygons[stop.polygon], stop.side()), stop.step() == RayStep::mirrored};
}

bool goes_on(RayStep step) { return step == RayStep::through || step == RayStep::mirrored || step == RayStep::crossed; }

std::vector<ClassEntry> entries_by_class(const RayRows& rows, const Scene& scene, const SpecularFaces& faces,
                                         NumberedClasses& numbered) {
  std::vector<ClassEntry> entries;
  for (PatchIndex i = 0; i + 1 < rows.first_stop.size(); ++i) {
    const std::span<const SpecularStop> stops(rows.stops.data() + rows.first_stop[i],
                                              rows.first_stop[i + 1] - rows.first_stop[i]);
    WayClass way;
    tell_form_factors(stops, faces, [&](const SpecularStop& stop, double form_factor) {
      if (stop.patch < SpecularStop::at_back && form_factor > 0)
        entries.push_back({i, stop.patch, numbered.number_of(way), static_cast<float>(form_factor)});
      if (goes_on(stop.step())) way.push_back(meeting_of(stop, scene));
      if (stop.step() == RayStep::ends || stop.step() == RayStep::kept) way.clear();
    });
  }
  return entries;
}

}  // namespace

std::string name_of(const WayClass& way_class, const Scene& scene) {
  std::string name;
  for (const SpecularMeeting& meeting : way_class) {
    if (!name.empty()) name += " + ";
    name += scene.materials[meeting.material].name + (meeting.is_mirrored ? " mirrored" : "");
  }
  return name.empty() ? "straight" : name;
}

RowsByClass rows_by_class(const TracedRows& rows, const Scene& scene, const SpecularFaces& faces) {
  NumberedClasses numbered;
  RowsByClass found;
  for (std::size_t half = 0; half < 2; ++half)
    found.halves[half] = entries_by_class(rows.halves[half], scene, faces, numbered);
  found.classes = numbered.taken();
  return found;
}

}  // namespace patchlight
