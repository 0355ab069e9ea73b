#pragma once

namespace patchlight::cli {

/// What the tool returns to the shell.
enum ExitCode : int {
  good = 0,
  usage_error = 1,        ///< the command line cannot be understood
  input_error = 2,        ///< the model or another input file cannot be used
  not_converged = 3,      ///< the solver did not reach the tolerance, or the error bars not the accuracy that was asked
                          ///< for; the results are written all the same
  out_of_memory = 4,      ///< the work would need more memory than there is
  validation_failed = 5,  ///< a result differs from the known or traced one by more than its error bar, or the bars are
                          ///< so wide that no difference could show
  output_error = 6,       ///< a result cannot be written
  internal_error = 70,    ///< a defect of patchlight
  signal_base = 128       ///< 128 + n: stopped by signal n, e.g. 130 by Ctrl-C; no file is half-written
};

}  // namespace patchlight::cli
