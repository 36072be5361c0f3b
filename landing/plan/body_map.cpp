#include "landing/plan/body_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "landing/body/load.hpp"
#include "landing/judge/peak_grid.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/search/cma.hpp"

namespace ukemi::landing {

namespace {

const std::function<bool()>* over_of(const Monitor& monitor) { return monitor.stop ? &monitor.stop : nullptr; }

/// Landings of motions in lanes, abandoned above a value; those that the monitor cuts off are kStopped.
std::vector<BodyLanding> landings_of(const BodyScene& scene, const std::vector<BodyMotion>& motions, double above,
                                     const Monitor& monitor) {
  std::vector<BodyBatchCase> cases;
  for (const BodyMotion& m : motions) cases.push_back({&scene, &m, above});
  std::vector<BodyLanding> out(cases.size());
  body_batch_peaks(cases, out, {.accuracy = kSearchAccuracy, .over = over_of(monitor)});
  return out;
}

/// The value of a landing; kNoMotion where it could not be followed, broke a limit, or was stopped.
double worth_or_none(const BodyScene& scene, const BodyLanding& l) {
  return no_landing(l.end) || l.end == End::kStopped ? kNoMotion : worth(scene, l);
}

/// Covariance matrix adaptation from a cell; the better of start and end at a tight accuracy.
Candidate descend_from(const BodyScene& scene, const BodySpace& space, const Coordinates& from,
                       const MapOptions& options, std::uint64_t n) {
  constexpr int kPoints = 14;
  constexpr long kMotions = 1500;
  constexpr double kWidth = 0.05, kConverged = 1e-4;
  const Candidate start{from};
  Candidate best = start;
  Random random(options.seed, n);
  CovarianceAdaptation distribution;
  distribution.start(from, kWidth, kPoints);
  std::vector<Candidate> points(kPoints);
  double bound = kNoMotion;
  for (long played = 0; played < kMotions && distribution.largest_deviation() > kConverged; played += kPoints) {
    if (options.monitor.stopped()) return start;
    distribution.sample(random, points);
    std::vector<BodyMotion> motions;
    for (const Candidate& p : points) motions.push_back(space.motion(p.u));
    const std::vector<BodyLanding> landings = landings_of(scene, motions, bound, options.monitor);
    for (std::size_t k = 0; k < points.size(); ++k) points[k].value = worth_or_none(scene, landings[k]);
    bound = distribution.update(points);
    best = std::min(best, points[0]);
  }
  Candidate out;
  for (Candidate p : {start, best}) {
    p.value = worth_or_none(scene, simulate(scene, space.motion(p.u), {.accuracy = options.tight}));
    if (out.u.size() == 0 || p < out) out = p;
  }
  return out;
}

}  // namespace

std::vector<int> cells_of(const BodySpace& space, const std::vector<GridAxis>& axes, const std::string& option) {
  constexpr int kDefault = 64, kOfThree = 24;
  std::vector<std::string> names;
  for (const Variable& v : space.variables()) names.push_back(v.name);
  if (axes.empty() || axes.size() > 3)
    throw InputError(fmt::format("{}: {} variables: one to three of {} are needed, the others stand", option,
                                 axes.size(), fmt::join(names, ", ")));
  std::vector<int> out(names.size(), 1);
  for (const GridAxis& axis : axes) {
    const auto found = std::find(names.begin(), names.end(), axis.variable);
    if (found == names.end()) throw InputError(option + ": " + one_of(axis.variable, names));
    int& points = out[std::size_t(found - names.begin())];
    if (points > 1) throw InputError(option + ": " + quoted(axis.variable) + ": the variable is given twice");
    const double n = axis.points.value_or(axes.size() < 3 ? kDefault : kOfThree);
    if (!(n >= 2 && n <= 4096 && n == std::floor(n)))
      throw InputError(fmt::format("{}: {}: {}: a whole number of points from 2 to 4096 is needed", option,
                                   quoted(axis.variable), n));
    points = int(n);
  }
  return out;
}

Coordinates slice_of(const BodySpace& space, const BodyScene& scene, const BodyMotion& motion, const Location& where) {
  const Coordinates unit = space.unit(motion);
  BodyMotion given = motion, nearest = space.motion(unit);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Joint& joint = scene.robot.joints[i];
    if (!joint.driven()) continue;
    if (given[i].reposition && !nearest[i].reposition)
      throw InputError(where,
                       fmt::format("joint '{}' moves in the air: motions without such a move are mapped", joint.name));
    double a = 0, b = 0;
    const auto x = motion_numbers(given[i], a), y = motion_numbers(nearest[i], b);
    for (std::size_t k = 0; k < kMotionNames.size(); ++k)
      if (!(std::abs(*x[k] - *y[k]) <= 1e-9))
        throw InputError(where, fmt::format("{}_{} = {:.6g}: {:.6g} is the nearest that is mapped", kMotionNames[k],
                                            joint.name, *x[k], *y[k]));
  }
  return space.values(unit);
}

Coordinates held_slice(const BodySpace& space, const BodyScene& scene) {
  BodyMotion held = held_posture(scene);
  for (Motion& m : held) m.duration = 0.5 * (scene.duration[0] + scene.duration[1]);
  return space.values(space.unit(held));
}

BodySurvey survey(const BodyScene& given, const SurveyOptions& options) {
  given.validate();
  BodyScene scene = given;
  scene.ends_broken = true;
  const BodySpace space(scene);
  const auto motion = [&](const PeakMap& map, const PeakMap::Place& at) {
    return space.motion(space.unit(map.values(at)));
  };
  const auto play = [&](const PeakMap& map, std::size_t first, std::span<PeakMap::Cell> cells) {
    std::vector<BodyMotion> motions;
    for (std::size_t k = 0; k < cells.size(); ++k) motions.push_back(motion(map, map.place(first + k)));
    constexpr double kAny = std::numeric_limits<double>::infinity();
    const std::vector<BodyLanding> landings = landings_of(scene, motions, kAny, options.map.monitor);
    for (std::size_t k = 0; k < cells.size(); ++k) cells[k] = cell_of(landings[k], worth(scene, landings[k]));
  };
  BodySurvey out{mapped([&] { return map_peaks(space.variables(), options.map, play); }), given, {}, {}};
  std::vector<std::size_t> minima = local_minima(out.map);
  minima.resize(std::min(minima.size(), std::size_t(options.map.polished)));
  for (const std::size_t i : minima) out.minima.push_back({motion(out.map, out.map.place(i)), out.map.grid[i].peak});
  MapOptions basin_options = options.map;
  basin_options.monitor = options.basins;
  const auto descend = [&](const PeakMap::Place& cell, std::uint64_t n) {
    return descend_from(scene, space, space.unit(out.map.values(cell)), basin_options, n);
  };
  const std::vector<BodyDrop> box = execution_drops(scene);
  for (const Candidate& p : distinct_basins(out.map, basin_options, descend)) {
    const BodyMotion m = space.motion(p.u);
    const std::vector<double> peaks = peaks_over(box, m, kSearchAccuracy, basin_options.threads).peaks;
    out.basins.push_back({m, p.value, *std::max_element(peaks.begin(), peaks.end())});
  }
  return out;
}

}  // namespace ukemi::landing
