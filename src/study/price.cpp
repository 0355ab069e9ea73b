#include "base/words.h"
#include "study/study.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patchlight {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// A bar assumes this order where errors fall more slowly, or do not fall.
constexpr double least_order = 0.5;

// So many times fewer patches have edges of four times the length: the error of the reference, which is left out of
// the ratio of errors, is small beside them.
constexpr double far_coarser = 16;

// (x1^p - 1) / (x2^p - 1), which grows with p; ln x1 / ln x2 at p = 0.
double ratio_of_errors(double p, double ln_x1, double ln_x2) {
  return std::abs(p) < 1e-9 ? ln_x1 / ln_x2 : std::expm1(p * ln_x1) / std::expm1(p * ln_x2);
}

// ln(e1 / e2) / ln(x1 / x2)
double slope(double e1, double e2, double ratio) {
  return e1 > 0 && e2 > 0 && ratio != 1 ? std::log(e1 / e2) / std::log(ratio) : unknown;
}

double order_between(Swept swept, const StudySetting& before, const StudySetting& after, double reference_patches) {
  switch (swept) {
    case Swept::patch_size:
      return order_in_edge(before, after, reference_patches);
    case Swept::samples:
      return slope(before.own_error, after.own_error, static_cast<double>(after.samples) / before.samples);
    case Swept::tolerance:
      return slope(before.own_error, after.own_error, before.tolerance / after.tolerance);
  }
  return unknown;
}

// The competing settings on the front of CPU time, cheapest first: their errors fall.
std::vector<StudySetting> time_front(const Study& study) {
  std::vector<StudySetting> front;
  for (const StudySweep& sweep : study.sweeps) {
    for (const StudySetting& setting : sweep.settings) {
      if (sweep.competes && setting.on_time_front) front.push_back(setting);
    }
  }
  const auto cheaper = [](const auto& a, const auto& b) { return cpu_seconds_of(a) < cpu_seconds_of(b); };
  std::stable_sort(front.begin(), front.end(), cheaper);
  return front;
}

// Two sizes before the finest one, where there are so many: over a wider range it weighs less where patches happen to
// meet the edges of shadows.
const StudySetting& coarser_of(const StudySweep& sweep) {
  return sweep.settings[sweep.settings.size() - std::min<std::size_t>(3, sweep.settings.size())];
}

