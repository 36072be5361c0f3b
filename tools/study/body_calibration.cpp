#include "tools/study/body_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "tools/study/body_drops.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::Terms;

// --- laws ---

FloorLaw law_of(const Robot& robot) {
  FloorLaw out;
  for (const ContactPoint& c : robot.contacts) {
    out.hunt_crossley = out.hunt_crossley || c.law.hunt_crossley;
    out.coulomb = out.coulomb || std::isfinite(c.law.friction);
    out.pads = out.pads || c.pad.has_value();
  }
  return out;
}

std::string words(const FloorLaw& law) {
  return fmt::format("{}, {}, {}", law.hunt_crossley ? "Hunt and Crossley" : "linear",
                     law.coulomb ? "Coulomb's friction" : "viscous along the floor",
                     law.pads ? "with pads" : "without pads");
}

namespace {

/// Largest depth of a drop on a floor with F = K delta^p, the whole mass on one contact, without damping [m].
double depth_of(const BodyScene& scene, double stiffness, double exponent) {
  constexpr double kMinHeight = 0.02;  // of a fall [m]
  const double energy = scene.robot.mass() * scene.robot.gravity * std::max(scene.drop.height, kMinHeight);
  return std::pow((exponent + 1) * energy / stiffness, 1 / (exponent + 1));
}

/// The linear floor with the same force at the largest depth of a drop and the same damping at half that depth.
struct LinearFloor {
  double depth, stiffness, damping;  ///< [m], [N/m], [N/(m/s)]
};
LinearFloor equivalent_linear(const BodyScene& scene, const ContactLaw& law) {
  if (!law.hunt_crossley) return {depth_of(scene, law.stiffness, 1), law.stiffness, law.damping_normal};
  const double depth = depth_of(scene, law.stiffness, law.exponent),
               stiffness = law.stiffness * std::pow(depth, law.exponent - 1);
  return {depth, stiffness, 0.5 * law.dissipation * stiffness * depth};
}

/// Switches between the two normal laws, with the same equivalent linear floor.
void change_normal(const BodyScene& scene, ContactLaw& law) {
  constexpr double kHertz = 1.5;
  const LinearFloor linear = equivalent_linear(scene, law);
  if (!law.hunt_crossley) {
    law.dissipation = linear.damping / (0.5 * linear.stiffness * linear.depth);
    law.stiffness *= std::pow(linear.depth, 1 - kHertz), law.exponent = kHertz, law.damping_normal = 0;
  } else {
    law.stiffness = linear.stiffness, law.damping_normal = linear.damping;
  }
  law.hunt_crossley = !law.hunt_crossley;
}

/// Switches between Coulomb friction with tangential stiffness and viscous friction without a limit.
void change_tangential(const BodyScene& scene, ContactLaw& law) {
  constexpr double kFriction = 0.5, kMinRatio = 0.1;
  if (std::isfinite(law.friction)) {
    law.friction = std::numeric_limits<double>::infinity(), law.stiffness_tangential = 0;
    return;
  }
  const LinearFloor linear = equivalent_linear(scene, law);
  law.friction = kFriction;
  if (law.stiffness_tangential == 0) law.stiffness_tangential = linear.stiffness;
  law.damping_tangential = std::max({law.damping_tangential, kMinRatio * linear.damping, 1e-4 * linear.stiffness});
}

/// A pad that is much softer than the floor.
Pad pad_on(const BodyScene& scene, const ContactLaw& law) {
  constexpr double kThickness = 0.01, kSoft = 0.3;
  const LinearFloor linear = equivalent_linear(scene, law);
  return {kThickness, kSoft * linear.stiffness, kSoft * linear.damping};
}

/// A constant of contact laws: its term, the contacts that it acts on, and those it is fitted for by default.
struct ContactConstant {
  DropTerm term;
  bool (*acts)(const ContactPoint&);
  bool (*chosen)(const ContactPoint&);
};

DropTerm contact_term(const char* name, const char* unit, const char* words, double smallest_part, double size,
                      double spread) {
  DropTerm t = floor_term(name, unit, words, smallest_part, {name});
  t.size = size, t.spread = spread;
  return t;
}

std::vector<ContactConstant> contact_constants() {
  const auto always = [](const ContactPoint&) { return true; };
  const auto linear = [](const ContactPoint& c) { return !c.law.hunt_crossley; };
  const auto hunt_crossley = [](const ContactPoint& c) { return c.law.hunt_crossley; };
  const auto coulomb = [](const ContactPoint& c) { return std::isfinite(c.law.friction); };
  const auto sticks = [](const ContactPoint& c) {
    return std::isfinite(c.law.friction) || c.law.stiffness_tangential > 0;
  };
  const auto padded = [](const ContactPoint& c) { return c.pad.has_value(); };
  std::vector<ContactConstant> out = {
      {contact_term("stiffness", "N/m", "stiffness of the floor", 1e-3, 1, 2), always, always},
      {contact_term("damping_normal", "N/(m/s)", "damping of the floor along its normal", 0, 1, 2), linear, linear},
      {contact_term("exponent", "1", "of the depth, of Hunt and Crossley", 0, 1, 1.3), hunt_crossley, hunt_crossley},
      {contact_term("dissipation", "s/m", "of Hunt and Crossley", 0, 0.1, 2), hunt_crossley, hunt_crossley},
      {contact_term("damping_tangential", "N/(m/s)", "damping of the floor along it", 1e-3, 1, 3), always, always},
      {contact_term("stiffness_tangential", "N/m", "stiffness of the floor along it", 0, 1, 4), always, sticks},
      {contact_term("friction", "1", "coefficient of friction", 1e-3, 0.1, 2.5), coulomb, coulomb},
      {contact_term("pad_stiffness", "N/m", "stiffness of the pads", 1e-3, 1, 2), padded, padded},
      {contact_term("pad_damping", "N/(m/s)", "damping of the pads", 0, 1, 2), padded, padded},
      {contact_term("pad_thickness", "m", "thickness of the pads", 1e-2, 1e-3, 2), padded, padded}};
  out[2].term.lower = 1, out[2].term.upper = 4;
  out[6].term.upper = 10;
  return out;
}

/// Whether a contact takes the constant from [floor], with the value of the other contacts.
bool shared(const BodyScene& scene, const ContactPoint& c, const std::string& key, double common) {
  BodyScene copy = scene;
  return std::find(c.own_keys.begin(), c.own_keys.end(), key) == c.own_keys.end() &&
         *scene_numbers(copy, c.name + "." + key).front() == common;
}

/// Appends the terms of one constant to `table`, and the names of those that are free by default to out.free.
void add_terms(const BodyScene& scene, const ContactConstant& constant, std::vector<DropTerm>& table,
               Terms<DropTerm>& out) {
  const std::string& key = constant.term.name;
  DropTerm all = constant.term;
  all.moves.clear();
  std::vector<DropTerm> single;
  std::vector<std::string> own;
  std::optional<double> first;
  bool chosen = false;
  const std::vector<ContactPoint>& contacts = scene.robot.contacts;
  for (const ContactPoint& c : contacts) {
    if (!constant.acts(c)) continue;
    DropTerm one = constant.term;
    one.name = c.name + "." + key, one.moves = {one.name}, one.words += ", of " + c.name + " alone";
    BodyScene copy = scene;
    const bool given = std::find(c.own_keys.begin(), c.own_keys.end(), key) != c.own_keys.end() && contacts.size() > 1;
    if (!first && !given) first = *scene_numbers(copy, one.moves[0]).front();
    if (given || !shared(scene, c, key, *first)) {
      if (constant.chosen(c)) own.push_back(one.name);
    } else {
      all.moves.push_back(one.moves[0]), chosen = chosen || constant.chosen(c);
    }
    single.push_back(std::move(one));
  }
  if (!all.moves.empty()) {
    if (chosen) out.free.push_back(key);
    table.push_back(all);
  }
  out.free.insert(out.free.end(), own.begin(), own.end());
  if (contacts.size() > 1) table.insert(table.end(), single.begin(), single.end());
}

/// Orders constants of single contacts after those that contacts share, so that they override them, and removes those
/// that are not fitted and follow a shared one.
void put_in_order(Terms<DropTerm>& terms) {
  const auto single = [](const DropTerm& t) { return t.name.find('.') != std::string::npos; };
  const auto follows = [&](const DropTerm& t) {
    return single(t) && !terms.fits(t.name) && std::any_of(terms.table->begin(), terms.table->end(), [&](auto& other) {
             return !single(other) && other.is_constant() && t.moves_same_number(other);
           });
  };
  std::vector<DropTerm> kept;
  for (const DropTerm& t : *terms.table)
    if (!follows(t)) kept.push_back(t);
  terms.table = std::make_shared<const std::vector<DropTerm>>(std::move(kept));
  std::stable_sort(terms.free.begin(), terms.free.end(), [&](const std::string& a, const std::string& b) {
    return terms[a].moves.size() > terms[b].moves.size();
  });
}

/// The choice of terms for the law of `scene`: those of `before` that it has, and constants that are new with it.
Terms<DropTerm> choice_for(const BodyScene& scene, const Terms<DropTerm>& before) {
  Terms<DropTerm> out = drop_choice(scene);
  const auto has = [](const Terms<DropTerm>& terms, const std::string& name) {
    return std::any_of(terms.table->begin(), terms.table->end(), [&](const DropTerm& t) { return t.name == name; });
  };
  const std::vector<std::string> chosen = std::move(out.free);
  out.free.clear();
  for (const std::string& name : chosen)
    if (!has(before, name) || before.fits(name) || name.rfind("stiffness_tangential") != std::string::npos)
      out.free.push_back(name);
  out.nuisance = before.nuisance;
  for (const auto& [from, to] : {std::pair(&before.lower, &out.lower), {&before.upper, &out.upper}})
    for (const auto& [name, bound] : *from)
      if (has(out, name)) to->emplace(name, bound);
  for (const identify::Prior& p : before.priors)
    if (out.fits(p.term)) out.priors.push_back(p);
  put_in_order(out);
  return out;
}

/// Sets the number of fitted values, the BIC, and the rms in units of the outputs' noise.
void set_quality(const BodyDrops& drops, const FloorFit& fit, TriedLaw& out) {
  double deviance = 0, samples = 0, squares = 0;
  for (std::size_t o = 0; o < fit.channels.size(); ++o) {
    if (!std::isfinite(fit.noise[o])) continue;
    double n = 0;
    for (std::size_t m = 0; m < drops.drops(); ++m) n += double(drops.log(m).count(o));
    deviance += n * std::log(fit.rms[o] * fit.rms[o]), samples += n;
    squares += n * std::pow(fit.rms[o] / fit.noise[o], 2);
  }
  out.fitted = int(fit.fitted.size()) +
               int(std::count_if(fit.nuisance.begin(), fit.nuisance.end(), [](auto& e) { return e.trial >= 0; }));
  out.rms = std::sqrt(squares / samples), out.bic = deviance + out.fitted * std::log(samples);
}

BodyDrops simulated(const BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
                    const BodyCalibrationOptions& options) {
  return {scene, drops, body_channels(scene.robot), options.accuracy, options.threads};
}

/// A fit of the law of a scene, and its summary.
struct LawFit {
  FloorFit fit;
  TriedLaw tried;
};
LawFit fit_law(const BodyScene& from, const std::vector<BodyLoggedDrop>& drops, const BodyCalibrationOptions& options) {
  const BodyDrops simulator = simulated(from, drops, options);
  LawFit out{fit_floor(simulator, options), {.law = law_of(from.robot)}};
  out.tried.scene = fitted_scene(from, options.terms, out.fit);
  out.tried.converged = out.fit.converged, out.tried.rejected = out.fit.tests.model_rejected();
  if (!out.fit.drops.empty() && out.fit.drops[0].simulated) set_quality(simulator, out.fit, out.tried);
  if (out.fit.converged && drops.size() > 1)
    out.tried.held_out = held_out(simulated(out.tried.scene, drops, options), options);
  return out;
}

/// The laws that differ from one in a single part.
std::vector<FloorLaw> neighbours(const FloorLaw& law) {
  FloorLaw normal = law, tangential = law, pads = law;
  normal.hunt_crossley = !law.hunt_crossley, tangential.coulomb = !law.coulomb, pads.pads = !law.pads;
  return {normal, tangential, pads};
}

/// Whether `a` is better than `b` by kDecisive in BIC and no worse in the leave-one-out error.
bool better(const TriedLaw& a, const TriedLaw& b) {
  return a.converged && a.bic < b.bic - kDecisive && !(a.held_out > b.held_out);
}

constexpr int kRivalStarts = 2;  ///< at most, further starts of a rival law: its first start is close already
constexpr int kRivalSteps = 40;  ///< at most, iterations of its solver

/// Fits the neighbours of the best law until none is better.
void try_rivals(const std::vector<BodyLoggedDrop>& drops, const BodyCalibrationOptions& options, BodyCalibration& out) {
  for (std::size_t from = 0; !options.monitor.stopped();) {
    const TriedLaw start = out.laws[from];
    for (const FloorLaw& law : neighbours(start.law)) {
      if (std::any_of(out.laws.begin(), out.laws.end(), [&](auto& t) { return t.law == law; })) continue;
      const BodyScene scene = with_law(start.scene, law);
      BodyCalibrationOptions rival = options;
      rival.terms = choice_for(scene, options.terms);
      rival.restarts = std::min(rival.restarts, kRivalStarts);
      rival.max_iterations = std::min(rival.max_iterations, kRivalSteps);
      if (rival.terms.free.empty()) continue;
      out.laws.push_back(fit_law(scene, drops, rival).tried);
    }
    for (std::size_t i = 0; i < out.laws.size(); ++i)
      if (better(out.laws[i], out.laws[out.best_law])) out.best_law = i;
    if (out.best_law == from) break;
    from = out.best_law;
  }
}

/// Sets uncertainty and verdicts of the scene's constants; where its law is rejected none is trusted.
void set_verdicts(BodyCalibration& c) {
  if (c.law_rejected()) identify::distrust(c.parameters);
  if (c.converged) c.scene.uncertainty = c.uncertainty();
  c.scene.verdicts = c.verdicts();
}

}  // namespace

