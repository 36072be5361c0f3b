#include <sys/mman.h>
#include <unistd.h>

#include <stdexcept>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "identify/logs/force_log.hpp"
#include "identify/logs/hebi_trial.hpp"
#include "identify/logs/hits.hpp"
#include "identify/logs/trial_checks.hpp"
#include "identify/rig/rig.hpp"
#include "landing/drops/drop_log.hpp"
#include "landing/model/motion_csv.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/scatter/drop_file.hpp"
#include "test/fuzz/targets.hpp"
#include "tools/program/trials.hpp"

namespace fuzz {

namespace {

using namespace ukemi;

/// Bytes as a file that lives in memory.
class File {
 public:
  explicit File(const std::string& bytes) : number_(::memfd_create("fuzz", 0)) {
    if (number_ < 0 || ::write(number_, bytes.data(), bytes.size()) != ssize_t(bytes.size()))
      throw std::runtime_error("no file in memory");
  }
  ~File() { ::close(number_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(number_); }

 private:
  int number_;
};

/// Whether f refuses its input or does not; anything else is thrown on.
template <class F>
bool accepts(F&& f) {
  try {
    f();
    return true;
  } catch (const InputError&) {
    return false;
  }
}

void trial(const std::string& bytes) {
  const File file(bytes);
  accepts([&] {
    identify::Trial t = identify::read_trial(file.path(), {.require_phi = false});
    identify::flatten_force_between_hits(t);
    (void)identify::gaps(t);
    (void)identify::noise_level(t.phi);
  });
  accepts([&] { (void)identify::read_force_log(file.path(), ""); });
}

void hebi(const std::string& bytes) {
  const File file(bytes);
  accepts([&] {
    const identify::HebiLog log =
        identify::is_hebilog(file.path()) ? identify::read_hebilog(file.path()) : identify::read_hebi_csv(file.path());
    (void)identify::hebi_trial(log, {});
  });
}

void drop(const std::string& bytes) {
  const File file(bytes);
  accepts([&] { (void)landing::read_drop(file.path()); });
}

void drops(const std::string& bytes) {
  const File file(bytes);
  landing::Scene scene;
  scene.robot = {{0.8, 0.8}, {6e-3, 6e-3}, 0.3, 9.81};
  scene.floor = landing::Floor<double>{7000, 120, 0.2};
  scene.drop = {.height = 0.4};
  accepts([&] { (void)landing::read_drops(file.path(), scene, {50, 1, 65, 1.6, 0.085}); });
}

void motion(const std::string& bytes) {
  const File file(bytes);
  accepts([&] { (void)landing::read_motion_csv(file.path()); });
}

/// What is read can be written, and what is written can be read.
template <class T>
void round_trip(const std::string& path, T (*read)(const std::string&), std::string (*text)(const T&)) {
  std::string written;
  if (!accepts([&] { written = text(read(path)); })) return;
  const File again(written);
  if (!accepts([&] { (void)read(again.path()); }))
    throw std::logic_error("what was read and written is refused:\n" + written);
}

void toml(const std::string& bytes) {
  const File file(bytes);
  accepts([&] { (void)identify::read_rig(file.path()); });
  round_trip<Actuator>(
      file.path(), read_actuator, +[](const Actuator& a) { return to_toml(a); });
  round_trip<landing::Scene>(
      file.path(), landing::read_scene, +[](const landing::Scene& s) { return landing::to_toml(s, ""); });
  round_trip<landing::Motion>(
      file.path(), landing::read_motion, +[](const landing::Motion& m) { return landing::to_toml(m, ""); });
}

}  // namespace

const std::map<std::string, Target>& readers() {
  static const std::map<std::string, Target> all = {{"trial", trial}, {"hebi", hebi},     {"drop", drop},
                                                    {"drops", drops}, {"motion", motion}, {"toml", toml}};
  return all;
}

}  // namespace fuzz
