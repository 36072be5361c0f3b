#include "landing/plan/trade_journal.hpp"

#include <cstring>

#include "landing/model/motion.hpp"

namespace ukemi::landing {

namespace {

// A record is a row of doubles: design, plans, held, planned, peak, edges, whether there is a motion, and of each joint
// its move in the air (whether, phi, rate, from) and motion_numbers.

std::vector<double> row_of(std::size_t design, const TradePoint& p, std::size_t joints) {
  std::vector<double> row{double(design), double(p.plans), p.held, p.planned, p.peak};
  row.insert(row.end(), p.edges.begin(), p.edges.end());
  row.push_back(p.found());
  for (std::size_t j = 0; j < joints; ++j) {
    Motion m = p.found() ? p.motion[j] : Motion{};
    const Reposition moves = m.reposition.value_or(Reposition{});
    row.insert(row.end(), {double(m.reposition.has_value()), moves.phi, moves.rate, moves.from});
    double unused = 0;
    for (const double* x : motion_numbers(m, unused)) row.push_back(*x);
  }
  return row;
}

std::size_t design_of(const std::vector<double>& row) { return std::size_t(row[0]); }

TradePoint point_of(const std::vector<double>& row, std::size_t joints) {
  auto next = row.begin() + 1;
  TradePoint p;
  p.plans = int(*next++), p.held = *next++, p.planned = *next++, p.peak = *next++;
  for (auto& edge : p.edges) edge = static_cast<signed char>(*next++);
  if (*next++ == 0) return p;
  for (Motion& m : p.motion = BodyMotion(joints)) {
    if (*next++ != 0) m.reposition = {.phi = next[0], .rate = next[1], .from = next[2]};
    next += 3;
    double unused = 0;
    for (double* x : motion_numbers(m, unused)) *x = *next++;
  }
  return p;
}

std::size_t record_size(std::size_t joints) { return sizeof(double) * row_of(0, {}, joints).size(); }

}  // namespace

TradeJournal::TradeJournal(const std::string& path, const std::string& identity, std::size_t joints,
                           std::span<TradePoint> points)
    : joints_(joints),
      journal_(path, "ukemitr1" + identity, record_size(joints), "trade (scene, values, goal, effort or seed)") {
  std::vector<double> row(record_size(joints) / sizeof(double));
  for (const std::string& record : journal_.records()) {
    std::memcpy(row.data(), record.data(), record.size());
    if (design_of(row) < points.size()) points[design_of(row)] = point_of(row, joints);
  }
}

void TradeJournal::add(std::size_t design, const TradePoint& point) {
  const std::vector<double> row = row_of(design, point, joints_);
  journal_.add({reinterpret_cast<const char*>(row.data()), row.size() * sizeof(double)});
}

}  // namespace ukemi::landing
