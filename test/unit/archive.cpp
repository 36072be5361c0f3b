// The best few that lie apart.
#include "landing/search/archive.hpp"

#include <catch2/catch.hpp>

#include "landing/search/population.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {
/// In one variable.
Candidate at(double u, double value) {
  Candidate p{Coordinates::Constant(1, u)};
  p.value = value;
  return p;
}
std::vector<double> values(const Archive& archive) {
  std::vector<double> out;
  for (const Candidate& p : archive) out.push_back(p.value);
  return out;
}
}  // namespace

TEST_CASE("archive: a full list takes what is better than its worst, and nothing else") {
  Archive archive(4, 0.05);
  CHECK(archive.empty());
  CHECK(archive.bound() == kNoMotion);
  CHECK(archive.lowest() == kNoMotion);
  for (const double v : {202, 200, 203, 201}) CHECK(archive.add(at(0.1 * (v - 199), v)));
  CHECK(values(archive) == std::vector<double>{200, 201, 202, 203});
  CHECK(archive.bound() == 203);
  CHECK(archive.add(at(0.9, 100)));
  CHECK(values(archive) == std::vector<double>{100, 200, 201, 202});
  CHECK_FALSE(archive.add(at(0.8, 202.5)));
  CHECK_FALSE(archive.add(at(0.8, 202)));
  archive.clear();
  CHECK(archive.empty());
}

TEST_CASE("archive: of neighbours the best stays, whatever the order they come in") {
  Archive archive(4, 0.05);
  CHECK(archive.add(at(0.50, 10)));
  CHECK_FALSE(archive.add(at(0.52, 10)));
  CHECK_FALSE(archive.add(at(0.52, 11)));
  CHECK(archive.add(at(0.55, 12)));
  CHECK(archive.add(at(0.525, 9)));  // lies beside both
  CHECK(values(archive) == std::vector<double>{9});
  CHECK(archive.beside(at(0.51, 20), 9));
  CHECK_FALSE(archive.beside(at(0.51, 20), 8));
  CHECK_FALSE(archive.beside(at(0.6, 20), 9));
}

TEST_CASE("archive: what could not be followed has no place") {
  Archive archive(4, 0.05);
  CHECK_FALSE(archive.add(at(0.5, kNoMotion)));
  CHECK_FALSE(archive.add(at(0.5, std::numeric_limits<double>::quiet_NaN())));
  CHECK(archive.empty());
}

TEST_CASE("archive: after whatever comes it is in order, apart, within its places, and holds the best of all") {
  constexpr double kApart = 0.1;
  for (const std::size_t most : {std::size_t(1), std::size_t(5), Archive::kMost}) {
    Archive archive(most, kApart);
    Random random(most);
    double best = kNoMotion;
    for (int n = 0; n < 2'000; ++n) {
      Candidate p = random_point(random, 2);
      p.value = random.uniform(1, 100);
      best = std::min(best, p.value);
      const bool wanted = p.value < archive.bound() && !archive.beside(p, p.value);
      CHECK(archive.add(p) == wanted);
    }
    CHECK(archive.size() <= most);
    CHECK(archive.lowest() == best);
    for (std::size_t i = 1; i < archive.size(); ++i) {
      CHECK(archive[i - 1].value <= archive[i].value);
      for (std::size_t k = 0; k < i; ++k) CHECK(distance(archive[i], archive[k]) >= kApart);
    }
  }
}

TEST_CASE("archive: each first contact has places of its own") {
  const auto with = [](int contact, double u, double value) {
    Candidate p = at(u, value);
    p.first_contact = contact;
    return p;
  };
  Archive archive(2, 0.05);
  for (const double v : {10, 11, 12}) archive.add(with(0, 0.1 * (v - 9), v));
  CHECK(values(archive) == std::vector<double>{10, 11});
  CHECK(archive.bound() == 11);
  CHECK(archive.add(with(1, 0.1, 15)));  // beside one of the other contact, and worse than all of it
  CHECK(archive.add(with(1, 0.9, 14)));
  CHECK(values(archive) == std::vector<double>{10, 11, 14, 15});
  CHECK(archive.bound() == 15);
  CHECK_FALSE(archive.add(with(1, 0.5, 16)));
  CHECK_FALSE(archive.add(with(0, 0.5, 13)));
  CHECK(archive.lowest() == 10);
  CHECK(archive.lowest(with(1, 0.5, 20)) == 14);
  CHECK(archive.beside(with(1, 0.11, 20), 15));
  CHECK_FALSE(archive.beside(with(1, 0.2, 20), 15));
  // A third whose best is above twice the lowest does not count.
  CHECK(archive.add(with(2, 0.5, 30)));
  CHECK(archive.bound() == 15);
  Random random(1);
  int of_best = 0;
  constexpr int kDraws = 1'000;
  for (int n = 0; n < kDraws; ++n) {
    const Candidate& p = archive.draw(random);
    CHECK(p.first_contact < 2);
    of_best += p.first_contact == 0;
  }
  CHECK(of_best > 650);  // one half, and half of the other
  CHECK(of_best < 850);
}
