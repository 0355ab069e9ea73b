#include "archive/row_sums.h"

#include "patchlight/base/error.h"

#include "archive/file_names.h"
#include "transport/closure.h"

#include <algorithm>
#include <sstream>

namespace patchlight {
namespace {

struct Range {
  double low = 0;
  double high = 0;
};

// Entries were rounded to float, 6e-8 each, and narrowed as much.
constexpr double rounding = 1e-5;

// The largest sums that sampled form factors can have. An exchange area is below the mean of both patches' areas, as it
// is the share of rays from either that arrive, or a form factor below 1 from the smaller one. Sampled by area it has
// no bound: points at the distance r weigh up to 1 / (2 pi r^2). On patches of size h that share an edge the chance of
// a weight above K / h^2 is below K^-1.5 / 15, so that of N patches with n samples of each pair none has a row above L
// but by a chance of N n^-0.5 L^-1.5: 1e-6 for N = 1e5, n = 4 and L = 1e7.
Eigen::ArrayXd most_row_sums(const FormFactorInfo& info, const PatchMesh& mesh, const Eigen::VectorXd& exposed) {
  constexpr double by_area = 1e7;
  const Eigen::Map<const Eigen::ArrayXd> area(mesh.area.data(), exposed.size());
  const Eigen::ArrayXd bounded = (static_cast<double>(area.size()) * area + area.sum()) / 2 / exposed.array();
  return (1 + rounding) * bounded + (info.estimator == Estimator::area ? by_area : 0);
}

void require_raw_row_sums(const std::filesystem::path& file, const Eigen::VectorXd& sums, const Eigen::ArrayXd& most) {
  for (Eigen::Index i = 0; i < sums.size(); ++i) {
    if (sums[i] >= 0 && sums[i] <= most[i]) continue;
    std::ostringstream text;
    text << "found form factors that sum to " << sums[i] << " in row " << i + 1 << " before closure; expected 0 to "
         << most[i] << "\nhint: compute the form factors again";
    throw InputError(file.string(), text.str());
  }
}

// Each entry was scaled by the smaller factor of its two rows: a row keeps at least the smallest factor of all, also
// one that was not cut itself, and a cut row sum is still above 1.
Range range_of_cut_row(double raw, double largest) {
  return {raw / std::max(1.0, largest) * (1 - rounding), raw * (1 + rounding)};
}

// Where sum_j F_ij of a row must lie. As computed it is the stored sum, but for rounding. Closure makes it 1 in a
// closed scene; in an open one it moves it towards the measured share, by a sum that is weighed against the entries'
// errors.
Range row_sum_range(const FormFactorInfo& info, const Exchange& exchange, Eigen::Index i, double largest) {
  constexpr double most_overshoot = 0.2;
  const double raw = exchange.raw_row_sum[i];
  if (!is_closed(info)) return {raw - rounding * (1 + raw), raw + rounding * (1 + raw)};
  if (info.closure.starts_with(cut_row_sums)) return range_of_cut_row(raw, largest);
  if (exchange.lost.closed()) return {raw > 0 ? 1 - rounding : 0, 1 + rounding};
  const double seen = 1 - exchange.lost.escaped[i] - exchange.lost.at_backs[i];
  return {std::min(raw, seen) - most_overshoot, std::max(raw, seen) + most_overshoot};
}

}  // namespace

void require_row_sums(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh,
                      const Exchange& exchange) {
  require_raw_row_sums(folder / file_name::raw_row_sum, exchange.raw_row_sum, most_row_sums(info, mesh, exchange.area));
  const Eigen::VectorXd sums = row_sums(exchange.exchange_areas).cwiseQuotient(exchange.area);
  const double largest = sums.size() > 0 ? exchange.raw_row_sum.maxCoeff() : 0;
  for (Eigen::Index i = 0; i < sums.size(); ++i) {
    const Range range = row_sum_range(info, exchange, i, largest);
    if (sums[i] >= range.low && sums[i] <= range.high) continue;
    std::ostringstream text;
    text << "found form factors that sum to " << sums[i] << " in row " << i + 1 << "; expected " << range.low << " to "
         << range.high << "\nhint: compute the form factors again";
    throw InputError((folder / file_name::dense).string(), text.str());
  }
}

}  // namespace patchlight
