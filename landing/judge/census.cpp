#include "landing/judge/census.hpp"

#include <algorithm>
#include <cmath>

#include "landing/scatter/sampler.hpp"
#include "landing/scatter/sobol.hpp"

namespace ukemi::landing {

bool PeakCensus::count(double peak, std::vector<double>& peaks, long& failed) {
  const bool followed = std::isfinite(peak);
  if (followed)
    peaks.push_back(peak);
  else
    ++failed;
  return followed;
}

void PeakCensus::report(PeakRisk& out) const {
  out.peaks = distribution(peaks_), out.held = distribution(held_);
  out.failed = failed_, out.held_failed = held_failed_;
  for (const auto& [contact, drops] : contacts_) out.contacts.push_back({contact.first, contact.second, drops});
  std::stable_sort(out.contacts.begin(), out.contacts.end(), [](auto& a, auto& b) { return a.drops > b.drops; });
  out.histogram = histogram(peaks_, held_, out.peaks.q99.value);
}

void WorstDrops::sort() {
  const auto kept = std::min(drops_.size(), std::size_t(Risk::kWorst));
  std::partial_sort(drops_.begin(), drops_.begin() + long(kept), drops_.end(),
                    [](auto& a, auto& b) { return std::pair(-a.first, a.second) < std::pair(-b.first, b.second); });
  drops_.resize(kept);
}

IndexPlan::IndexPlan(const Sampler& sampler, long samples) : sampler_(&sampler) {
  if (samples > 0 && sampler.groups().size() > 1)
    n_ = std::max(2L, std::lround(std::exp2(std::round(std::log2(double(samples) / double(blocks()))))));
}
std::vector<double> IndexPlan::points(long count, std::uint64_t seed, long first) const {
  const auto d = std::size_t(sampler_->dimension());
  const std::vector<double> both = ScrambledSobol(2 * int(d), seed).points(count, first);
  std::vector<double> out;
  out.reserve(std::size_t(count) * blocks() * d);
  for (std::size_t block = 0; block < blocks(); ++block)
    for (std::size_t i = 0; i < both.size(); i += 2 * d) {
      const auto a = both.begin() + long(i), b = a + long(d);
      out.insert(out.end(), block == 1 ? b : a, (block == 1 ? b : a) + long(d));
      if (block < 2) continue;
      const ScatterGroup& g = sampler_->groups()[block - 2];
      std::copy_n(b + g.first, g.count, out.end() - long(d) + g.first);
    }
  return out;
}

PeakRisk::WhyNone IndexPlan::why_none(bool stopped) const {
  using enum PeakRisk::WhyNone;
  const std::size_t groups = sampler_->groups().size();
  return groups == 0 ? kNothingScatters : groups == 1 ? kOneGroup : stopped ? kStopped : kThere;
}

void IndexPlan::compute(PeakRisk& out, long chunk, std::uint64_t seed, int threads, const Peaks& play) const {
  std::vector<std::vector<double>> values(blocks());
  long failed = 0;
  const long part = std::max(1L, chunk / long(blocks()));
  for (long first = 0; first < n_; first += part) {
    const long count = std::min(part, n_ - first);
    const auto peaks = play(points(count, seed, first), count * long(blocks()));
    if (!peaks) {
      out.why_none = PeakRisk::WhyNone::kStopped;
      return;
    }
    for (std::size_t i = 0; i < peaks->size(); ++i) {
      values[i / std::size_t(count)].push_back((*peaks)[i]);
      failed += !std::isfinite((*peaks)[i]);
    }
  }
  out.index_landings = landings(), out.index_failed = failed;
  const auto indices = sobol_indices(values[0], values[1], std::span(values).subspan(2), seed, threads);
  for (std::size_t g = 0; g < indices.size(); ++g)
    out.uncertainties.push_back({sampler_->groups()[g].name, indices[g]});
  std::stable_sort(out.uncertainties.begin(), out.uncertainties.end(),
                   [](auto& a, auto& b) { return a.index.total.value > b.index.total.value; });
}

}  // namespace ukemi::landing
