#include "landing/model/motion_csv.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/csv.hpp"
#include "common/decompositions.hpp"
#include "landing/model/motion.hpp"

namespace ukemi::landing {

MotionRows rows_of(const Motion& m, double start, double rate) {
  MotionRows out;
  out.start = start, out.gain_p = m.gain_p, out.gain_d = m.gain_d, out.release_rate = m.release_rate();
  const auto row = [&](double t, const Reference<double>& r) {
    out.t.push_back(t), out.phi.push_back(r.phi), out.dphi.push_back(r.dphi);
  };
  if (moves_in_air(m, start)) {
    const double begin = m.reposition->from - start;
    row(begin, reference_before(m, m.reposition->from));
    for (long i = long(std::ceil(-begin * rate - 1e-9)) - 1; i > 0; --i)
      row(-double(i) / rate, reference_before(m, start - double(i) / rate));
  }
  const Motion played = started_at(m, start);
  const long rows = long(std::ceil(m.duration * rate - 1e-9));
  for (long i = 0; i <= rows; ++i) {
    const double t = std::min(double(i) / rate, m.duration);
    row(t, reference_of(played, t));
  }
  return out;
}

std::string to_csv(const MotionRows& r, const std::string& comments) {
  const bool gains = r.gain_p != 1 || r.gain_d != 1;
  CsvWriter csv;
  csv.comment(comments);
  csv.comment("Read with pandas.read_csv(file, comment=\"#\"); with numpy.genfromtxt leave these lines out.");
  csv.comment("t = 0 at the detected first touchdown; before it hold phi_ref of the first row. Units: s, rad, rad/s.");
  std::vector<std::string> names = {"t", "phi_ref", "dphi_ref"};
  if (r.moves_in_air()) {
    csv.comment(fmt::format(
        "Rows with t < 0 are the move in the air, by the clock: t = 0 is then the expected detection of the touchdown, "
        "{:.6f} s after release. The landing motion starts at the detected touchdown, from where the reference is.",
        r.start));
    names.emplace_back("t_from_release");
  }
  if (gains) {
    csv.comment(fmt::format("From t = 0 on K_p times {:.6g} and K_d times {:.6g}.", r.gain_p, r.gain_d));
    names.insert(names.end(), {"gain_p", "gain_d"});
  }
  if (r.release_rate != 0) {
    csv.comment("release_rate: of the joint at release, the same in every row [rad/s].");
    names.emplace_back("release_rate");
  }
  csv.header(names);
  for (std::size_t i = 0; i < r.t.size(); ++i) {
    csv.cell(r.t[i]).cell(r.phi[i]).cell(r.dphi[i]);
    if (r.moves_in_air()) csv.cell(r.start + r.t[i]);
    if (gains) csv.cell(r.t[i] < 0 ? 1 : r.gain_p).cell(r.t[i] < 0 ? 1 : r.gain_d);
    if (r.release_rate != 0) csv.cell(r.release_rate);
    csv.end_row();
  }
  return csv.text();
}

namespace {

/// Below this rate the reference counts as constant [rad/s].
constexpr double kStill = 1e-12;

/// Reads the rows of a file and recovers the motion. `zero` is the first row of the landing motion, `end` its last.
struct RowReader {
  CsvTable table;
  MotionRows rows;
  std::size_t zero = 0, end = 0;

  RowReader(const std::string& path, const std::string& joint);
  Motion motion() const;

 private:
  std::string suffix_;  ///< of a joint's columns

