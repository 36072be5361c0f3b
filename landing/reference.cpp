#include "landing/reference.hpp"

#include <numbers>
#include <sstream>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/files.hpp"

namespace ukemi::landing {

std::vector<ReferenceCase> read_reference(const std::string& folder) {
  constexpr double kDegree = std::numbers::pi / 180;
  const CsvTable table = read_csv(folder + "/landing_cases.csv", [](const std::string& name) { return name != "id"; });
  std::istringstream peaks(read_text_file(folder + "/landing_peaks.csv", 1 << 24));
  std::string line;
  std::getline(peaks, line);
  std::vector<ReferenceCase> out;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto value = [&](const char* name) { return table.columns[table.find(name)][row]; };
    ReferenceCase c;
    c.scene.name = "reference";
    c.scene.robot = {{value("m0"), value("m1")}, {value("I0"), value("I1")}, value("l"), value("g")};
    c.scene.contacts = {true, true, true};
    c.scene.floor = Floor<double>{value("K_f"), value("C_fy"), value("C_fx")};
    c.scene.drop = {value("height"), value("forward_speed"), value("pitch_deg") * kDegree, 0};
    c.scene.t_end = value("t_end");
    c.sea = {value("k_p"), value("k_d"), value("k_sea"), value("c_sea"), value("i_motor"), value("tau_max")};
    c.motion = {value("phi_i_deg") * kDegree, value("phi_f_deg") * kDegree, value("duration")};
    if (!std::getline(peaks, line)) throw InputError(folder + "/landing_peaks.csv: fewer rows than landing_cases.csv");
    std::istringstream cells(line);
    std::string peak, t_peak, times;
    for (std::string* cell : {&c.id, &peak, &t_peak, &c.order, &times}) std::getline(cells, *cell, ',');
    c.peak = std::stod(peak), c.t_peak = std::stod(t_peak);
    std::istringstream list(times);
    for (std::string t; std::getline(list, t, ';');) c.touchdowns.push_back(std::stod(t));
    out.push_back(c);
  }
  return out;
}

}  // namespace ukemi::landing
