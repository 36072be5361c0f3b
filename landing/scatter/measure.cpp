#include "landing/scatter/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double mean_of(std::span<const double> x) { return std::accumulate(x.begin(), x.end(), 0.0) / double(x.size()); }

/// The mean of the largest `count` numbers, a fractional count including part of the last.
double mean_of_largest(std::span<double> x, double count) {
  const auto whole = std::size_t(count);
  const auto n = std::min(whole + 1, x.size());
  std::partial_sort(x.begin(), x.begin() + long(n), x.end(), std::greater<>());
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += std::min(1.0, count - double(i)) * x[i];
  return sum / count;
}

/// The smallest number that a share `level` of all does not exceed.
double quantile_of(std::span<double> x, double level) {
  const double rank = std::ceil(level * double(x.size()) - 1e-9);
  const auto k = std::size_t(std::clamp(rank - 1, 0.0, double(x.size() - 1)));
  std::nth_element(x.begin(), x.begin() + long(k), x.end());
  return x[k];
}

}  // namespace

void Measure::validate() const {
  if ((kind == Kind::kCvar || kind == Kind::kQuantile) && !(level > 0 && level < 1))
    throw InputError("measure: level " + shortest(level) + ": a number between 0 and 1 is needed");
}

double Measure::of(std::span<double> peaks) const {
  validate();
  if (peaks.empty()) return kNaN;
  switch (kind) {
    case Kind::kMean:
      return mean_of(peaks);
    case Kind::kCvar:
      return mean_of_largest(peaks, (1 - level) * double(peaks.size()));
    case Kind::kQuantile:
      return quantile_of(peaks, level);
    case Kind::kWorst:
      return *std::max_element(peaks.begin(), peaks.end());
  }
  return kNaN;
}

Measure Measure::parse(const std::string& option, const std::string& text) {
  if (text == "mean") return {Kind::kMean};
  if (text == "cvar") return {Kind::kCvar};
  if (text == "worst") return {Kind::kWorst};
  constexpr const char* kPrefix = "quantile:";
  if (text.starts_with(kPrefix)) {
    const std::string number = text.substr(std::string(kPrefix).size());
    char* end = nullptr;
    const double q = std::strtod(number.c_str(), &end);
    if (!number.empty() && *end == 0 && q > 0 && q < 1) return {Kind::kQuantile, q};
    throw InputError(fmt::format("{}: {}: a number between 0 and 1 is needed behind quantile:", option, quoted(text)));
  }
  throw InputError(fmt::format("{}: {}", option, one_of(text, {"mean", "cvar", "quantile:0.9", "worst"})));
}

std::string Measure::name() const {
  switch (kind) {
    case Kind::kMean:
      return "mean";
    case Kind::kCvar:
      return "cvar";
    case Kind::kQuantile:
      return "quantile:" + shortest(level);
    case Kind::kWorst:
      return "worst";
  }
  return "";
}

Estimated estimated(const Measure& measure, std::span<const double> peaks) {
  measure.validate();
  std::vector<double> x(peaks.begin(), peaks.end());
  const double n = double(x.size());
  if (x.size() < 2) return {measure.of(x), kNaN};
  const auto spread = [&](double about) {  // standard deviation of the mean
    double sum = 0;
    for (const double v : x) sum += (v - about) * (v - about);
    return std::sqrt(sum / (n - 1) / n);
  };
  const double value = measure.of(x);
  switch (measure.kind) {
    case Measure::Kind::kMean:
      return {value, spread(value)};
    case Measure::Kind::kCvar: {  // the mean of q + (x - q)+ / (1 - level): its influence function
      const double q = quantile_of(x, measure.level);
      for (double& v : x) v = q + std::max(0.0, v - q) / (1 - measure.level);
      return {value, spread(mean_of(x))};
    }
    case Measure::Kind::kQuantile: {  // half of what a standard error of the rank spans (Woodruff 1952)
      const double error = std::sqrt(measure.level * (1 - measure.level) / n);
      const double low = quantile_of(x, std::max(1 / n, measure.level - error)),
                   high = quantile_of(x, std::min(1.0, measure.level + error));
      return {value, 0.5 * (high - low)};
    }
    case Measure::Kind::kWorst:
      return {value, kNaN};
  }
  return {value, kNaN};
}

Distribution distribution(std::span<const double> peaks) {
  std::vector<double> x(peaks.begin(), peaks.end());
  if (x.empty()) {
    constexpr Estimated kUnknown{kNaN, kNaN};
    return {kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kNaN, 0};
  }
  using Kind = Measure::Kind;
  return {.mean = estimated({Kind::kMean}, peaks),
          .cvar90 = estimated({Kind::kCvar, 0.9}, peaks),
          .median = estimated({Kind::kQuantile, 0.5}, peaks),
          .q90 = estimated({Kind::kQuantile, 0.9}, peaks),
          .q99 = estimated({Kind::kQuantile, 0.99}, peaks),
          .max = *std::max_element(x.begin(), x.end()),
          .samples = long(x.size())};
}

std::vector<PeakBin> histogram(std::span<const double> peaks, std::span<const double> beside, double q99) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const auto& all : {peaks, beside})
    for (const double x : all) check_finite("peak", x), low = std::min(low, x), high = std::max(high, x);
  std::vector<PeakBin> out;
  if (!(high > 0)) return out;
  if (!peaks.empty()) check_finite("q99", q99);
  const double range = peaks.empty() ? 0 : q99 - *std::min_element(peaks.begin(), peaks.end());
  const double width = std::exp2(std::ceil(std::log2(std::max({range / 64, (high - low) / 512, 1e-5 * high}))));
  const double start = std::floor(low / width);
  for (double k = start; k * width <= high; ++k) out.push_back({k * width, (k + 1) * width});
  const auto bin = [&](double x) -> PeakBin& { return out[std::size_t(std::floor(x / width) - start)]; };
  for (const double x : peaks) ++bin(x).drops;
  for (const double x : beside) ++bin(x).beside;
  return out;
}

}  // namespace ukemi::landing
