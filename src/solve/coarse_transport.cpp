#include "solve/coarse_transport.h"

#include "base/vectors.h"

#include <Eigen/LU>
#include <algorithm>

namespace patchlight {
namespace {

constexpr Eigen::Index most_groups = 64;

}  // namespace

CoarseTransport::CoarseTransport(const RadiosityProblem& problem)
    : problem_(problem),
      patches_(problem.area.size()),
      groups_(std::min(most_groups, patches_)),
      arriving_(Eigen::MatrixXf::Zero(patches_, groups_)),
      arrived_(Eigen::VectorXd::Zero(groups_)),
      area_(Eigen::VectorXd::Zero(groups_)) {}

void CoarseTransport::learn(Eigen::Index source, const Field& shot_radiosity, const Field& arriving) {
  // A row of F is the same in all bands: the strongest one tells it best.
  Eigen::Index band = 0;
  if (!(shot_radiosity.row(0).abs().maxCoeff(&band) > 0)) return;
  const Eigen::VectorXd row = arriving.col(band) / shot_radiosity(0, band);
  const Eigen::Index group = group_of(source);
  arriving_.col(group) += row.cast<float>();
  arrived_[group] += scalar_product(problem_.area, row);
  area_[group] += problem_.area[source];
}

Eigen::Index CoarseTransport::next_source(const Field& waiting) const {
  const Eigen::ArrayXd flux = waiting.abs().rowwise().sum() * problem_.area.array();
  Eigen::VectorXd of_unknown = Eigen::VectorXd::Zero(groups_);
  for (Eigen::Index i = 0; i < patches_; ++i) {
    if (area_[group_of(i)] == 0) of_unknown[group_of(i)] += flux[i];
  }
  Eigen::Index group = 0;
  const bool is_known = !(of_unknown.maxCoeff(&group) > 0);
  Eigen::Index source = 0;
  double most = -1;
  for (Eigen::Index i = 0; i < patches_; ++i) {
    if (!(flux[i] > most) || (!is_known && group_of(i) != group)) continue;
    most = flux[i];
    source = i;
  }
  return source;
}

Field CoarseTransport::ambient(const Field& unshot) const {
  // 1. Q_ig, the irradiance at patch i by unit flux of group g, is (arriving_ig + even) / weight_g. No more than all
  //    light arrives, sum_i A_i Q_ig <= 1, whatever the errors of the rows.
  const double mean_area = total(problem_.area) / static_cast<double>(patches_);
  const double arrived_share = total(area_) > 0 ? std::min(1.0, total(arrived_) / total(area_)) : 1;
  const double even = arrived_share / static_cast<double>(patches_);
  const Eigen::VectorXd weight = (area_.array() + mean_area).max(arrived_.array() + mean_area * arrived_share).matrix();

  const Field sent_back = problem_.scattering.reflect(problem_.area.array().replicate(1, unshot.cols()));  // A_i rho_i
  Field irradiance = Field::Zero(unshot.rows(), unshot.cols());
  for (Eigen::Index band = 0; band < unshot.cols(); ++band) {
    // 2. Flux of group h by unit flux of group g: T_hg = sum_i A_i rho_i Q_ig over the patches i of h.
    Eigen::VectorXd U = Eigen::VectorXd::Zero(groups_);
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(groups_, groups_);
    for (Eigen::Index i = 0; i < patches_; ++i) {
      U[group_of(i)] += problem_.area[i] * unshot(i, band);
      T.row(group_of(i)) += sent_back(i, band) * (arriving_.row(i).cast<double>().array() + even).matrix();
    }
    T.array().rowwise() /= weight.array().transpose();
    if (T.colwise().sum().maxCoeff() >= 1) continue;

    // 3. With all reflections the flux is (I - T)^-1 U; Q takes it to the patches.
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(groups_, groups_);
    const Eigen::VectorXd flux = (I - T).partialPivLu().solve(U).cwiseQuotient(weight);
    irradiance.col(band) = (arriving_ * flux.cast<float>()).cast<double>().array() + even * total(flux);
  }
  return irradiance;
}

}  // namespace patchlight
