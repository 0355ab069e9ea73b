#include "validate/validate.h"

#include <cmath>
#include <numbers>

namespace patchlight::validation {
namespace {

using std::atan;
using std::log;
using std::sqrt;
using std::numbers::pi;

double squared(double x) { return x * x; }

// Integral of ln sqrt(D^2 + (s - t)^2) over s and t from 0 to l.
double parallel_edges(double D, double l) {
  const double sum = D * D + l * l;
  const double D_part = D > 0 ? 2 * D * l * atan(l / D) + D * D * log(D) : 0;
  return l * l * log(sum) - 1.5 * l * l + D_part - sum * log(sum) / 2;
}

// Integral of ln sqrt(q + (t - foot)^2) over t from 0 to h.
double edge_seen(double q, double foot, double h) {
  const double root = sqrt(q);
  const auto antiderivative = [&](double t) {
    const double r2 = q + t * t;
    return (r2 > 0 ? t * log(r2) / 2 : 0) - t + (root > 0 ? root * atan(t / root) : 0);
  };
  return antiderivative(h - foot) - antiderivative(-foot);
}

// Integral of 1 / (D^2 + s^2 + t^2 - 2 s t cos) over s from 0 to w and t from 0 to h: elementary in t; Simpson's rule
// in s, whose error with steps of w / 2000 is below 1e-13 for sizes of about D.
double inverse_square(double D, double w, double h, double angle) {
  const auto integrand = [&](double s) {
    const double rho = sqrt(D * D + squared(s * std::sin(angle)));
    const double foot = s * std::cos(angle);
    return (atan((h - foot) / rho) + atan(foot / rho)) / rho;
  };
  constexpr int steps = 2000;
  double sum = integrand(0) + integrand(w);
  for (int k = 1; k < steps; ++k) sum += (k % 2 == 1 ? 4 : 2) * integrand(w * k / steps);
  return sum * w / (3 * steps);
}

// Integral of f = ln sqrt(D^2 + s^2 + t^2 - 2 s t cos) over s from 0 to w and t from 0 to h. The divergence of (s, t) f
// is 2 f + 1 - D^2 / (D^2 + s^2 + t^2 - 2 s t cos), so all but the last term is an integral along two sides.
double inclined_edges(double D, double w, double h, double angle) {
  const double sine2 = squared(std::sin(angle));
  const double cosine = std::cos(angle);
  const double sides =
      w * edge_seen(D * D + w * w * sine2, w * cosine, h) + h * edge_seen(D * D + h * h * sine2, h * cosine, w);
  return (sides - w * h + (D > 0 ? D * D * inverse_square(D, w, h, angle) : 0)) / 2;
}

}  // namespace

double opposed_rectangles(double a, double b, double c) {
  const double X = a / c;
  const double Y = b / c;
  const double X1 = sqrt(1 + X * X);
  const double Y1 = sqrt(1 + Y * Y);
  return 2 / (pi * X * Y) *
         (log(X1 * Y1 / sqrt(1 + X * X + Y * Y)) + X * Y1 * atan(X / Y1) + Y * X1 * atan(Y / X1) - X * atan(X) -
          Y * atan(Y));
}

double perpendicular_rectangles(double w, double h, double l) {
  const double W2 = squared(w / l);
  const double H2 = squared(h / l);
  const double W = w / l;
  const double H = h / l;
  const double sum = W2 + H2;
  const double logarithms = log((1 + W2) * (1 + H2) / (1 + sum)) + W2 * log(W2 * (1 + sum) / ((1 + W2) * sum)) +
                            H2 * log(H2 * (1 + sum) / ((1 + H2) * sum));
  return (W * atan(1 / W) + H * atan(1 / H) - sqrt(sum) * atan(1 / sqrt(sum)) + logarithms / 4) / (pi * W);
}

// The double contour integral of docs/theory/unoccluded-form-factors.md. Among the edges parallel to the shared one,
// all four pairs count. Among the others, those at the same end and those at opposite ends count.
double angled_rectangles(double w, double h, double l, double angle) {
  // The square of the distance between the far edges, written so that small angles keep their digits.
  const double across = sqrt(squared(w - h) + 4 * w * h * squared(std::sin(angle / 2)));
  const double parallel =
      parallel_edges(w, l) + parallel_edges(h, l) - parallel_edges(0, l) - parallel_edges(across, l);
  const double inclined = inclined_edges(l, w, h, angle) - inclined_edges(0, w, h, angle);
  return (parallel + 2 * std::cos(angle) * inclined) / (2 * pi * w * l);
}

double coaxial_discs(double r1, double r2, double h) {
  const double R1 = squared(r1 / h);
  const double X = 1 + (1 + squared(r2 / h)) / R1;
  return (X - sqrt(X * X - 4 * squared(r2 / r1))) / 2;
}

double coaxial_cylinders(double r1, double r2, double h) {
  const double X = r2 / r1;
  const double Y = h / r1;
  const double A = Y * Y + X * X - 1;
  const double B = Y * Y - X * X + 1;
  const double ends = sqrt(squared(A + 2) - 4 * X * X) * std::acos(B / (X * A)) + B * std::asin(1 / X) - pi * A / 2;
  return (1 - (std::acos(B / A) - ends / (2 * Y)) / pi) / X;
}

double element_to_parallel_rectangle(double a, double b, double c) {
  const double X = a / c;
  const double Y = b / c;
  const double X1 = sqrt(1 + X * X);
  const double Y1 = sqrt(1 + Y * Y);
  return (X / X1 * atan(Y / X1) + Y / Y1 * atan(X / Y1)) / (2 * pi);
}

double element_to_perpendicular_rectangle(double a, double b, double c) {
  const double far = sqrt(a * a + c * c);
  return (atan(b / c) - c / far * atan(b / far)) / (2 * pi);
}

}  // namespace patchlight::validation
