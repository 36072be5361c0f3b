// What runs in the lanes of batch.hpp and body_batch.hpp.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <span>

namespace ukemi::landing {

/// What runs in a lane next, decided as the lanes become free. Lanes do not influence each other's results: a source
/// that gives each lane work of its own gets the same results whatever the number of lanes.
template <class Case, class Result>
class LaneSource {
 public:
  virtual ~LaneSource() = default;
  /// The lane's next landing; false if there is none (it is then not asked again).
  virtual bool next(int lane, Case& c) = 0;
  /// The lane's landing has ended.
  virtual void done(int lane, const Result& result) = 0;
  /// Asked every few dozen steps: true ends the run, and the landings under way are not reported.
  virtual bool over() { return false; }
};

/// Largest number of lanes of any machine.
inline constexpr int kMostLanes = 8;

/// Cases in their order, to whichever lane of whichever thread is free.
template <class Case, class Result>
class CaseQueue : public LaneSource<Case, Result> {
 public:
  /// `next` counts over all threads.
  CaseQueue(std::span<const Case> cases, std::span<Result> results, std::atomic<std::size_t>& next,
            const std::function<bool()>* over)
      : cases_(cases), results_(results), next_(next), over_(over) {}
  bool next(int lane, Case& c) override {
    const std::size_t i = in_lane_[std::size_t(lane)] = next_++;
    if (i >= cases_.size() || over()) return false;
    c = cases_[i];
    return true;
  }
  void done(int lane, const Result& result) override { results_[in_lane_[std::size_t(lane)]] = result; }
  bool over() override { return over_ && (*over_)(); }

 private:
  std::span<const Case> cases_;
  std::span<Result> results_;
  std::atomic<std::size_t>& next_;
  const std::function<bool()>* over_;
  std::array<std::size_t, kMostLanes> in_lane_{};
};

}  // namespace ukemi::landing
