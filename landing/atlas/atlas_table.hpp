// An atlas that is opened for a robot: which of its drops are around another, and which of their motions is the best
// there.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "landing/atlas/atlas_file.hpp"
#include "landing/search/objective.hpp"

namespace ukemi::landing {

class AtlasTable {
 public:
  static constexpr std::size_t kCorners = std::size_t(1) << AtlasGrid::kAxes;
  /// Drops of the grid.
  struct Drops {
    std::array<std::size_t, kCorners> index{};
    std::size_t count = 0;
    std::span<const std::size_t> span() const { return {index.data(), count}; }
  };
  /// Motions of the table at the drop at hand, the best first.
  struct Found {
    std::array<Candidate, kCorners> points;
    std::array<std::size_t, kCorners> drop{};  ///< for which each was planned
    std::size_t count = 0;
    std::uint64_t best_drop() const { return count > 0 ? drop[0] : SafestMotion::kNoDrop; }
  };

  /// Opens the file. Throws InputError for what is no whole atlas, and where it was planned for other motions or on
  /// another robot (AtlasRobot::checksum).
  AtlasTable(const std::string& path, Goal goal, double deadline, const std::vector<Variable>& variables,
             const std::string& robot);
  const AtlasHeader& header() const { return file_.header(); }
  /// The corners of the grid's cell that holds a drop; none where none does. A vertical speed counts as the height that
  /// makes it at an acceleration g [m/s^2], a pitch rate as the pitch that it makes until the floor, `fall` later [s].
  Drops around(const Drop& drop, double g, double fall) const;
  /// The motion that is the safest; none where there is none.
  Drops safest() const;

  /// Evaluates by peaks all motions of the drops first; then, where the goal asks for more, one after the other, the
  /// best first. `unit(values)`: a motion's place; `evaluate(points, goal)`: as Objective::evaluate. Allocates nothing.
  template <class Unit, class Evaluate>
  Found best_of(std::span<const std::size_t> drops, Goal goal, Unit&& unit, Evaluate&& evaluate) const {
    Found out;
    for (const std::size_t i : drops) {
      const AtlasCell& cell = file_.cells()[i];
      if (!cell.planned()) continue;
      out.points[out.count].u = unit(cell.coordinates(int(header().variables)));
      out.drop[out.count++] = i;
    }
    if (out.count == 0) return out;
    evaluate(std::span(out.points).first(out.count), Goal::kPeak);
    sort(out);
    if (goal != Goal::kTolerant) return out;
    std::size_t best = 0;
    double bound = kNoMotion;
    for (std::size_t k = 0; k < out.count; ++k) {
      Candidate& p = out.points[k];
      if (p.value >= bound) continue;  // its peak alone is worse
      p.bound = bound;
      evaluate(std::span(&p, 1), Goal::kTolerant);
      if (p.value < bound) bound = p.value, best = k;
    }
    out.points[best].value = bound;
    std::rotate(out.points.begin(), out.points.begin() + long(best), out.points.begin() + long(best) + 1);
    std::rotate(out.drop.begin(), out.drop.begin() + long(best), out.drop.begin() + long(best) + 1);
    return out;
  }

 private:
  static void sort(Found& found);

  MappedAtlas file_;
};

}  // namespace ukemi::landing
