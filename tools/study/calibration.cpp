#include "tools/study/calibration.hpp"

#include "common/eigen.hpp"
#include "common/error.hpp"
#include "landing/model/release.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// A number that a term sets: its member in a scene, and the parameter of its exact derivative.
struct SceneNumber {
  const char* name;
  double& (*in)(Scene&);
  Parameter derivative;
};
constexpr SceneNumber kNumbers[] = {
    {"stiffness", [](Scene& s) -> double& { return s.floor->stiffness; }, Parameter::kStiffness},
    {"damping_normal", [](Scene& s) -> double& { return s.floor->damping_normal; }, Parameter::kDampingNormal},
    {"damping_tangential", [](Scene& s) -> double& { return s.floor->damping_tangential; },
     Parameter::kDampingTangential},
    {"pitch", [](Scene& s) -> double& { return s.drop.pitch; }, Parameter::kPitch},
    {"height", [](Scene& s) -> double& { return s.drop.height; }, Parameter::kHeight},
    {"forward_speed", [](Scene& s) -> double& { return s.drop.forward_speed; }, Parameter::kForwardSpeed},
};
const SceneNumber& number_of(const DropTerm& term) {
  const auto moved = [&](const SceneNumber& n) { return term.moves.front() == n.name; };
  return *std::find_if(std::begin(kNumbers), std::end(kNumbers), moved);
}

class PaperDrops : public DropSimulator {
 public:
  PaperDrops(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops)
      : scene_(scene), sea_(sea), drops_(drops) {}

  const std::vector<DropChannel>& channels() const override { return thigh_channels(); }
  std::size_t drops() const override { return drops_.size(); }
  const DropLog& log(std::size_t m) const override { return drops_[m].log; }
  double value(const DropTerm& constant) const override {
    Scene scene = scene_;
    return number_of(constant).in(scene);
  }
  double first_touchdown(std::size_t m) const override {
    const Scene scene = scene_at(m, {});
    return is_ballistic(scene.drop, 0) ? fall_time(scene) : 0;
  }
  FollowedDrop follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                      const SimulateOptions& options) const override {
    FollowedDrop out;
    const Scene scene = scene_at(m, settings);
    if (!(scene.drop.height >= 0 && scene.floor->stiffness > 0)) return out;
    DropRollout rolled = roll_drop(scene, sea_, drops_[m].motion, times, options);
    out.complete = rolled.complete, out.steps = rolled.steps, out.jumps = std::move(rolled.jumps);
    const long n = long(rolled.samples.size()), columns = long(settings.size());
    out.value.resize(kOutputs), out.slope.assign(kOutputs, Eigen::MatrixXd(n, columns));
    for (std::size_t o = 0; o < kOutputs; ++o) {
      for (const DropSample& s : rolled.samples) out.value[o].push_back(s.value[o]);
      for (long c = 0; c < columns; ++c) {
        const DropTerm& term = *settings[std::size_t(c)].term;
        const int slot = term.shifts_log() ? -1 : drop_slot(number_of(term).derivative);
        for (long i = 0; i < n; ++i) {
          const DropSample& s = rolled.samples[std::size_t(i)];
          out.slope[o](i, c) = slot < 0 ? s.rate[o] : s.slope[o][slot];
        }
      }
    }
    return out;
  }
  bool differentiate(std::size_t, const Settings&, const std::vector<double>&, const SimulateOptions&,
                     FollowedDrop&) const override {
    return true;  // follow has set the slopes
  }
  double peak(std::size_t m, const Settings& settings, double until, const SimulateOptions& options) const override {
    Scene scene = scene_at(m, settings);
    scene.t_end = until;
    SimulateOptions to_the_end = options;
    to_the_end.rest = SimulateOptions::Rest::kIgnore;
    return peak_acceleration(scene, sea_, drops_[m].motion, to_the_end).peak;
  }

 private:
  Scene scene_at(std::size_t m, const Settings& settings) const {
    Scene scene = scene_;
    scene.drop = drops_[m].thrown;
    scene.drop.pitch = scene_.drop.pitch;
    for (const auto& [term, value] : settings) {
      if (term->shifts_log()) continue;
      double& number = number_of(*term).in(scene);
      number = term->is_constant() ? value : number + value;
    }
    return scene;
  }

  const Scene& scene_;
  const SeaParameters<double>& sea_;
  const std::vector<LoggedDrop>& drops_;
};

}  // namespace

void check_drops(const Scene& scene, const std::vector<LoggedDrop>& drops) {
  if (drops.empty()) throw InputError("no drops: at least one log is needed");
  if (!scene.touches())
    throw InputError("the scene has no [floor] or no contacts: both are needed, the floor's constants as a start");
  check_logs(PaperDrops(scene, {}, drops));
}

Calibration calibrate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                      const CalibrationOptions& options) {
  options.validate();
  check_drops(scene, drops);
  Calibration out{fit_floor(PaperDrops(scene, sea, drops), options), scene};
  for (const DropTerm& t : *options.terms.table)
    if (t.is_constant())
      for (const identify::Estimate& e : out.parameters)
        if (e.name == t.name && e.free) number_of(t).in(out.scene) = e.value;
  static const std::vector<std::string> known(kUncertainNames.begin(), kUncertainNames.end());
  if (out.converged) out.scene.uncertainty = out.uncertainty(&known);
  out.scene.verdicts = out.verdicts();
  return out;
}

Calibration validate(const Scene& scene, const SeaParameters<double>& sea, const std::vector<LoggedDrop>& drops,
                     const CalibrationOptions& options) {
  check_drops(scene, drops);
  return {validate_floor(PaperDrops(scene, sea, drops), options), scene};
}

}  // namespace ukemi::tools
