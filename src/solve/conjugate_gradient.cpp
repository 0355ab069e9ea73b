#include "base/vectors.h"
#include "solve/krylov.h"
#include "solve/scattering.h"

#include <functional>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

using Apply = std::function<Field(const FieldView&)>;

// A direction that is kept out of the iteration: z with (I - G) z, and the radiosity and irradiance that belong to it.
struct Deflation {
  Field z, image, radiosity, irradiance;
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
        s_(root_.of_irradiance(H_)) {}

  // Deflates the mode of constant irradiance, h = 1: z = R^1/2 A^1/2.
  void deflate();
  void step();
  const Field& radiosity() const { return B_; }
  const Field& irradiance() const { return H_; }

 private:
  void advance(const Field& radiosity, const Field& irradiance, const Field& image, const Eigen::ArrayXd& length);

  Apply apply_;
  SymmetricRoot root_;
  Field B_, H_;
  Field s_;  // residual of w
  Field p_;  // direction
  std::optional<Deflation> deflation_;
};

void ConjugateGradient::advance(const Field& radiosity, const Field& irradiance, const Field& image,
                                const Eigen::ArrayXd& length) {
  B_ += scaled(radiosity, length);
  H_ += scaled(irradiance, length);
  s_ -= scaled(image, length);
}

void ConjugateGradient::deflate() {
  const Field& z = root_.of_even_irradiance();
  const Field y = root_.radiosity_of(z);
  const Field Hy = apply_(y);
  const Field image = z - root_.of_irradiance(Hy);
  deflation_ = {z, image, y, Hy, dot(z, image)};
  advance(y, Hy, image, quotient(dot(z, s_), deflation_->energy));
}

void ConjugateGradient::step() {
  const Eigen::ArrayXd ss = dot(s_, s_);
  if (p_.size() == 0) {
    p_ = s_;
    if (deflation_) p_ -= scaled(deflation_->z, quotient(dot(deflation_->image, s_), deflation_->energy));
  }
  // q = (I - G) p
  const Field y = root_.radiosity_of(p_);
  const Field Hy = apply_(y);
  const Field q = p_ - root_.of_irradiance(Hy);
  advance(y, Hy, q, quotient(ss, dot(p_, q)));
  p_ = s_ + scaled(p_, quotient(dot(s_, s_), ss));
  if (deflation_) p_ -= scaled(deflation_->z, quotient(dot(deflation_->image, s_), deflation_->energy));
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
  constexpr double largest_residual = 0.5;
  const Apply apply = [&transport](const FieldView& B) { return transport.apply(B); };
  ConjugateGradient method(problem, apply, apply(problem.exitance));
  int k = 0;
  for (; k < max_iterations; ++k) {
    const Field r = radiosity_from(problem, method.irradiance()) - method.radiosity();
    if ((highest(r) <= largest_residual).all()) break;
    method.step();
  }
  return {method.radiosity(), k + 1};
}

}  // namespace patchlight
