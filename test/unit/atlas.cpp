// The atlas: its grid and blocks, its file and journal, the reader of a control program.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <set>

#include "common/degrees.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/atlas/atlas_reader.hpp"
#include "landing/atlas/two_link_atlas.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/planner.hpp"
#include "landing/search/tolerant_peak.hpp"
#include "test/folder.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;
using Catch::Matchers::Contains;

namespace {

AtlasOptions small() {
  AtlasOptions o;
  o.grid.axes = {{{0.3, 0.5, 2}, {0.4, 0.8, 4}, {10 * kDegree, 25 * kDegree, 2}}};
  o.search.evaluations = 60;
  return o;
}

Atlas planned(const AtlasOptions& o) {
  Atlas out{atlas_header(TwoLinkAtlas(paper(), table2()), o), std::vector<AtlasCell>(o.grid.size())};
  plan_atlas(TwoLinkAtlas(paper(), table2()), o, out.cells);
  out.header.safest = safest_motion(TwoLinkAtlas(paper(), table2()), o.grid, out.cells, 0, {});
  return out;
}

bool same(const AtlasCell& a, const AtlasCell& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

Atlas read_back(const std::string& bytes) { return atlas_of(std::as_bytes(std::span(bytes)), "a.bin"); }

}  // namespace

TEST_CASE("atlas: blocks and shards part the grid, and indices come back") {
  const AtlasGrid grid{{{{0.1, 1, 10}, {-1, 2, 13}, {-0.7, 0.7, 17}}}};
  CHECK(grid.size() == 2210);
  CHECK(grid.blocks() == 4 * 5 * 6);
  std::set<std::size_t> seen;
  for (std::size_t b = 0; b < grid.blocks(); ++b) {
    const auto block = grid.block(b);
    CHECK(block.size() <= 27);
    // Each drop after the first has a neighbour that comes before it.
    for (std::size_t i = 0; i < block.size(); ++i) {
      CHECK(seen.insert(block[i]).second);
      const auto near = [&](std::size_t other) {
        std::size_t steps = 0;
        for (std::size_t k = 0; k < 3; ++k)
          steps += std::size_t(std::abs(long(grid.place(other)[k]) - long(grid.place(block[i])[k])));
        return steps == 1;
      };
      if (i > 0) CHECK(std::any_of(block.begin(), block.begin() + long(i), near));
    }
  }
  CHECK(seen.size() == grid.size());
  for (const std::size_t i : {std::size_t(0), std::size_t(777), std::size_t(2209)})
    CHECK(grid.index(grid.place(i)) == i);
  CHECK(grid.drop(0).height == 0.1);
  CHECK(grid.drop(2209).height == 1);
  CHECK(grid.drop(2209).pitch == 0.7);
  std::set<std::size_t> of_shards;
  for (std::size_t k = 1; k <= 7; ++k)
    for (const std::size_t i : AtlasShard{k, 7}.drops(grid)) CHECK(of_shards.insert(i).second);
  CHECK(of_shards == seen);
  CHECK_THROWS_AS((AtlasShard{0, 2}.validate(grid)), InputError);
  CHECK_THROWS_AS((AtlasShard{3, 2}.validate(grid)), InputError);
  CHECK_THROWS_AS((AtlasShard{1, 121}.validate(grid)), InputError);
  CHECK_THROWS_AS((AtlasGrid{{{{-0.1, 1, 10}, {-1, 2, 13}, {0, 1, 2}}}}.validate()), InputError);
  CHECK_THROWS_AS((AtlasGrid{{{{0.1, 1, 1000}, {-1, 2, 1000}, {0, 1, 2}}}}.validate()), InputError);
}

TEST_CASE("atlas: threads, shards and where it was stopped change no cell") {
  AtlasOptions o = small();
  o.search.threads = 1;
  const Atlas whole = planned(o);
  REQUIRE(whole.planned() == whole.cells.size());
  Atlas parts{whole.header, std::vector<AtlasCell>(o.grid.size())};
  o.search.threads = 3;
  for (const std::size_t k : {2, 1}) {
    o.shard = {k, 2};
    plan_atlas(TwoLinkAtlas(paper(), table2()), o, parts.cells);
  }
  std::vector<AtlasCell> again(o.grid.size());
  o.shard = {};
  o.search.threads = 1;
  // Stopped at each drop once: the one in work is lost, those before it stay.
  std::size_t told = 0, lost = 0;
  for (bool over = false; !over;) {
    long asked = 0;
    std::size_t here = 0;
    o.done = [&](std::size_t, const AtlasCell&) { ++here; };
    o.monitor.stop = [&] { return here >= 1 && ++asked > 5; };
    plan_atlas(TwoLinkAtlas(paper(), table2()), o, again);
    told += here, ++lost;
    over = std::none_of(again.begin(), again.end(), [](auto& c) { return c.state == AtlasCell::State::kOpen; });
    REQUIRE(lost <= again.size());
  }
  CHECK(told == again.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    CHECK(same(whole.cells[i], parts.cells[i]));
    CHECK(same(whole.cells[i], again[i]));
  }
}

TEST_CASE("atlas: each cell's peak is that of its motion, and the safest motion's worst is the smallest") {
  const AtlasOptions o = small();
  const Atlas a = planned(o);
  const ReferenceSpace space(paper(), table2().sea);
  Scene scene = paper();
  std::vector<double> worst(a.cells.size(), 0);
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    const DrivenMotion play = space.play(a.cells[i].coordinates(3));
    for (std::size_t k = 0; k < a.cells.size(); ++k) {
      scene.drop = o.grid.drop(k);
      const double peak = peak_acceleration(scene, play.sea, play.motion).peak;
      worst[i] = std::max(worst[i], peak);
      if (i == k) CHECK(a.cells[i].peak == Approx(peak).epsilon(1e-9));
    }
  }
  const auto best = std::min_element(worst.begin(), worst.end());
  CHECK(a.header.safest.worst == Approx(*best).epsilon(1e-3));
  CHECK(worst[a.header.safest.drop] == Approx(*best).epsilon(1e-3));
}