BodyScene with_law(BodyScene scene, const FloorLaw& law) {
  const BodyScene given = scene;
  for (ContactPoint& c : scene.robot.contacts) {
    if (c.law.hunt_crossley != law.hunt_crossley) change_normal(given, c.law);
    if (std::isfinite(c.law.friction) != law.coulomb) change_tangential(given, c.law);
    if (!law.pads)
      c.pad.reset();
    else if (!law_of(given.robot).pads)
      c.pad = pad_on(given, c.law);
  }
  return scene;
}

// --- terms ---

Terms<DropTerm> drop_choice(const BodyScene& scene) {
  Terms<DropTerm> out;
  std::vector<DropTerm> table;
  for (const ContactConstant& constant : contact_constants()) add_terms(scene, constant, table, out);
  const Base base = scene.robot.base;
  if (base != Base::kRail) table.push_back(pitch_term());
  if (base == Base::kFree) out.free.push_back("pitch");
  for (DropTerm& t : drop_nuisances()) {
    const bool moves_base = t.name == "height_offset"  ? base != Base::kPinned
                            : t.name == "speed_offset" ? base == Base::kFree
                            : t.name == "pitch_offset" ? base != Base::kRail
                                                       : true;
    if (moves_base) table.push_back(std::move(t));
  }
  out.table = std::make_shared<const std::vector<DropTerm>>(std::move(table));
  return out;
}

