// How the starts of a fit are drawn, and what they may cost.
#pragma once

namespace ukemi::identify {

/// How starts are drawn, screened and followed. Chosen on the eight trials and their subsets; a change must keep
/// test/regression/global.cpp (`test_regression "random actuators*"`) and the cases of `ukemi bench stability`.
struct StartOptions {
  int draws = 240;          ///< that are screened, >= 1
  int draws_near = 60;      ///< the same where the logs give the gains away: Suggestion::spread_gains below 2
  double accuracy = 1e-4;   ///< relative tolerance of a screening rollout
  long steps = 5000;        ///< of a screening rollout at most
  double sample_steps = 3;  ///< and for each sample: enough for what comes near the logs
  double apart = 3;         ///< starts differ by this factor in some constant, > 1: no two from one basin if possible
  double spread = 10;       ///< factor about a given start, either way, in which further ones are drawn
  double fit_steps = 1e5;   ///< a start that asks for more integrated steps than this,
  double fit_sample_steps = 60;  ///< and this for each sample, is ended where it stands
  double fit_starts = 4;         ///< no other is tried once all took so many times that
  void validate() const;         ///< throws InputError
};

}  // namespace ukemi::identify
