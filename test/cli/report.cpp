// Reports: figures as files, without gnuplot, thinned so that no peak is lost, and names that are shown and never run.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const Arguments kHold = {"simulate", kPaper, "--actuator", kTable2, "--hold", "-45", "-o", "out"};

/// The landings that a page animates.
Json landings(const std::string& page) {
  const std::string begin = "id=\"landings\">";
  const std::size_t from = page.find(begin) + begin.size();
  return Json::parse(page.substr(from, page.find("</script>", from) - from))["landings"];
}

}  // namespace

TEST_CASE("report: figures as files of their own, each named by the summary") {
  const Folder f;
  done(f, kHold + Arguments{"--figures", "svg,pdf,png"});
  const Json files = summary(f)["files"];
  const auto listed = [&](const std::string& name) {
    return std::find(files.begin(), files.end(), name) != files.end();
  };
  const std::pair<std::string, std::string> kinds[] = {{".svg", "<?xml"}, {".pdf", "%PDF"}, {".png", "\x89PNG"}};
  for (const std::string figure :
       {"fall", "postures", "acceleration", "components", "joint", "torque", "speed", "energy"})
    for (const auto& [ending, first] : kinds) {
      INFO(figure << ending);
      CHECK(listed(figure + ending));
      CHECK(read(f.at("out/" + figure + ending)).rfind(first, 0) == 0);
    }
  // A file that leaves the folder says where it comes from.
  const std::string command = summary(f)["provenance"]["command"];
  for (const char* ending : {".svg", ".png"})
    CHECK_THAT(read(f.at(std::string("out/joint") + ending)), Contains(command));
  std::string words;
  for (const unsigned char c : command) words += fmt::format("{:02x}", c);
  const std::string pdf = read(f.at("out/joint.pdf"));
  CHECK_THAT(pdf, Contains(words));
  const std::size_t table = std::stoul(pdf.substr(pdf.rfind("startxref\n") + 10));
  CHECK(pdf.compare(table, 5, "xref\n") == 0);
  std::size_t object = 0;
  std::sscanf(pdf.c_str() + table, "xref\n%*d 1\n%zu", &object);
  CHECK_THAT(pdf.substr(object, 12), Contains(" 0 obj"));
  done(f, kHold);
  CHECK_FALSE(fs::exists(f.at("out/joint.svg")));  // of the earlier run
  check_refused(f, kHold + Arguments{"--figures", "svg,bmp"}, {"--figures: 'bmp'", "svg, pdf or png"});
}

TEST_CASE("report: without gnuplot it says so in one line, and the rest stands") {
  const Folder f;
  fs::create_directory(f.at("bin"));
  for (const char* program : {"timeout"})
    fs::create_symlink(std::string("/usr/bin/") + program, f.at("bin/") + program);
  const Result r = run(kHold, f.at(""), {.limits = "export PATH=" + f.at("bin")});
  INFO(r.err);
  CHECK(r.code == 0);
  const std::string page = read(f.at("out/report.html"));
  CHECK_THAT(page, Contains("figures are left out: gnuplot is not installed") && Contains("id=\"landings\"") &&
                       Contains("All numbers"));
  CHECK(page.find("<svg") == std::string::npos);
}

TEST_CASE("report: many rows are thinned, and no peak is lost") {
  const Folder f;
  done(f, kHold + Arguments{"--rate", "50000"});
  const std::string page = read(f.at("out/report.html"));
  CHECK(page.size() < 2'000'000);
  const Json fall = landings(page)[0];
  CHECK(fall["t"].size() < 6000);
  const Json acceleration = fall["acc"];
  for (const Json& peak : summary(f)["peaks"]) {
    INFO(peak);
    double nearest = 1e9;
    for (std::size_t i = 0; i < acceleration.size(); ++i)
      if (std::abs(fall["t"][i].get<double>() - peak["t"].get<double>()) < 1e-4)
        nearest = std::min(nearest, std::abs(acceleration[i].get<double>() - peak["acceleration"].get<double>()));
    CHECK(nearest < 0.01 * peak["acceleration"].get<double>());
  }
}

TEST_CASE("report: names are shown and never run") {
  const Folder f;
  const std::string name = "a`touch ran`<img src=x onerror=alert(1)>'\"$(touch ran).csv";
  fs::copy_file(kTrial1, f.at(name));
  done(f, {"identify", name, "--rig", kRig, "-o", "out"});
  const std::string page = read(f.at("out/report.html"));
  CHECK(page.find("<img") == std::string::npos);
  CHECK_THAT(page, Contains("&lt;img src=x onerror=alert(1)&gt;"));
  CHECK_FALSE(fs::exists(f.at("ran")));
}
