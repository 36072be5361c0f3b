// An atlas opened for a robot: the drops of the grid around another drop, and the ranking of their motions there.
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
  /// Motions of the table in the current drop, the best first.
  struct Ranking {
    std::array<Candidate, kCorners + 1> points;
    std::array<std::uint64_t, kCorners + 1> drop{};  ///< for which each was planned; kNoDrop: it holds the posture
    std::size_t count = 0;
    bool holds(std::size_t k) const { return drop[k] == SafestMotion::kNoDrop; }
    void add(const Coordinates& u, std::uint64_t planned_for) { points[count].u = u, drop[count++] = planned_for; }
    /// Moves element k forward to index `to`; those between move back.
    void move_forward(std::size_t k, std::size_t to) {
      const auto rotate = [&](auto& a) {
        std::rotate(a.begin() + long(to), a.begin() + long(k), a.begin() + long(k) + 1);
      };
      rotate(points), rotate(drop);
    }
  };

  /// Opens the file. Throws InputError for an incomplete atlas, other motions or another robot (AtlasRobot::checksum).
  AtlasTable(const std::string& path, Goal goal, double deadline, const std::vector<Variable>& variables,
             const std::string& robot);
  const AtlasHeader& header() const { return file_.header(); }
  /// The corners of the grid's cell that contains a drop; none outside of the grid. A vertical speed is converted to
  /// height at an acceleration g [m/s^2], a pitch rate to pitch at touchdown, after `fall` [s].
  Drops around(const Drop& drop, double g, double fall) const;
  /// The drop of the safest motion; none where there is no such motion.
  Drops safest() const;

  /// Evaluates the peaks of all motions of the drops, and of `hold`, which holds the posture; then, for the tolerant
  /// peak, one after the other, the best first and `hold` second, as time may run out. `unit(values)`: a motion's point
  /// of the unit cube; `evaluate(points, goal)`: as Objective::evaluate. Allocates nothing.
  template <class Unit, class Evaluate>
  Ranking best_of(std::span<const std::size_t> drops, const Coordinates& hold, Goal goal, Unit&& unit,
                  Evaluate&& evaluate) const {
    Ranking out;
    for (const std::size_t i : drops) {
      const AtlasCell& cell = file_.cells()[i];
      if (!cell.planned()) continue;
      out.add(unit(cell.coordinates(int(header().variables))), i);
    }
    if (out.count == 0) return out;
    out.add(hold, SafestMotion::kNoDrop);
    evaluate(std::span(out.points).first(out.count), Goal::kPeak);
    sort(out);
    if (goal != Goal::kTolerant) return out;
    for (std::size_t k = 2; k < out.count; ++k)
      if (out.holds(k)) out.move_forward(k, 1);
    std::size_t best = 0;
    double bound = kNoMotion;
    for (std::size_t k = 0; k < out.count; ++k) {
      Candidate& p = out.points[k];
      if (p.value >= bound) continue;  // already its peak is worse
      p.bound = bound;
      evaluate(std::span(&p, 1), Goal::kTolerant);
      if (p.value < bound) bound = p.value, best = k;
    }
    out.points[best].value = bound;
    out.move_forward(best, 0);
    return out;
  }

 private:
  static void sort(Ranking& ranking);

  MappedAtlas file_;
};

}  // namespace ukemi::landing