TEST_CASE("atlas: a file comes back as it was, what is cut or changed is refused") {
  const Atlas a = planned(small());
  const std::string bytes = atlas_bytes(a);
  CHECK(bytes.size() == sizeof(AtlasHeader) + a.cells.size() * sizeof(AtlasCell));
  const Atlas back = read_back(bytes);
  for (std::size_t i = 0; i < a.cells.size(); ++i) CHECK(same(a.cells[i], back.cells[i]));
  CHECK(back.header.safest.drop == a.header.safest.drop);
  CHECK(std::string(back.header.variable[0].name) == "phi_i");
  for (std::size_t n = 0; n < bytes.size(); n += 97) CHECK_THROWS_AS(read_back(bytes.substr(0, n)), InputError);
  for (std::size_t i = 0; i < bytes.size(); i += 31) {
    std::string changed = bytes;
    changed[i] = char(changed[i] ^ 16);
    INFO(i);
    CHECK_THROWS_AS(read_back(changed), InputError);
  }
  std::string other = bytes;
  std::swap(other[12], other[15]), std::swap(other[13], other[14]);
  CHECK_THAT(refusal([&] { (void)read_back(other); }), Contains("a.bin: written in another order of bytes"));
  const test::Folder f;
  const MappedAtlas mapped(f.write("a.bin", bytes));
  CHECK(same(mapped.cells()[5], a.cells[5]));
  CHECK_THAT(refusal([&] { MappedAtlas none(f.at("none.bin")); }), Contains("No such file"));
  CHECK_THAT(refusal([&] { MappedAtlas folder(f.at("")); }), Contains("a regular file"));
}

