#include "base/vectors.h"
#include "solve/iterations.h"
#include "solve/scattering.h"

#include <Eigen/QR>
#include <cstddef>
#include <optional>
#include <vector>

namespace patchlight {
namespace {

using Apply = std::function<Field(const FieldView&)>;

// A direction that is kept out of the iteration: z with (I - G) z.
struct Deflation {
  Field z, image;
  Eigen::ArrayXd energy;  // z . (I - G) z
};

// The method on w, with B = E + D w, D = R^1/2 A^-1/2, and what follows from w by linearity: B and H = F B.
class ConjugateGradient {
 public:
  // Starts at w = 0, B = E.
  ConjugateGradient(const RadiosityProblem& problem, Apply apply, Field direct_irradiance)
      : apply_(std::move(apply)),
        root_(problem.scattering, problem.area),
        B_(problem.exitance),
        H_(std::move(direct_irradiance)),
        directions_(root_.of_irradiance(H_)) {}

  // Deflates the mode of constant irradiance, h = 1: z = R^1/2 A^1/2.
  void deflate();
  void step();
  const Field& radiosity() const { return B_; }
  const Field& irradiance() const { return H_; }

 private:
  void advance(const Field& radiosity, const Field& irradiance, const Eigen::ArrayXd& length);
  void keep_deflated();

  Apply apply_;
  SymmetricRoot root_;
  Field B_, H_;
  ConjugateDirections<Field> directions_;  // of w
  std::optional<Deflation> deflation_;
};

void ConjugateGradient::advance(const Field& radiosity, const Field& irradiance, const Eigen::ArrayXd& length) {
  B_ += scaled(radiosity, length);
  H_ += scaled(irradiance, length);
}

// No direction has a part along z in the product of I - G.
void ConjugateGradient::keep_deflated() {
  directions_.take_out(deflation_->z, quotient(dot(deflation_->image, directions_.residual()), deflation_->energy));
}

void ConjugateGradient::deflate() {
  const Field& z = root_.of_even_irradiance();
  const Field y = root_.radiosity_of(z);
  const Field Hy = apply_(y);
  const Field image = z - root_.of_irradiance(Hy);
  deflation_ = {z, image, dot(z, image)};
  const Field& s = directions_.residual();
  const Eigen::ArrayXd length = quotient(dot(z, s), deflation_->energy);
  advance(y, Hy, length);
  directions_ = ConjugateDirections<Field>(s - scaled(image, length));
  keep_deflated();
}

void ConjugateGradient::step() {
  // q = (I - G) p
  const Field y = root_.radiosity_of(directions_.direction());
  const Field Hy = apply_(y);
  const Field q = directions_.direction() - root_.of_irradiance(Hy);
  const Eigen::ArrayXd length = directions_.length(q);
  advance(y, Hy, length);
  directions_.advance(q, length);
  if (deflation_) keep_deflated();
}

Solution solved(Iterations iterations, bool deflated) {
  const RadiosityProblem& problem = iterations.problem();
  const Apply apply = [&iterations](const FieldView& B) { return iterations.apply(B); };
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  ConjugateGradient method(problem, apply, iterations.direct_irradiance());
  if (deflated) method.deflate();
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    method.step();
    iterations.record(iterate_of(problem, method.radiosity(), method.irradiance()), k, Residual::recurred);
  }
  return iterations.finish();
}

}  // namespace

Solution cg(Iterations iterations) { return solved(std::move(iterations), false); }

Solution deflated_cg(Iterations iterations) { return solved(std::move(iterations), true); }

GlowingRadiosity glowing_radiosity(const TransportOperator& transport, const RadiosityProblem& problem,
                                   int max_iterations) {
  const Apply apply = [&transport](const FieldView& B) { return transport.apply(B); };
  ConjugateGradient method(problem, apply, apply(problem.exitance));
  int k = 0;
  for (; k < max_iterations; ++k) {
    const Field r = radiosity_from(problem, method.irradiance()) - method.radiosity();
    if ((highest(r) <= 0.5).all()) break;
    method.step();
  }
  return {method.radiosity(), k + 1};
}

// On (I - K) B = E with the inner product sum_i A_i x_i y_i; names as in van der Vorst 1992.
Solution bicgstab(Iterations iterations) {
  const RadiosityProblem& problem = iterations.problem();
  const auto dot = [&](const Field& x, const Field& y) { return inner_product(x, y, problem.area); };
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  Field B = problem.exitance;
  Field H = iterations.direct_irradiance();
  Field r = problem.scattering.reflect(H);
  const Field shadow = r;
  Field p = r;
  Eigen::ArrayXd rho = dot(shadow, r);
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    // v = (I - K) p, s = r - alpha v
    const Field Hp = iterations.apply(p);
    const Field v = p - problem.scattering.reflect(Hp);
    const Eigen::ArrayXd alpha = quotient(rho, dot(shadow, v));
    const Field s = r - scaled(v, alpha);
    // t = (I - K) s, r = s - omega t
    const Field Hs = iterations.apply(s);
    const Field t = s - problem.scattering.reflect(Hs);
    const Eigen::ArrayXd omega = quotient(dot(t, s), dot(t, t));
    B += scaled(p, alpha) + scaled(s, omega);
    H += scaled(Hp, alpha) + scaled(Hs, omega);
    r = s - scaled(t, omega);
    const Eigen::ArrayXd rho_next = dot(shadow, r);
    const Eigen::ArrayXd beta = quotient(rho_next, rho) * quotient(alpha, omega);
    p = r + scaled(p - scaled(v, omega), beta);
    rho = rho_next;
    iterations.record(iterate_of(problem, B, H), k, Residual::recurred);
  }
  return iterations.finish();
}

