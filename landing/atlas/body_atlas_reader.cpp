#include "landing/atlas/body_atlas_reader.hpp"

#include "common/error.hpp"
#include "common/stopwatch.hpp"
#include "landing/atlas/atlas_table.hpp"
#include "landing/atlas/body_atlas.hpp"
#include "landing/plan/body_fall.hpp"
#include "landing/plan/body_goal.hpp"

namespace ukemi::landing {

struct BodyAtlasReader::Table {
  Table(const std::string& path, const BodyScene& s, const AtlasReaderOptions& o)
      : scene(s), options(o), atlas(path, o.goal, o.deadline, BodySpace(s).variables(), robot_checksum(s)) {}
  BodyAtlasEntry best_of(const BodyScene& here, std::span<const std::size_t> drops, const Stopwatch& watch) const;
  BodyAtlasEntry at(const BodyScene& here, const Stopwatch& watch) const;

  BodyScene scene;
  AtlasReaderOptions options;
  AtlasTable atlas;
};

/// A motion that was planned without a move in the air gets the longest one possible.
BodyAtlasEntry BodyAtlasReader::Table::best_of(const BodyScene& here, std::span<const std::size_t> drops,
                                               const Stopwatch& watch) const {
  const BodySpace space(here);
  const auto motion = [&](const Coordinates& u) { return u.size() == 0 ? held_posture(here) : space.motion(u); };
  const std::function<bool()> over = [&] { return watch.seconds() > options.deadline; };
  const auto evaluate = [&](std::span<Candidate> points, Goal goal) {
    const BodyGoal body_goal = goal == Goal::kTolerant ? execution_box(here, true) : nominal_drop(here);
    std::vector<Valuation> played;
    for (const Candidate& p : points) played.emplace_back(body_goal, motion(p.u), p.bound);
    play(played, here.robot, options.accuracy, 1, &over);
    for (std::size_t k = 0; k < points.size(); ++k) points[k].value = played[k].value();
  };
  const auto unit = [&](const Coordinates& values) {
    if (space.dimension() == values.size()) return space.unit(values);
    const BodySpace planned(scene);  // without a move in the air
    return space.unit(planned.motion(planned.unit(values)));
  };
  const AtlasTable::Ranking found = atlas.best_of(drops, {}, options.goal, unit, evaluate);
  BodyAtlasEntry out;
  if (found.count == 0) return out;
  for (std::size_t k = 0; k < found.count; ++k)
    if (!found.holds(k)) out.starts.push_back(motion(found.points[k].u));
  out.motion = motion(found.points[0].u), out.value = found.points[0].value;
  out.drop = found.drop[0], out.holds = found.holds(0), out.inside = out.found = true;
  return out;
}

BodyAtlasEntry BodyAtlasReader::Table::at(const BodyScene& here, const Stopwatch& watch) const {
  try {
    here.validate();
    const double g = fall_acceleration(here.robot), fall = here.drop.pitch_rate != 0 ? fall_time(here) : 0;
    if (BodyAtlasEntry entry = best_of(here, atlas.around(here.drop, g, fall).span(), watch); entry.found) return entry;
    BodyAtlasEntry entry = best_of(here, atlas.safest().span(), watch);
    entry.inside = false;
    return entry;
  } catch (const InputError& e) {  // e.g. a vertical speed of a base that does not fall
    return {.wrong = e.what()};
  }
}

BodyAtlasReader::BodyAtlasReader(const std::string& path, const BodyScene& scene, const AtlasReaderOptions& options)
    : table_(std::make_unique<Table>(path, scene, options)) {}
BodyAtlasReader::~BodyAtlasReader() = default;

BodyAtlasEntry BodyAtlasReader::at(const Drop& drop) {
  const Stopwatch watch(Stopwatch::Time::kWall);
  if (const char* wrong = fault_of(drop)) return {.wrong = wrong};
  BodyScene here = table_->scene;
  here.drop = drop;
  return table_->at(here, watch);
}

BodyAtlasEntry BodyAtlasReader::at(const BodyFallState& state) {
  const Stopwatch watch(Stopwatch::Time::kWall);
  const BodyScene& scene = table_->scene;
  const BodyScene here = falling(scene, state, table_->options.deadline);
  if (std::string wrong = fault_of(state, scene.robot.joints.size()); !wrong.empty())
    return {.wrong = std::move(wrong)};
  if (const char* wrong = fault_of(here.drop)) return {.wrong = wrong};
  return table_->at(here, watch);
}

}  // namespace ukemi::landing