// --- fits ---

void check_drop_arguments(const Robot& robot, const char* height, const char* forward_speed) {
  if (height && robot.base == Base::kPinned) throw InputError(std::string(height) + ": a pinned robot is not dropped");
  if (forward_speed && robot.base != Base::kFree)
    throw InputError(std::string(forward_speed) + ": a robot on this base has no forward speed");
}

void check_drops(const BodyScene& scene, const std::vector<BodyLoggedDrop>& drops) {
  check_floor(scene);
  constexpr double kAccuracy = 1e-6;
  check_logs(BodyDrops(scene, drops, body_channels(scene.robot), kAccuracy, 1));
}

BodyCalibration calibrate(const BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
                          const BodyCalibrationOptions& options) {
  options.validate();
  check_drops(scene, drops);
  BodyCalibrationOptions ordered = options;
  put_in_order(ordered.terms);
  LawFit given = fit_law(scene, drops, ordered);
  BodyCalibration out{std::move(given.fit), given.tried.scene};
  if (std::isfinite(given.tried.bic)) {
    out.laws.push_back(std::move(given.tried));
    if (options.rivals == BodyCalibrationOptions::Rivals::kTried) try_rivals(drops, ordered, out);
    const double reference = out.laws[0].bic;
    for (TriedLaw& t : out.laws) t.bic -= reference;
  }
  set_verdicts(out);
  return out;
}

void adopt_best_law(BodyCalibration& c, const std::vector<BodyLoggedDrop>& drops,
                    const BodyCalibrationOptions& options) {
  if (c.best_law == c.scene_law) return;
  BodyCalibrationOptions refit = options;
  refit.terms = choice_for(c.laws[c.best_law].scene, options.terms);
  LawFit best = fit_law(c.laws[c.best_law].scene, drops, refit);
  static_cast<FloorFit&>(c) = std::move(best.fit);
  c.scene = std::move(best.tried.scene), c.scene_law = c.best_law;
  set_verdicts(c);
}

BodyCalibration validate(const BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
                         const BodyCalibrationOptions& options) {
  check_drops(scene, drops);
  return {validate_floor(simulated(scene, drops, options), options), scene};
}

}  // namespace ukemi::tools