// Where errors are differences of two meshes: e = C (h^p - h_ref^p), solved for p.
double order_beside_reference(const StudySetting& coarse, const StudySetting& fine, double reference_patches) {
  const double ratio = coarse.error / fine.error;
  const double ln_x1 = 0.5 * std::log(reference_patches / coarse.patches);
  const double ln_x2 = 0.5 * std::log(reference_patches / fine.patches);
  if (!(ratio > 1) || !std::isfinite(ratio) || !(ln_x2 > 0) || !(ln_x1 > ln_x2)) return unknown;
  double low = -10;
  double high = 10;
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (ratio_of_errors(middle, ln_x1, ln_x2) < ratio ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// The order from the coarsest and the finest of the last three settings that are far coarser than the reference. With
// fewer than two, from the last three of all, with the error of the reference in the model.
double observed_order(const StudySweep& by_size, double reference_patches) {
  std::vector<StudySetting> far;
  for (const StudySetting& setting : by_size.settings) {
    if (reference_patches >= far_coarser * setting.patches) far.push_back(setting);
  }
  if (far.size() >= 2) {
    const double order =
        order_in_edge(far[far.size() - std::min<std::size_t>(3, far.size())], far.back(), reference_patches);
    if (!std::isnan(order)) return order;
  }
  if (std::isinf(reference_patches)) return unknown;
  return order_beside_reference(coarser_of(by_size), by_size.settings.back(), reference_patches);
}

// Beyond the finest mesh: error = e (N / n)^(p/2), seconds = t (n / N)^q, q from 1 to 2.
Price extrapolated(double error, const StudySweep& by_size, const StudyReference& reference) {
  Price price{error};
  const StudySetting& fine = by_size.settings.back();
  const StudySetting& coarse = coarser_of(by_size);
  price.order = std::min(2.0, observed_order(by_size, patches_of(reference)));
  if (!(price.order > 0)) return price;
  const double more = std::pow((fine.error + reference.bar) / error, 2 / price.order);
  if (!(more <= 16)) return price;
  const double growth = slope(cpu_seconds_of(fine), cpu_seconds_of(coarse),
                              static_cast<double>(fine.patches) / static_cast<double>(coarse.patches));
  price.finding = Finding::extrapolated;
  price.cpu_seconds = cpu_seconds_of(fine) * std::pow(more, std::isnan(growth) ? 2 : std::clamp(growth, 1.0, 2.0));
  return price;
}

// The price by the sweep of patch sizes that makes it cheapest.
Price extrapolated(double error, const Study& study) {
  Price cheapest{error};
  for (const StudySweep& sweep : study.sweeps) {
    if (!sweep.competes || sweep.swept != Swept::patch_size || sweep.settings.size() < 2) continue;
    const Price price = extrapolated(error, sweep, study.reference);
    if (price.finding == Finding::not_reached) continue;
    const bool first = cheapest.finding == Finding::not_reached;
    if (first || price.cpu_seconds < cheapest.cpu_seconds) cheapest = price;
  }
  return cheapest;
}

// With so many digits, and never fewer than stand before the point.
std::string without_exponent(double value, int digits) {
  const int before_point = value >= 1 ? static_cast<int>(std::log10(value)) + 1 : 1;
  return rounded(value, std::max(digits, before_point));
}

std::string in_percent(double share, int digits) { return without_exponent(100 * share, digits) + " %"; }

std::string text_of(const Price& price, PatchIndex patches) {
  const std::string error = in_percent(price.error, 2);
  const std::string seconds = without_exponent(price.cpu_seconds, 2);
  switch (price.finding) {
    case Finding::interpolated:
      return error + " costs " + seconds + " s of CPU time here";
    case Finding::at_most:
      return error + " costs at most " + seconds + " s of CPU time here";
    case Finding::extrapolated:
      return error + " costs about " + seconds + " s of CPU time (by the observed order " + rounded(price.order, 2) +
             ")";
    case Finding::not_reached:
      return error + " is not reached within " + std::to_string(patches) + " patches";
    case Finding::not_known:
      return "the cost of " + error + " is not known, as the error of the reference is no smaller";
  }
  return {};
}

std::string limit_of(const ErrorParts& parts, double bar) {
  const double largest = std::max({parts.mesh, parts.form_factors, parts.solver});
  if (!(largest > 1e-6)) return "nothing limits you";
  const std::string size = " (" + in_percent(largest, 2) + " of the light at the finest setting)";
  if (largest == parts.solver) return "the largest error comes from the solver's tolerance" + size;
  if (largest == parts.form_factors) return "the largest error comes from the sampling of the form factors" + size;
  const std::string known = parts.mesh > bar ? "" : ", by a reference that is itself good to " + in_percent(bar, 2);
  return "the largest error comes from the size of the patches" + size + known + ", most of all on `" +
         parts.worst_place + "`, " + in_percent(parts.worst_share, 2) + " of the squared error";
}

}  // namespace

double order_in_edge(const StudySetting& coarse, const StudySetting& fine, double reference_patches) {
  const bool falls = std::isinf(reference_patches) || coarse.error > fine.error;
  if (!falls || !(reference_patches >= far_coarser * fine.patches)) return unknown;
  return 2 * slope(coarse.error, fine.error, static_cast<double>(fine.patches) / coarse.patches);
}

double patches_of(const StudyReference& reference) {
  return reference.closed_form ? std::numeric_limits<double>::infinity()
                               : static_cast<double>(reference.uniform_patches);
}

StudySweep with_orders(StudySweep sweep, double reference_patches) {
  for (std::size_t k = 1; k < sweep.settings.size(); ++k) {
    sweep.settings[k].order = order_between(sweep.swept, sweep.settings[k - 1], sweep.settings[k], reference_patches);
  }
  return sweep;
}

double richardson_bar(const StudySweep& by_size, double reference_patches) {
  const StudySetting& fine = by_size.settings.back();
  const double observed = observed_order(by_size, reference_patches);
  const double order = std::isnan(observed) ? least_order : std::clamp(observed, least_order, 2.0);
  // e = C (h^p - h_ref^p), and C h_ref^p is what the reference is off.
  return fine.error / std::expm1(0.5 * order * std::log(reference_patches / fine.patches));
}

std::vector<bool> pareto_front(const std::vector<std::array<double, 2>>& points) {
  std::vector<bool> on_front;
  for (const auto& a : points) {
    on_front.push_back(std::none_of(points.begin(), points.end(), [&](const auto& b) {
      return b[0] <= a[0] && b[1] <= a[1] && (b[0] < a[0] || b[1] < a[1]);
    }));
  }
  return on_front;
}

Study with_fronts(Study study) {
  std::vector<StudySetting*> competing;
  for (StudySweep& sweep : study.sweeps) {
    if (!sweep.competes) continue;
    for (StudySetting& setting : sweep.settings) competing.push_back(&setting);
  }
  std::vector<std::array<double, 2>> by_time, by_memory;
  for (const StudySetting* setting : competing) {
    by_time.push_back({cpu_seconds_of(*setting), setting->error});
    by_memory.push_back({setting->matrix_bytes, setting->error});
  }
  const std::vector<bool> time = pareto_front(by_time);
  const std::vector<bool> memory = pareto_front(by_memory);
  for (std::size_t k = 0; k < competing.size(); ++k) {
    competing[k]->on_time_front = time[k];
    competing[k]->on_memory_front = memory[k];
  }
  return study;
}

Price price_of(double error, const Study& study) {
  const double bar = study.reference.bar;
  if (bar >= error) return {error, Finding::not_known};
  const std::vector<StudySetting> front = time_front(study);
  const auto good = std::find_if(front.begin(), front.end(),
                                 [&](const StudySetting& setting) { return setting.error + bar <= error; });
  if (good == front.end()) return extrapolated(error, study);
  if (good == front.begin()) return {error, Finding::at_most, cpu_seconds_of(*good)};
  const double e1 = (good - 1)->error + bar;
  const double e2 = good->error + bar;
  const double t1 = cpu_seconds_of(*(good - 1));
  const double t2 = cpu_seconds_of(*good);
  if (!(e2 > 0) || !(t1 > 0)) return {error, Finding::at_most, t2};
  return {error, Finding::interpolated, t1 * std::pow(t2 / t1, std::log(e1 / error) / std::log(e1 / e2))};
}

std::string conclusion(const Study& study) {
  const PatchIndex patches =
      study.sweeps.empty() || study.sweeps.front().settings.empty() ? 0 : study.sweeps.front().settings.back().patches;
  return text_of(price_of(0.01, study), patches) + ", " + text_of(price_of(0.003, study), patches) + "; " +
         limit_of(study.parts, study.reference.bar) + ".";
}

}  // namespace patchlight
