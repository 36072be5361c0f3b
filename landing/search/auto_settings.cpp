#include "landing/search/auto_settings.hpp"

#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

const std::vector<AutoSetting>& auto_settings() {
  using S = AutoSettings;
  static const std::vector<AutoSetting> kAll = {
      {"leads", &S::leads, 1, 16, "scouts follow so many of the best motions at once"},
      {"lead_apart", &S::lead_apart, 0, 1, "leads are further apart, in parts of the box"},
      {"first", &S::first, 16, 4096, "scouts that go anywhere before any follows a lead"},
      {"anywhere", &S::anywhere, 0, 1, "share of the next scouts that goes anywhere"},
      {"early", &S::early, 0, 1e6, "motions until `later` counts and no longer `anywhere`"},
      {"later", &S::later, 0, 1, "share of the scouts that goes anywhere after `early`"},
      {"near", &S::near, 0, 8, "scouts stand beside a lead by 10^-near of the box at most"},
      {"by", &S::by, 0, 8, "and by 10^-by at least, at first"},
      {"at_last", &S::at_last, 0, 8, "and by 10^-at_last at least when the scouts are spent"},
      {"scouting", &S::scouting, 0, 1, "share of the budget that scouts may take"},
      {"few", &S::few, 16, 1e6, "motions that scouts have in any case"},
      {"many", &S::many, 16, 1e6, "motions that scouts have at most"},
      {"best_scouts", &S::best_scouts, 6, 64, "the best scouts are the first population"},
      {"scouts_apart", &S::scouts_apart, 0, 1, "so far apart, in parts of the box"},
      {"smallest", &S::smallest, 6, 64, "size of the second population; every restart has one more"},
      {"largest", &S::largest, 6, 128, "and at most so many"},
      {"race", &S::race, 1, 1000, "motions that race for a place in a population"},
      {"race_share", &S::race_share, 0, 1, "share of the budget that one race may take"},
      {"first_share", &S::first_share, 0, 1, "and the one before the scouts of tolerant peaks"},
      {"screen", &S::screen, 1, 5000, "motions a place that are screened by the peak alone, for tolerant peaks"},
      {"converged", &S::converged, 1e-12, 1, "side of a population that has found its basin, in parts of the box"},
      {"apart", &S::apart, 0, 1, "basins are further apart, in parts of the box"},
      {"trial_period", &S::trial_period, 0, 1000, "generations that every population has"},
      {"behind", &S::behind, 1, 10, "a population is given up where its best is this much worse than the best of all"},
      {"finest", &S::finest, 1e-14, 1, "side of a population where nothing is left to find"},
      {"global", &S::global, 0, 1000, "populations that start anywhere"},
      {"close", &S::close, 0, 1, "share of the later ones that starts about a basin"},
      {"side", &S::side, 0, 1, "in a box of this side"},
      {"nearly", &S::nearly, 1, 10, "about a basin that is at most this much worse than the best"},
      {"refinement", &S::refinement, 1, 1000,
       "populations until the best basin is searched once more; then four times as many"},
      {"late", &S::late, 0, 1, "share of the budget after which it is searched for the last time"},
      {"batch", &S::batch, 1, 64, "motions that are evaluated at once"},
      {"basins", &S::basins, 1, 4096, "basins that are remembered"},
      {"wide_scouts", &S::wide_scouts, 32, 1e6,
       "over three variables: scouts at most; of cma: motions from anywhere before the first run"},
      {"wide_race", &S::wide_race, 32, 1e6, "motions from anywhere before a later run; the best is its start"},
      {"wide_points", &S::wide_points, 6, 64, "motions of a generation"},
      {"wide_size", &S::wide_size, 1e-6, 1, "standard deviation of a run's first generation, in parts of the box"},
      {"wide_near", &S::wide_near, 0, 1, "share of the later runs that start beside a basin"},
      {"wide_bound", &S::wide_bound, 1, 100,
       "a motion is left where it is worse by this than the last generation's middle"},
      {"wide_behind", &S::wide_behind, 1, 100, "a run is given up where it is worse than the best by this, at first"},
      {"wide_patience", &S::wide_patience, 0.5, 1, "what of that is left after each generation"},
      {"wide_plain", &S::wide_plain, 0, 1,
       "share of the motions from anywhere that do without shape terms and with the drive's own gains"},
      {"wide_screen", &S::wide_screen, 0, 1,
       "for tolerant peaks: share of the budget that looks for basins of the peak"},
      {"wide_poor", &S::wide_poor, 1e-12, 1, "side at which a run has converged that is not the best"},
      {"robust_few", &S::robust_few, 1, 1024, "under scatter: drops that first runs are made over, for the mean"},
      {"robust_tail", &S::robust_tail, 1, 64, "times as many for another measure"},
      {"robust_scouts", &S::robust_scouts, 32, 1e6, "motions from anywhere before a run"},
      {"robust_scouting", &S::robust_scouting, 0, 1, "and at most this share of the budget"},
      {"robust_starts", &S::robust_starts, 1, 64,
       "the best of them, by the planned drop, that are judged by few drops"},
      {"robust_points", &S::robust_points, 6, 64, "motions of a generation"},
      {"robust_size", &S::robust_size, 1e-6, 1, "standard deviation of its first generation, in parts of the box"},
      {"robust_near", &S::robust_near, 0, 1, "share of the later runs that start beside a basin"},
      {"robust_behind", &S::robust_behind, 0, 100,
       "a run is given up where it is worse than the best by this, at first"},
      {"robust_patience", &S::robust_patience, 0.5, 1, "what of that is left after each generation"},
      {"robust_late", &S::robust_late, 0, 1, "share of the budget after which all drops are played"},
      {"robust_basins", &S::robust_basins, 1, 24, "basins that are compared then"},
      {"robust_fine", &S::robust_fine, 1e-6, 1, "standard deviation of the runs from the best of them"},
      {"robust_hint", &S::robust_hint, 1e-6, 1, "standard deviation of the run from a place that was given"}};
  return kAll;
}

double AutoSetting::value_in(const AutoSettings& settings) const {
  return std::visit([&](auto m) { return double(settings.*m); }, member);
}

void AutoSettings::validate() const {
  for (const AutoSetting& s : auto_settings())
    if (const double v = s.value_in(*this); !(v >= s.lower && v <= s.upper))
      throw InputError("setting " + s.name + ": " + shortest(v) + ": " + shortest(s.lower) + " to " +
                       shortest(s.upper) + " is needed: " + s.meaning);
  if (wide_points % 2 || robust_points % 2)
    throw InputError("setting wide_points, robust_points: an even number is needed");
  if (best_scouts > largest) throw InputError("setting best_scouts: at most `largest` is needed");
}

void AutoSettings::set(const std::string& name, double value) {
  std::vector<std::string> names;
  for (const AutoSetting& s : auto_settings()) {
    names.push_back(s.name);
    if (s.name != name) continue;
    std::visit([&](auto m) { this->*m = std::decay_t<decltype(this->*m)>(value); }, s.member);
    return validate();
  }
  throw InputError("setting: " + one_of(name, names));
}

}  // namespace ukemi::landing
