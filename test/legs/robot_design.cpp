// Which commands to log next: predicted errors are those of the fit of the log that follows, and commands that tell
// more are chosen first.
#include "tools/study/robot_design.hpp"

#include <catch2/catch.hpp>

#include "test/legs/pendulum.hpp"

using namespace legs;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> kKnown = {kFree[1], kFree[3], kFree[4], kFree[7]};

/// Commands of rows alone, `size` times those of the logs.
std::string commands_of(int rows, std::uint64_t draw, double size) {
  std::string out = "t,phi_ref_hip,phi_ref_knee,torque_ff_hip,torque_ff_knee\n";
  double ref[2], ff[2];
  for (int k = 0; k < rows; ++k) {
    command(k, draw, ref, ff);
    out += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g}\n", 0.004 * k, size * ref[0], size * ref[1], size * ff[0],
                       size * ff[1]);
  }
  return out;
}

struct Question : Case {
  explicit Question(int logs) : Case(Pendulum(), 1, logs, 0, kKnown) { asked.fit = options; }
  void add(const std::string& file, const std::string& text) {
    auto read = read_robot_trials(folder.write(file, text), robot.scene.robot,
                                  {.columns = "", .measured = RobotLogOptions::Measured::kNothing});
    next.push_back(std::move(read.at(0)));
  }
  RobotDesign design() const { return design_trials(robot, trials, next, asked); }
  std::vector<RobotTrial> next;
  RobotDesignOptions asked;
};

}  // namespace

TEST_CASE("the errors that a design predicts of a robot are those of the fit with the log that follows", "[driven]") {
  Question q(1);
  const std::string log = log_of(Pendulum(), 750, 1, 2e-4);
  q.add("next.csv", log);
  q.asked.trials = 1;
  const RobotDesign d = q.design();
  const RobotFit before = fit_robot(q.robot, q.trials, q.options);
  q.trials.push_back(read_robot_trials(q.folder.write("played.csv", log), q.robot.scene.robot, {}).at(0));
  const RobotFit after = fit_robot(q.robot, q.trials, q.options);
  REQUIRE(d.constants == kKnown);
  for (std::size_t i = 0; i < kKnown.size(); ++i) {
    INFO(kKnown[i]);
    const auto half_width = [&](const RobotFit& fit) {
      return 1.96 * *fit.globals()[i]->std_noise / std::abs(fit.globals()[i]->value);
    };
    CHECK(d.before[long(i)] == Approx(half_width(before)).epsilon(0.05));
    CHECK(d.after[long(i)] == Approx(half_width(after)).epsilon(0.05));
    CHECK(d.after[long(i)] < d.before[long(i)]);
  }
  CHECK(d.noise[kAngle] == Approx(2e-4).epsilon(0.1));
  CHECK(d.candidates.at(0).rank == 1);
  CHECK(d.candidates[0].together == d.size_after);
}

TEST_CASE("a design of a robot that was fitted, without its trials, begins with what its fit knew", "[driven]") {
  const Question with(1);
  const RobotFit fit = fit_robot(with.robot, with.trials, with.options);
  Question q(0);
  q.robot = fit.robot;
  REQUIRE(q.robot.known);
  q.add("next.csv", commands_of(500, 5, 1));
  q.asked.trials = 1;
  q.asked.fit.terms = design_terms(q.robot, {}, q.next, {});
  q.asked.fit.terms.free = kKnown;
  const RobotDesign d = q.design();
  for (std::size_t i = 0; i < kKnown.size(); ++i) {
    const identify::Estimate& e = *fit.globals()[i];
    CHECK(d.before[long(i)] == Approx(1.96 * *e.std / std::abs(e.value)).epsilon(0.01));
    CHECK(d.after[long(i)] < d.before[long(i)]);
  }
  for (const std::size_t o : {joint_channel(0) + kAngle, joint_channel(1) + kTorque})
    CHECK(d.noise[o] == q.robot.known->rms.at(d.channels[o].name));
  // What is asked for beside it is open; and noise that is given counts.
  q.asked.fit.terms.free.push_back("robot.link.thigh.mass"), q.asked.noise = {{"phi", 1e-3}};
  const RobotDesign more = q.design();
  CHECK_FALSE(std::isfinite(more.before[long(kKnown.size())]));
  CHECK(more.before[0] == Approx(d.before[0]));
  CHECK(more.noise[joint_channel(0) + kAngle] == 1e-3);
}

