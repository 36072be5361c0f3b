// How the starts of a fit are drawn, and what they may cost.
#pragma once

namespace ukemi::identify {

/// How starts are drawn, screened and followed. Chosen on the eight trials and their subsets; a change must keep
/// test/regression/global.cpp (`test_regression "random actuators*"`) and the cases of `ukemi bench stability`.
struct StartOptions {
  int draws = 240;               ///< starts that are screened, >= 1
  int draws_near = 60;           ///< the same where the logs give the gains: Suggestion::spread_gains below 2
  double accuracy = 1e-4;        ///< relative tolerance of a screening rollout
  long steps = 5000;             ///< maximum of a screening rollout
  double sample_steps = 3;       ///< maximum of a screening per sample: enough for starts with small residuals
  double apart = 3;              ///< starts differ by this factor in some constant, > 1, so that few share a basin
  double spread = 10;            ///< further starts are drawn within this factor of a given one, either way
  double fit_steps = 1e5;        ///< maximum of integrated steps of one start,
  double fit_sample_steps = 60;  ///< plus this per sample; it then ends at its best point
  double fit_starts = 4;         ///< no further start once all have taken this many times that work
  void validate() const;         ///< throws InputError
};

}  // namespace ukemi::identify