TEST_CASE("atlas: a journal keeps every whole cell, wherever it is cut, and no stranger's") {
  const test::Folder f;
  const std::string path = f.at("out/atlas.part"), id(16, 'a');
  std::vector<AtlasCell> cells(20);
  {
    AtlasJournal journal(path, id, cells);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      cells[i].state = AtlasCell::State::kPlanned, cells[i].value = double(i);
      journal.add(i, cells[i]);
    }
    std::vector<AtlasCell> second(20);
    CHECK_THAT(refusal([&] { AtlasJournal other(path, id, second); }), Contains("another run is at work"));
  }
  const std::string bytes = test::read(path);
  const std::size_t each = (bytes.size() - 24) / 20;
  for (std::size_t n = 0; n <= bytes.size(); n += 7) {
    f.write("out/atlas.part", bytes.substr(0, n));
    std::vector<AtlasCell> found(20);
    const std::size_t whole = n < 24 ? 0 : (n - 24) / each;
    {
      AtlasJournal journal(path, id, found);
      CHECK(journal.taken() == whole);
      if (whole < 20) journal.add(whole, cells[whole]);
    }
    std::vector<AtlasCell> more(20);
    CHECK(AtlasJournal(path, id, more).taken() == std::min<std::size_t>(20, whole + 1));
    for (std::size_t i = 0; i < whole; ++i) CHECK(same(more[i], cells[i]));
  }
  CHECK_THAT(refusal([&] { AtlasJournal other(path, std::string(16, 'b'), cells); }), Contains("another atlas"));
}

TEST_CASE("atlas: what makes another atlas makes another identity") {
  const AtlasOptions o = small();
  std::set<std::string> seen{atlas_identity(TwoLinkAtlas(paper(), table2()), o)};
  const auto differs = [&](const AtlasOptions& other) {
    CHECK(seen.insert(atlas_identity(TwoLinkAtlas(paper(), table2()), other)).second);
  };
  AtlasOptions a = o;
  a.search.seed = 2, differs(a), a = o;
  a.search.evaluations = 61, differs(a), a = o;
  a.search.goal = Goal::kTolerant, differs(a), a = o;
  a.grid.axes[1].upper = 0.9, differs(a), a = o;
  a.robust.measure = Measure{Measure::Kind::kCvar}, differs(a);
  a.robust.samples = 64, differs(a);
  a.robust.scatter = Scatter{.pitch = 0.1}, differs(a);
  Scene soft = paper();
  soft.floor->stiffness *= 2;
  CHECK(seen.insert(atlas_identity(TwoLinkAtlas(soft, table2()), o)).second);
  a = o, a.search.threads = 7, a.shard = {2, 2};
  CHECK(seen.count(atlas_identity(TwoLinkAtlas(paper(), table2()), a)) == 1);
}

TEST_CASE("atlas: a reader takes the best of the motions around, says what is outside, and starts a planner") {
  const AtlasOptions o = small();
  const Atlas a = planned(o);
  const test::Folder f;
  const std::string path = f.write("atlas.bin", atlas_bytes(a));
  const ReferenceSpace space(paper(), table2().sea);
  AtlasReader reader(path, paper(), table2().sea, {.goal = Goal::kPeak, .deadline = 10});
  Scene scene = paper();
  scene.drop = {.height = 0.42, .forward_speed = 0.61, .pitch = 17 * kDegree};
  const AtlasEntry entry = reader.at(scene.drop);
  REQUIRE(entry.inside);
  double best = kNoMotion;
  for (const std::size_t h : {0, 1})
    for (const std::size_t s : {1, 2})
      for (const std::size_t p : {0, 1}) {
        const DrivenMotion play = space.play(a.cells[o.grid.index({h, s, p})].coordinates(3));
        best = std::min(best, peak_acceleration(scene, play.sea, play.motion).peak);
      }
  CHECK(entry.value == Approx(best).epsilon(1e-3));
  CHECK(peak_acceleration(scene, entry.sea, entry.motion).peak == Approx(best).epsilon(1e-3));

  Planner planner(paper(), table2().sea, {.goal = Goal::kPeak});
  planner.start(entry.starts());
  const Plan plan = planner.plan(scene.drop, 0.05);
  REQUIRE(plan.found());
  CHECK(plan.value <= best * (1 + 1e-3));

  AtlasReader tolerant(path, paper(), table2().sea, {.deadline = 10});
  const AtlasEntry safe = tolerant.at(scene.drop);
  CHECK(safe.value == Approx(tolerant_peak(scene, safe.sea, safe.motion, {}, 0, 1, 1).value).epsilon(1e-3));

  // A fall that has begun is that from the greater height.
  const double v = -1.2, g = scene.robot.gravity;
  const AtlasEntry falling = reader.at({0.42 - v * v / (2 * g), 0.61, 17 * kDegree, 0, v});
  CHECK(falling.inside);
  CHECK(falling.drop == entry.drop);
  CHECK(falling.value == Approx(entry.value).epsilon(1e-3));

  for (const Drop& d : {Drop{0.6, 0.61, 17 * kDegree}, Drop{0.4, 0.3, 17 * kDegree}, Drop{0.4, 0.61, 1.2}}) {
    const AtlasEntry outside = reader.at(d);
    CHECK_FALSE(outside.inside);
    CHECK(outside.found);
    CHECK((outside.holds || outside.drop == a.header.safest.drop));
  }
  Scene shaped = paper();
  shaped.freedom.bumps = 1;
  CHECK_THAT(refusal([&] { AtlasReader other(path, shaped, table2().sea); }), Contains("other variables"));
  Scene heavier = paper(), elsewhere = paper();
  heavier.robot.mass[1] *= 1.1, elsewhere.drop.height = 0.35;
  SeaParameters<double> softer = table2().sea;
  softer.k_sea *= 0.9;
  CHECK_THAT(refusal([&] { AtlasReader other(path, heavier, table2().sea); }), Contains("another robot, floor or"));
  CHECK_THAT(refusal([&] { AtlasReader other(path, paper(), softer); }), Contains("another robot, floor or actuator"));
  CHECK(refusal([&] { AtlasReader same(path, elsewhere, table2().sea); }) == "");
  Atlas part = a;
  part.cells[3].state = AtlasCell::State::kOpen;
  CHECK_THAT(refusal([&] { AtlasReader other(f.write("part.bin", atlas_bytes(part)), paper(), table2().sea); }),
             Contains("part.bin: drops of it are not planned"));
}