TEST_CASE("of commands those that tell most of a robot are logged first, under every criterion", "[driven]") {
  using enum identify::Criterion;
  for (const auto criterion : {kWorst, kD, kE}) {
    Question q(0);
    q.asked.criterion = criterion, q.asked.noise = {{"phi", 2e-4}, {"torque_knee", 0.01}};
    q.add("still.csv", commands_of(500, 1, 0)), q.add("small.csv", commands_of(500, 1, 0.1));
    q.add("large.csv", commands_of(500, 1, 1)), q.add("other.csv", commands_of(500, 5, 1));
    const RobotDesign d = q.design();
    INFO(name(criterion));
    CHECK(d.candidates[0].rank == 0);
    CHECK(d.candidates[1].rank == 0);
    CHECK(d.candidates[2].rank + d.candidates[3].rank == 3);
    CHECK(d.candidates[0].alone > 10 * d.candidates[1].alone);
    CHECK(d.candidates[1].alone > d.candidates[2].alone);
    CHECK(d.size_after < std::min(d.candidates[2].alone, d.candidates[3].alone));
    CHECK_FALSE(std::isfinite(d.before.maxCoeff()));
    CHECK(d.after.maxCoeff() < 0.2);
    CHECK(std::isfinite(d.noise[joint_channel(1) + kTorque]));
    CHECK_FALSE(std::isfinite(d.noise[joint_channel(0) + kTorque]));
  }
}

TEST_CASE("of heights that from which a drop tells most is chosen, and its log knows as much", "[driven]") {
  const test::Folder folder;
  const DrivenRobot robot = read_driven_robot(UKEMI_DATASETS "/scenes/hopper.toml");
  std::string held = "t,phi_ref_hip,phi_ref_knee\n";
  for (int k = 0; k < 300; ++k) held += fmt::format("{},0.6109,-1.2217\n", 0.002 * k);
  const auto commands = read_robot_trials(folder.write("held.csv", held), robot.scene.robot,
                                          {.columns = "", .measured = RobotLogOptions::Measured::kNothing});
  RobotDesignOptions asked;
  const std::vector<double> heights = {0, 0.02, 0.3};
  const std::vector<RobotTrial> next = from_heights(robot, commands, heights);
  asked.noise = {{"phi", 1e-3}}, asked.trials = 1;
  asked.fit.terms = design_terms(robot, {}, next, asked.noise), asked.fit.threads = 2;
  asked.fit.terms.free = {"robot.contact.foot.stiffness", "robot.contact.foot.damping_normal"};
  const RobotDesign d = design_trials(robot, {}, next, asked);
  REQUIRE(d.candidates.size() == heights.size());
  CHECK(d.candidates[2].rank == 1);
  CHECK(d.candidates[2].file.ends_with("held.csv from 0.3 m"));
  CHECK(d.candidates[0].alone > d.candidates[1].alone);
  CHECK(d.candidates[1].alone > d.candidates[2].alone);

  RobotTrial dropped = planned_trial(robot, next[2], d.noise);
  const std::vector<RobotTrial> still{dropped};
  const FollowedDrop fall = RobotTrials(robot, still, asked.fit).follow(0, {}, dropped.log.t, {});
  REQUIRE(fall.complete);
  Random random(kSeed, 5);
  for (std::size_t o = 0; o < dropped.log.output.size(); ++o)
    for (std::size_t k = 0; k < dropped.log.output[o].size(); ++k)
      dropped.log.output[o][k] = fall.value[o][k] + 1e-3 * random.normal();
  const RobotFit fit = fit_robot(robot, {dropped}, asked.fit);
  REQUIRE(fit.converged);
  for (std::size_t i = 0; i < d.constants.size(); ++i) {
    const auto& e = *fit.globals()[i];
    CHECK(d.after[long(i)] == Approx(1.96 * *e.std_noise / e.value).epsilon(0.15));
    CHECK(std::abs(e.value - d.value[long(i)]) < 4 * *e.std);
  }
  CHECK_THROWS_WITH(from_heights(robot, commands, {-0.1}), Contains("--heights: -0.1 m"));
  const Question pinned(0);
  CHECK_THROWS_WITH(from_heights(pinned.robot, commands, {0.1}), Contains("pinned"));
}

