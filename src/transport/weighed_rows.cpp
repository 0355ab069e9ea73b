#include "transport/weighed_rows.h"

#include "base/parallel.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace patchlight {
namespace {

// What rays that are specular on their way tell of one row for one colour.
struct WeighedRow {
  std::vector<RayEntry> entries;
  double open = 0;      // form factors to the open
  double at_backs = 0;  // and to sides without patches
};

WeighedRow weighed_row(const RayRows& rows, std::size_t i, const SpecularFaces& faces) {
  WeighedRow row;
  const std::span<const SpecularStop> stops(rows.stops.data() + rows.first_stop[i],
                                            rows.first_stop[i + 1] - rows.first_stop[i]);
  tell_form_factors(stops, faces, [&row](const SpecularStop& stop, double form_factor) {
    if (stop.patch == SpecularStop::in_the_open) {
      row.open += form_factor;
    } else if (stop.patch == SpecularStop::at_back) {
      row.at_backs += form_factor;
    } else if (form_factor > 0) {
      row.entries.push_back({stop.patch, static_cast<float>(form_factor)});
    }
  });
  return row;
}

std::vector<WeighedRow> weighed_half(const RayRows& rows, const SpecularFaces& faces) {
  std::vector<WeighedRow> weighed(rows.hit_weight.size());
  parallel_for(weighed.size(), [&](std::size_t i) { weighed[i] = weighed_row(rows, i, faces); });
  return weighed;
}

// The entries of plain rays, and after them those of the others, row by row; the stops are let go.
RayRows with_entries(RayRows rows, const std::vector<WeighedRow>& weighed) {
  LargeArray<RayEntry> all;
  std::size_t count = rows.entries.size();
  for (const WeighedRow& row : weighed) count += row.entries.size();
  all.reserve(count);
  std::vector<std::uint64_t> first{0};
  for (std::size_t i = 0; i < weighed.size(); ++i) {
    const auto begin = rows.entries.begin();
    all.insert(all.end(), begin + static_cast<std::ptrdiff_t>(rows.first_entry[i]),
               begin + static_cast<std::ptrdiff_t>(rows.first_entry[i + 1]));
    all.insert(all.end(), weighed[i].entries.begin(), weighed[i].entries.end());
    first.push_back(all.size());
  }
  rows.entries = std::move(all);
  rows.first_entry = std::move(first);
  rows.first_stop = {};
  rows.stops = {};
  return rows;
}

// The shares of both halves, of what is exposed. From what is covered rays see nothing but sides without patches; of a
// clear patch all rays are told by stops, these too.
void add_lost(LostShare& lost, Eigen::Index i, const std::array<std::vector<WeighedRow>, 2>& halves, bool is_clear) {
  const double exposed = 1 - lost.covered[i];
  if (!(exposed > 0)) return;
  const auto row = static_cast<std::size_t>(i);
  const double open = 0.5 * (halves[0][row].open + halves[1][row].open);
  const double at_backs = 0.5 * (halves[0][row].at_backs + halves[1][row].at_backs);
  const double in_cover = is_clear ? lost.covered[i] : 0;
  lost.escaped[i] = std::min(1.0, lost.escaped[i] + open / exposed);
  lost.at_backs[i] = std::min(1 - lost.escaped[i], lost.at_backs[i] + std::max(0.0, at_backs - in_cover) / exposed);
}

}  // namespace

// Each row as a whole times what makes its sum that of `wanted`. Where there are hits their weight, in double
// precision, takes what entries lose by rounding.
void scale(RayRows& rows, const Eigen::VectorXd& wanted) {
  parallel_for(rows.hit_weight.size(), [&](std::size_t i) {
    const auto hits = static_cast<double>(rows.first_hit[i + 1] - rows.first_hit[i]);
    double sum = 0;
    for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k)
      sum += static_cast<double>(rows.entries[k].form_factor);
    const double all = sum + hits * rows.hit_weight[i];
    if (!(all > 0)) return;
    const double factor = wanted[static_cast<Eigen::Index>(i)] / all;
    double stored = 0;
    for (std::uint64_t k = rows.first_entry[i]; k < rows.first_entry[i + 1]; ++k) {
      float& entry = rows.entries[k].form_factor;
      entry = static_cast<float>(factor * static_cast<double>(entry));
      stored += static_cast<double>(entry);
    }
    rows.hit_weight[i] = hits > 0 ? (wanted[static_cast<Eigen::Index>(i)] - stored) / hits : 0;
  });
}

TracedRows weighed_rows(TracedRows rows, const PatchMesh& mesh, const Occluder& occluder) {
  if (rows.halves[0].first_stop.empty()) return rows;
  const SpecularFaces& faces = occluder.specular_faces();
  std::array<std::vector<WeighedRow>, 2> weighed;
  for (std::size_t half = 0; half < 2; ++half) {
    weighed[half] = weighed_half(rows.halves[half], faces);
    rows.halves[half] = with_entries(std::move(rows.halves[half]), weighed[half]);
  }
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const SpecularFace* const face = faces.at(mesh.polygon[i]);
    add_lost(rows.lost, i, weighed, face && face->is_clear());
  }
  rows.lost.clear = clear_shares(mesh, occluder);
  rows.area = exposed_area(mesh, rows.lost, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.size())));
  const Eigen::VectorXd wanted = expected_row_sum(rows.lost);
  for (RayRows& half : rows.halves) scale(half, wanted);
  return rows;
}

}  // namespace patchlight
