#include "base/conjugate_directions.h"
#include "solve/krylov.h"
#include "solve/scattering.h"

#include <functional>
#include <optional>
#include <utility>

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
