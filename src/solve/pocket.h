#pragma once

#include "patchlight/base/field.h"

#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <vector>

namespace patchlight {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Triangular factors of about a sparse matrix: small entries were dropped (ILUT, Saad 1994).
struct IncompleteFactors {
  Eigen::SparseMatrix<float, Eigen::RowMajor> factors;  ///< L without its diagonal of ones, and U
  std::vector<int> order;                               ///< row k of the factors is that of the matrix's row order[k]
};

/// Patches that keep light among themselves, as those of white boards 3 mm apart do: it takes hundreds of bounces to
/// get out. Iterations over all patches hardly change what is there, and no bound on the error is found.
struct Pocket {
  std::vector<PatchIndex> patches;  ///< in rising order; none sees one of another pocket
  SparseRows form_factors;          ///< F among them, numbered as they stand there
  Eigen::VectorXd bounces;          ///< (I - F rho)^-1 1, rho the highest reflectance of all bands: how often light is
                                    ///< reflected before it gets out
  IncompleteFactors nearly_solved;  ///< of I - F rho; of few patches empty
};

/// I - F R among the patches of a pocket, in each band of R.
struct PocketSystem {
  Field reflectance;                                          ///< R
  std::vector<Eigen::PartialPivLU<Eigen::MatrixXd>> factors;  ///< per band of up to 512 patches, else empty

  bool is_eliminated() const { return !factors.empty(); }
};

/// From F and the reflectances of the patches.
PocketSystem system_within(const SparseRows& form_factors, const FieldView& reflectance);

/// Of I - F rho. Costs some applications of it for each entry of a row.
IncompleteFactors incomplete_factors(const SparseRows& form_factors, const Eigen::VectorXd& reflectance);

/// F B: the irradiance of the patches by each other, of their radiosities in each band.
Field arriving_within(const Pocket& pocket, const Field& radiosity);

/// right - (I - F R) x in each band.
Field residual_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, const FieldView& x);

/// x in each band: by the factors of the system, or by BiCGSTAB (van der Vorst 1992) until ||r||_2 is below `tolerance`
/// times ||right||_2, or 200 iterations are done. Each band is solved as it would be by itself, to the bit.
Field solution_within(const Pocket& pocket, const PocketSystem& system, const FieldView& right, double tolerance);

}  // namespace patchlight
