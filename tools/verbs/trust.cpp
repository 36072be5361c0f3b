#include "tools/verbs/trust.hpp"

namespace ukemi::tools {

void add_trust_options(CLI::App& verb, TrustArguments& arguments) {
  verb.add_flag_callback(
      "--strict", [&] { arguments.doubt = Doubt::kFail; },
      "exit 1 unless every fitted constant is trusted (95 % interval within 10 % of its value)");
  verb.add_flag_callback(
      "--diagnose", [&] { arguments.depth = identify::TrustOptions::Depth::kRefit; },
      "refit with and without each optional term (BIC, likelihood ratio, held-out error), and without each trial");
  verb.add_option("--profile", arguments.profile,
                  "k_sea,...: profile likelihood of these constants: profile.csv and unsymmetric 95 % intervals");
}

}  // namespace ukemi::tools