namespace {

// One restart: directions v_1 ... v_m, orthonormal in sum_i A_i x_i y_i, their irradiance, and the Hessenberg matrices
// of I - K in this basis, one per band.
struct Arnoldi {
  std::vector<Field> v;           // radiosities
  std::vector<Field> irradiance;  // F v
  std::vector<Eigen::MatrixXd> hessenberg;
  Eigen::ArrayXd beta;  // ||r||_A at the start
};

Arnoldi begun(const RadiosityProblem& problem, const Field& residual, int restart) {
  Arnoldi arnoldi;
  arnoldi.beta = area_norm(residual, problem.area);
  const Eigen::ArrayXd ones = Eigen::ArrayXd::Ones(arnoldi.beta.size());
  arnoldi.v.push_back(scaled(residual, quotient(ones, arnoldi.beta)));
  arnoldi.hessenberg.assign(static_cast<std::size_t>(residual.cols()), Eigen::MatrixXd::Zero(restart + 1, restart));
  return arnoldi;
}

// The next direction: K v_k, orthogonalized, as the rest of (I - K) v_k lies along v_k. If nearly all of it lies along
// the previous directions, it is orthogonalized once more to remove rounding. Twice is enough (Daniel, Gragg, Kaufman
// and Stewart 1976).
Arnoldi extended(Arnoldi arnoldi, const RadiosityProblem& problem, Field irradiance) {
  const auto k = static_cast<Eigen::Index>(arnoldi.irradiance.size());
  Field next = problem.scattering.reflect(irradiance);
  arnoldi.irradiance.push_back(std::move(irradiance));
  Eigen::ArrayXd before = area_norm(next, problem.area);
  Eigen::ArrayXd norm;
  Eigen::ArrayXXd along_all = Eigen::ArrayXXd::Zero(k + 1, next.cols());
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::ArrayXXd along = inner_products(next, arnoldi.v, problem.area);
    next = plus_combination(std::move(next), arnoldi.v, -along);
    along_all += along;
    norm = area_norm(next, problem.area);
    if ((norm >= 0.1 * before).all()) break;  // one digit of orthogonality is lost at most
    before = norm;
  }
  for (Eigen::Index band = 0; band < norm.size(); ++band) {
    Eigen::MatrixXd& hessenberg = arnoldi.hessenberg[static_cast<std::size_t>(band)];
    hessenberg.col(k).head(k + 1) = -along_all.col(band).matrix();
    hessenberg(k, k) += 1;
    hessenberg(k + 1, k) = -norm[band];
  }
  arnoldi.v.push_back(scaled(next, quotient(Eigen::ArrayXd::Ones(norm.size()), norm)));
  return arnoldi;
}

// The combination of the first k directions that has the least residual.
struct Least {
  Eigen::ArrayXXd lengths;       // k per band
  Eigen::ArrayXd residual_norm;  // ||r||_A per band
};

Least least_residual(const Arnoldi& arnoldi, Eigen::Index k) {
  Least least{Eigen::ArrayXXd(k, arnoldi.beta.size()), Eigen::ArrayXd(arnoldi.beta.size())};
  for (Eigen::Index band = 0; band < least.lengths.cols(); ++band) {
    const Eigen::MatrixXd hessenberg = arnoldi.hessenberg[static_cast<std::size_t>(band)].topLeftCorner(k + 1, k);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(k + 1);
    right[0] = arnoldi.beta[band];
    // Ranks are revealed: a band that is solved already has directions 0.
    const Eigen::VectorXd lengths = hessenberg.colPivHouseholderQr().solve(right);
    least.lengths.col(band) = lengths.array();
    least.residual_norm[band] = (right - hessenberg * lengths).norm();
  }
  return least;
}

// That combination, added to the start.
Iterate best(const Arnoldi& arnoldi, const RadiosityProblem& problem, const Iterate& start,
             const Eigen::ArrayXXd& lengths) {
  const auto k = static_cast<std::size_t>(lengths.rows());
  return iterate_of(problem, plus_combination(start.radiosity, std::span(arnoldi.v).first(k), lengths),
                    plus_combination(start.irradiance, std::span(arnoldi.irradiance).first(k), lengths));
}

}  // namespace

Solution gmres(Iterations iterations) {
  const RadiosityProblem& problem = iterations.problem();
  const int restart = iterations.options().restart;
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  Iterate start = iterate_of(problem, problem.exitance, iterations.direct_irradiance());
  Arnoldi arnoldi = begun(problem, start.residual, restart);
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    Field irradiance = iterations.apply(arnoldi.v.back());
    arnoldi = extended(std::move(arnoldi), problem, std::move(irradiance));
    const Least least = least_residual(arnoldi, static_cast<Eigen::Index>(arnoldi.irradiance.size()));
    if (k % restart != 0) {
      iterations.record(
          least.residual_norm,
          [&arnoldi, &problem, &start, lengths = least.lengths] { return best(arnoldi, problem, start, lengths); }, k);
      continue;
    }
    // The recorded iterate refers to the directions and the start until a newer iterate replaces it.
    Iterate next = best(arnoldi, problem, start, least.lengths);
    iterations.record(next, k, Residual::recurred);
    if (iterations.ended()) break;
    start = std::move(next);
    arnoldi = begun(problem, start.residual, restart);
  }
  return iterations.finish();
}

}  // namespace patchlight
