#include "tools/verbs/trust.hpp"

#include "tools/program/arguments.hpp"

namespace ukemi::tools {

void add_trust_options(CLI::App& verb, TrustArguments& arguments) {
  verb.add_flag_callback(
      "--strict", [&] { arguments.doubt = Doubt::kFail; },
      "exit 1 unless every fitted constant is trusted (95 % interval within 10 % of its value)");
  verb.add_flag_callback(
      "--diagnose", [&] { arguments.depth = TrustArguments::Depth::kRefit; },
      "refit with and without each optional term (BIC, likelihood ratio, held-out error), and without each trial");
  verb.add_option("--profile", arguments.profile,
                  "k_sea,...: profile likelihood of these constants: profile.csv and unsymmetric 95 % intervals");
}

Trust examine(const identify::Experiment& experiment, identify::Fit& fit, const TrustArguments& arguments, Run& run) {
  Trust t;
  const int threads = run.options().threads;
  t.tests = test_residuals(experiment, fit);
  heed(t.tests, fit);
  if (fit.interrupted) return t;
  if (arguments.depth == TrustArguments::Depth::kRefit) {
    t.ladder = ladder(experiment, fit, identify::HeldOut::kCompute, threads);
    if (fit.converged) t.left_out = leave_one_out(experiment, fit, threads);
  }
  for (const std::string& constant : split(arguments.profile)) {
    if (fit.parameters[constant_index("--profile", constant)].std && fit.converged)
      t.profiles.push_back(profile(experiment, fit, constant));
    else
      run.warn(constant + " has no standard error: no profile");
  }
  return t;
}

}  // namespace ukemi::tools
