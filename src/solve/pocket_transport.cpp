#include "solve/pocket_transport.h"

#include "base/parallel.h"

#include <Eigen/IterativeLinearSolvers>
#include <cassert>
#include <cstddef>

namespace patchlight {
namespace {

using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// Of what is followed within pockets, ||r|| / ||H||: below what a solution asks for.
constexpr double inner_tolerance = 1e-8;
constexpr int most_iterations = 1000;

// Eigen's preconditioner that somebody else has made.
class Shared {
 public:
  Shared() = default;
  template <typename Matrix>
  explicit Shared(const Matrix& /*matrix*/) {}
  template <typename Matrix>
  Shared& analyzePattern(const Matrix& /*matrix*/) {
    return *this;
  }
  template <typename Matrix>
  Shared& factorize(const Matrix& /*matrix*/) {
    return *this;
  }
  template <typename Matrix>
  Shared& compute(const Matrix& /*matrix*/) {
    return *this;
  }
  void set(const Eigen::IncompleteLUT<double>& made) { made_ = &made; }
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const { return made_->solve(right); }
  Eigen::ComputationInfo info() const { return Eigen::Success; }

 private:
  const Eigen::IncompleteLUT<double>* made_ = nullptr;
};

Field rows_of(const FieldView& field, const std::vector<PatchIndex>& patches) {
  Field those(static_cast<Eigen::Index>(patches.size()), field.cols());
  for (std::size_t k = 0; k < patches.size(); ++k) those.row(static_cast<Eigen::Index>(k)) = field.row(patches[k]);
  return those;
}

}  // namespace

PocketTransport::PocketTransport(const TransportOperator& transport, const Pockets& pockets,
                                 const Scattering& scattering)
    : transport_(transport), pockets_(pockets) {
  const Field reflectance = rows_of(scattering.reflectance, pockets.patches);
  for (Eigen::Index band = 0; band < reflectance.cols(); ++band)
    systems_.push_back(inner_system(pockets.form_factors, reflectance.col(band).matrix()));
  highest_ = inner_system(pockets.form_factors, reflectance.rowwise().maxCoeff().matrix());
}

// (I - F_PP R)^-1 H
Field PocketTransport::followed(const Field& irradiance) const {
  Field all(irradiance.rows(), irradiance.cols());
  const bool is_of_highest = all.cols() == 1 && systems_.size() > 1;
  assert(is_of_highest || all.cols() == static_cast<Eigen::Index>(systems_.size()));
  parallel_for(static_cast<std::size_t>(all.cols()), [&](std::size_t index) {
    const auto band = static_cast<Eigen::Index>(index);
    Eigen::BiCGSTAB<Rows, Shared> solver;
    solver.preconditioner().set(pockets_.nearly_solved);
    solver.setTolerance(inner_tolerance);
    solver.setMaxIterations(most_iterations);
    solver.compute(is_of_highest ? highest_ : systems_[index]);
    all.col(band) = solver.solve(irradiance.col(band).matrix()).array();
  });
  return all;
}

Field PocketTransport::apply(const FieldView& radiosity) const {
  Field irradiance = transport_.apply(radiosity);
  const Field own = (pockets_.form_factors * rows_of(radiosity, pockets_.patches).matrix()).array();
  const Field all = followed(rows_of(irradiance, pockets_.patches) - own);
  for (std::size_t k = 0; k < pockets_.patches.size(); ++k)
    irradiance.row(pockets_.patches[k]) = all.row(static_cast<Eigen::Index>(k));
  for (const PatchIndex patch : pockets_.closed) irradiance.row(patch) = 0;
  return irradiance;
}

Field PocketTransport::within(const Field& radiosity) const {
  Field irradiance = Field::Zero(radiosity.rows(), radiosity.cols());
  const Field own = (pockets_.form_factors * rows_of(radiosity, pockets_.patches).matrix()).array();
  const Field all = followed(own);
  for (std::size_t k = 0; k < pockets_.patches.size(); ++k)
    irradiance.row(pockets_.patches[k]) = all.row(static_cast<Eigen::Index>(k));
  return irradiance;
}

}  // namespace patchlight