TEST_CASE("atlas: a reader holds the posture where every motion around lands harder, by each goal") {
  const test::Folder f;
  const Scene scene = paper();
  Atlas a = planned(small());
  for (AtlasCell& c : a.cells) c.values = {0, 0, 0.5};  // held straight
  const std::string path = f.write("atlas.bin", atlas_bytes(a));
  const Drop inside{.height = 0.42, .forward_speed = 0.61, .pitch = 17 * kDegree},
      outside{.height = 0.6, .forward_speed = 0.61, .pitch = 17 * kDegree};
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant})
    for (const Drop& drop : {inside, outside}) {
      AtlasReader reader(path, scene, table2().sea, {.goal = goal, .deadline = 10});
      const AtlasEntry entry = reader.at(drop);
      Scene here = scene;
      here.drop = drop;
      REQUIRE(entry.found);
      CHECK(entry.holds);
      CHECK(entry.motion.phi_i == Approx(-45 * kDegree).margin(1e-12));
      CHECK(entry.motion.phi_f == entry.motion.phi_i);
      const double held = goal == Goal::kPeak ? peak_acceleration(here, table2().sea, entry.motion).peak
                                              : tolerant_peak(here, table2().sea, entry.motion, {}, 0, 1, 1).value;
      CHECK(entry.value == Approx(held).epsilon(1e-3));
      CHECK(entry.value < peak_acceleration(here, table2().sea, {0, 0, 0.5}).peak);
    }
}

// Written by ukemi 0.1.0 before robots of links had atlases: heights 0.3, 0.5 m, 0.4, 0.8 m/s, 10, 25 deg.
TEST_CASE("atlas: a file of before is still read, and answers") {
  const std::string path = UKEMI_SOURCE "/test/data/atlas_version_2.bin";
  AtlasReader reader(path, paper(), table2().sea, {.goal = Goal::kPeak, .deadline = 10});
  const MappedAtlas file(path);
  Scene scene = paper();
  scene.drop = {.height = 0.5, .forward_speed = 0.8, .pitch = 25 * kDegree};
  const AtlasEntry entry = reader.at(scene.drop);
  REQUIRE(entry.inside);
  CHECK(entry.value <= file.cells()[7].peak * (1 + 1e-3));
  CHECK(peak_acceleration(scene, entry.sea, entry.motion).peak == Approx(entry.value).epsilon(1e-3));
  CHECK(file.header().safest.drop < 8);
}
