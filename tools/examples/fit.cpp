// An actuator's constants from logs of impact tests.
//
//     fit RIG.toml ACTUATOR_OUT.toml TRIAL.csv...
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include <ukemi/actuator.hpp>
#include <ukemi/identify/fit.hpp>

int main(int argc, char** argv) {
  using namespace ukemi;
  if (argc < 4) {
    std::fprintf(stderr, "fit RIG.toml ACTUATOR_OUT.toml TRIAL.csv...\n");
    return 2;
  }
  try {
    const identify::Rig rig = identify::read_rig(argv[1]);
    std::vector<identify::Trial> trials;
    for (int i = 3; i < argc; ++i) trials.push_back(identify::read_trial(argv[i]));
    const SeaParameters<double> base = rig.mounted({});                        // what is not fitted
    const identify::Fit fit = identify::fit(rig, trials, std::nullopt, base);  // starts are estimated from the logs
    for (const identify::Estimate& e : fit.parameters)
      std::printf("%-8s %10.5g +- %-9.2g %-12s %s\n", e.name.c_str(), e.value, e.std.value_or(0), e.unit.c_str(),
                  name(e.verdict));
    for (const std::string& warning : fit.warnings) std::fprintf(stderr, "fit: %s\n", warning.c_str());
    Actuator out;
    out.name = "fitted";
    out.sea = fit.sea;
    std::ofstream(argv[2]) << to_toml(out);
    return fit.trusted() ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "fit: %s\n", e.what());
    return 2;
  }
}