  /// Full name of a column; the columns of the clock are shared by all joints.
  std::string full_name(const std::string& name) const {
    return name == "t" || name == "t_from_release" ? name : name + suffix_;
  }
  int find(const std::string& name) const { return table.find(full_name(name)); }
  const std::vector<double>& column(const std::string& name) const;
  double constant(const std::string& name, std::size_t from) const;
  void read_clock();
  void read_gains();
  void require_rows(std::size_t from, std::size_t count, const char* piece) const;
  BumpsOf<double> bumps(const Motion& plain) const;
  std::size_t begin_of_move() const;
  double length_of_move(std::size_t first, std::size_t last) const;
  void fit_move(Motion& m) const;
  void check(const Motion& m) const;
  [[noreturn]] void fail(const char* name, std::size_t row, const std::string& message) const {
    throw InputError(table.at(table.require(full_name(name)), row),
                     fmt::format("column '{}': {}", full_name(name), message));
  }
};

const std::vector<double>& RowReader::column(const std::string& name) const {
  const int c = table.require(full_name(name));
  table.require_full(c);
  return table.columns[std::size_t(c)];
}

/// The value of a column that must be constant from a row on.
double RowReader::constant(const std::string& name, std::size_t from) const {
  const std::vector<double>& values = column(name);
  for (std::size_t i = from; i < values.size(); ++i)
    if (values[i] != values[from])
      fail(
          name.c_str(), i,
          fmt::format("{}: {} as in line {} is needed", shortest(values[i]), shortest(values[from]), table.line[from]));
  return values[from];
}

RowReader::RowReader(const std::string& path, const std::string& joint) : suffix_(joint.empty() ? "" : "_" + joint) {
  std::vector<std::string> known = {"t", "phi_ref", "dphi_ref", "t_from_release", "gain_p", "gain_d", "release_rate"};
  for (std::string& name : known) name = full_name(name);
  table = read_csv(path, [&](auto& name) { return std::find(known.begin(), known.end(), name) != known.end(); });
  rows.t = column("t"), rows.phi = column("phi_ref"), rows.dphi = column("dphi_ref");
  table.require_increasing(table.require("t"), rows.t);
  for (std::size_t i = 0; i < rows.phi.size(); ++i)
    if (std::abs(rows.phi[i]) > 2 * std::numbers::pi)
      fail("phi_ref", i, shortest(rows.phi[i]) + " rad: at most 2 pi either way is needed");
  while (zero < rows.t.size() && rows.t[zero] < 0) ++zero;
  if (zero == rows.t.size() || rows.t[zero] != 0)
    fail("t", std::min(zero, rows.t.size() - 1), "no row has t = 0: one at the start of the landing motion is needed");
  end = rows.t.size() - 1;
  while (end > zero && std::abs(rows.dphi[end - 1]) <= kStill && rows.phi[end - 1] == rows.phi.back()) --end;
  if (find("release_rate") >= 0) rows.release_rate = constant("release_rate", 0);
  read_gains();
  read_clock();
}

void RowReader::read_gains() {
  for (const auto& [name, to] : {std::pair{"gain_p", &rows.gain_p}, {"gain_d", &rows.gain_d}}) {
    if (find(name) < 0) continue;
    *to = constant(name, zero);
    if (*to < 0) fail(name, zero, shortest(*to) + ": at least 0 is needed");
    for (std::size_t i = 0; i < zero; ++i)
      if (const double before = column(name)[i]; before != 1)
        fail(name, i, shortest(before) + ": 1 is needed in the air, where t < 0");
  }
}

/// Reads the expected start of the landing motion, from release.
void RowReader::read_clock() {
  if (zero == 0) return;
  constexpr double kSame = 1e-9;  // [s]
  if (find("t_from_release") < 0)
    fail("t", 0, shortest(rows.t[0]) + ": a move in the air needs the column 't_from_release' too");
  const std::vector<double>& clock = column("t_from_release");
  rows.start = clock[0] - rows.t[0];
  if (clock[0] < 0) fail("t_from_release", 0, shortest(clock[0]) + ": at least 0 is needed");
  for (std::size_t i = 0; i < clock.size(); ++i)
    if (std::abs(clock[i] - rows.t[i] - rows.start) > kSame)
      fail("t_from_release", i,
           fmt::format("{}: t and {} s, as in the first row, is needed", shortest(clock[i]), shortest(rows.start)));
}

void RowReader::require_rows(std::size_t from, std::size_t count, const char* piece) const {
  if (count < kLeastRows)
    fail("t", from,
         fmt::format("{} row(s) inside the {}: at least {} are needed to recover it", count, piece, kLeastRows));
}

/// Least-squares fit of the shape terms to the quintic's residuals; none if it does not halve the largest residual.
BumpsOf<double> RowReader::bumps(const Motion& plain) const {
  const auto residual = [&](std::size_t i, const Motion& m) { return rows.phi[i] - reference_of(m, rows.t[i]).phi; };
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d rhs = Eigen::Vector4d::Zero(), shapes;
  for (std::size_t i = zero; i <= end; ++i) {
    for (std::size_t k = 0; k < kMaxBumps; ++k) {
      BumpsOf<double> unit{};
      unit[k] = 1;
      shapes[long(k)] = bumps_of(powers_of(unit), plain.duration, rows.t[i]).phi;
    }
    normal += shapes * shapes.transpose(), rhs += shapes * residual(i, plain);
  }
  const Eigen::Vector4d b = normal.ldlt().solve(rhs);
  Motion shaped = plain;
  for (std::size_t k = 0; k < kMaxBumps; ++k) shaped.bumps[k] = b[long(k)];
  double without = 0, with = 0;
  for (std::size_t i = zero; i <= end; ++i) {
    without = std::max(without, std::abs(residual(i, plain)));
    with = std::max(with, std::abs(residual(i, shaped)));
  }
  constexpr double kRounding = 1e-12;  // [rad]
  return without > 2 * with + kRounding ? shaped.bumps : plain.bumps;
}

/// The row where the move in the air begins: the last constant one at the start (another joint may move earlier).
std::size_t RowReader::begin_of_move() const {
  std::size_t i = 0;
  while (i + 1 < zero && rows.phi[i + 1] == rows.phi[0] && rows.dphi[i + 1] == 0) ++i;
  return i;
}

/// Duration of the move in the air from its rows: the least-squares fit of c_3 u^3 + c_4 u^4 + c_5 u^5; the quintic has
/// T = -3/2 c_3 / c_4 [s].
double RowReader::length_of_move(std::size_t first, std::size_t last) const {
  const double span = rows.t[last] - rows.t[first];
  Eigen::MatrixXd powers(last - first, 3);
  Eigen::VectorXd moved(powers.rows());
  for (std::size_t i = first + 1; i <= last; ++i) {
    const double x = (rows.t[i] - rows.t[first]) / span, x3 = x * x * x;
    const long k = long(i - first) - 1;
    powers.row(k) << x3, x3 * x, x3 * x * x;
    moved[k] = rows.phi[i] - rows.phi[0];
  }
  const Eigen::Vector3d c = LeastNorm(powers).solve(moved);
  return -1.5 * c[0] / c[1] * span;
}

/// phi_I and the end of the move in the air: Gauss-Newton fit of range q(u / T), u the time since the move began.
void RowReader::fit_move(Motion& m) const {
  const double phi = rows.phi[0];
  std::size_t first = 0, last = zero - 1;  // rows of the move
  while (last > 0 && std::abs(rows.dphi[last]) <= kStill) --last;
  if (last > 0) first = begin_of_move();
  const double from = rows.start + rows.t[first];
  m.reposition = Reposition{phi, rows.release_rate, from, rows.start};
  m.phi_i = phi;
  if (last == 0) {
    if (!suffix_.empty() && rows.release_rate == 0) m.reposition.reset();  // another joint moves
    return;
  }
  require_rows(first, last - first, "move in the air");
  double range = rows.phi[zero - 1] - phi, duration = length_of_move(first, last);
  if (!(duration > 0)) fail("phi_ref", 0, "the rows with t < 0 are no quintic from rest to rest");
  for (int step = 0; step < 20; ++step) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d rhs = Eigen::Vector2d::Zero();
    for (std::size_t i = first + 1; i < zero; ++i) {
      const double u = rows.t[i] - rows.t[first];
      const Reference<double> unit = u < duration ? quintic(0.0, 1.0, duration, u) : Reference<double>{1, 0};
      const Eigen::Vector2d gradient(unit.phi, -range * unit.dphi * u / duration);
      normal += gradient * gradient.transpose();
      rhs += gradient * (rows.phi[i] - phi - range * unit.phi);
    }
    const Eigen::Vector2d change = normal.ldlt().solve(rhs);
    range += change[0], duration = std::clamp(duration + change[1], duration / 2, duration * 2);
  }
  m.phi_i = phi + range, m.reposition->to = from + duration;
}

/// Throws InputError if a row deviates from the motion.
void RowReader::check(const Motion& m) const {
  const Motion landing = started_at(m, rows.start);
  const auto at = [&](std::size_t i) -> Reference<double> {
    if (i < zero) return reference_before(m, rows.start + rows.t[i]);
    return reference_of(landing, rows.t[i]);
  };
  const auto require = [&](const char* name, const std::vector<double>& given, double Reference<double>::*value,
                           double tolerance, const char* unit) {
    std::size_t worst = 0;
    double misfit = 0;
    for (std::size_t i = 0; i < given.size() && !std::isnan(misfit); ++i)
      if (const double deviation = std::abs(given[i] - at(i).*value); !(deviation <= misfit))
        misfit = deviation, worst = i;
    if (!(misfit <= tolerance))
      fail(name, worst,
           fmt::format("{}: {:.3g} {} from the nearest motion of quintic, shape terms and move in the air: at most {} "
                       "{} is needed",
                       shortest(given[worst]), misfit, unit, shortest(tolerance), unit));
  };
  require("phi_ref", rows.phi, &Reference<double>::phi, kAngleMisfit, "rad");
  require("dphi_ref", rows.dphi, &Reference<double>::dphi, kRateMisfit, "rad/s");
}

Motion RowReader::motion() const {
  const bool is_constant = end == zero;
  Motion m{rows.phi[zero], rows.phi[end], is_constant ? 1.0 : rows.t[end]};
  if (!is_constant) {
    require_rows(zero, end - zero - 1, "landing motion");
    m.bumps = bumps(m);
  }
  m.gain_p = rows.gain_p, m.gain_d = rows.gain_d;
  if (zero > 0)
    fit_move(m);
  else if (rows.release_rate != 0)
    m.reposition = Reposition{m.phi_i, rows.release_rate, 0, 1};
  check(m);
  return m;
}

}  // namespace

Motion read_motion_csv(const std::string& path, const std::string& joint) { return RowReader(path, joint).motion(); }

}  // namespace ukemi::landing