TEST_CASE("a pad and the exponent of a contact are fitted to the log of a drop", "[driven]") {
  const test::Folder folder;
  DrivenRobot robot = read_driven_robot(UKEMI_DATASETS "/scenes/hopper.toml");
  const auto foot = std::find_if(robot.scene.robot.contacts.begin(), robot.scene.robot.contacts.end(),
                                 [](const ContactPoint& c) { return c.name == "foot"; });
  std::string held = "t,phi_ref_hip,phi_ref_knee\n";
  for (int k = 0; k < 400; ++k) held += fmt::format("{},0.6109,-1.2217\n", 0.002 * k);
  const std::string log = folder.write("held.csv", held);
  const auto check = [&](const std::vector<std::string>& free, double off) {
    const auto read =
        read_robot_trials(log, robot.scene.robot, {.columns = "", .measured = RobotLogOptions::Measured::kNothing});
    RobotTrial dropped = from_heights(robot, read, {0.1}).front();
    const std::vector<DropChannel> channels = sensed_channels(robot.scene.robot);
    std::vector<double> noise(channels.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t o = 0; o < channels.size(); ++o)
      if (channels[o].name == "phi_hip" || channels[o].name == "phi_knee" || channels[o].name == "ay") noise[o] = 1e-3;
    dropped = planned_trial(robot, dropped, noise);
    RobotFitOptions options;
    options.threads = 2;
    const auto terms = [&] {
      const std::vector<RobotTrial> one{dropped};
      options.terms = robot_terms(robot, one), options.terms.free = free;
      return FollowedDrop(RobotTrials(robot, one, options).follow(0, {}, dropped.log.t, {}));
    };
    const FollowedDrop fall = terms();
    REQUIRE(fall.complete);
    Random random(kSeed, 6);
    for (std::size_t o = 0; o < channels.size(); ++o)
      for (std::size_t k = 0; k < dropped.log.output[o].size(); ++k)
        dropped.log.output[o][k] = fall.value[o][k] + (channels[o].name == "ay" ? 0.05 : 2e-4) * random.normal();
    (void)terms();
    DrivenRobot first = robot;
    for (const std::string& name : free) set_in(first, options.terms[name], off * number_of(robot, name));
    const RobotFit fit = fit_robot(first, {dropped}, options);
    REQUIRE(fit.converged);
    for (const std::string& name : free) {
      const identify::Estimate& e = *identify::find_constant(fit, name);
      INFO(name << " " << e.value << ", true " << number_of(robot, name));
      REQUIRE(e.std);
      CHECK(std::abs(e.value - number_of(robot, name)) < 4 * *e.std);
      CHECK(*e.std < 0.1 * e.value);
    }
  };
  SECTION("a pad") {
    foot->pad = Pad{.thickness = 0.02, .stiffness = 8000, .damping = 40};
    check({"robot.contact.foot.pad.stiffness", "robot.contact.foot.pad.damping"}, 1.2);
  }
  SECTION("an exponent") {
    foot->law.hunt_crossley = true, foot->law.damping_normal = 0, foot->law.exponent = 1.5, foot->law.dissipation = 0.3,
    foot->law.stiffness = 2e5;
    check({"robot.contact.foot.exponent", "robot.contact.foot.dissipation"}, 1.05);
  }
}

TEST_CASE("a design of a robot that cannot be is refused", "[driven]") {
  Question q(0);
  CHECK_THROWS_WITH(q.design(), Contains("--next: at least one"));
  q.add("next.csv", commands_of(20, 1, 1));
  CHECK_THROWS_WITH(q.design(), Contains("--noise is needed"));
  q.asked.noise = {{"ph", 1e-3}};
  CHECK_THROWS_WITH(q.design(), Contains("--noise: 'ph'"));
  q.asked.noise = {{"phi", 0}};
  CHECK_THROWS_WITH(q.design(), Contains("--noise: phi: above 0"));
  q.asked.noise = {{"phi", 1e-3}};
  q.add("torques.csv", "t,torque_ff_hip,torque_ff_knee\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n4,0,0\n5,0,0\n6,0,0\n7,0,0\n");
  CHECK_THROWS_WITH(q.design(), Contains("torques.csv: no column 'phi_hip', and no 'phi_ref_hip'"));
}
