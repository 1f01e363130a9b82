// Batches of a program that are too late while a laser burns a list of powers: the machine brakes,
// possibly beside its path, and returns to where it left it. On the way it is dark or has the light
// of that place, and no cell is left out.
#include <fmt/format.h>

#include <random>

#include "tests/board/program_host.hpp"
#include "tests/board/raster.hpp"
#include "tests/program_sender.hpp"

namespace lamplock::test {
namespace {

/// A place in steps of X and Y.
struct Spot {
  double x = 0, y = 0;
};

/// A program line with a power for each cell, thousandths; without powers it is a rapid.
struct CellLine {
  Spot from, to;
  std::vector<int> powers;

  double length() const { return std::hypot(to.x - from.x, to.y - from.y); }
  /// A place relative to the line: distance along it and distance from it.
  Spot seen_from(const Spot& at) const {
    const double ux = (to.x - from.x) / length(), uy = (to.y - from.y) / length();
    const double dx = at.x - from.x, dy = at.y - from.y;
    return {dx * ux + dy * uy, std::fabs(dx * uy - dy * ux)};
  }
};

/// Lines in zigzag with increasing Y, so that none crosses another.
class Zigzag {
 public:
  static constexpr double steps_per_mm = 200;

  Zigzag(std::uint64_t seed, int lines, bool by_speed) : by_speed_(by_speed) {
    std::mt19937_64 random(seed);
    const Pick<int> pick(random);
    Spot at;
    for (int i = 0; i < lines; ++i) {
      CellLine line;
      line.from = at;
      const int way = pick(0, 3) == 0 ? pick(100, 1000) : pick(1000, 12'000);
      at.x += at.x > 0 ? -way : way;
      at.y += pick(0, 2) == 0 ? pick(40, 100) : pick(100, 1000);
      line.to = at;
      const int most = static_cast<int>(line.length() / 8);  // cells have at least 8 steps
      const int kind = pick(0, 7);                           // a rapid, one power, a list
      const int cells = kind == 0 ? 0 : kind == 1 ? 1 : pick(2, std::min(most, 80));
      while (static_cast<int>(line.powers.size()) < cells)
        line.powers.insert(line.powers.end(), static_cast<std::size_t>(pick(1, 5)),
                           pick(0, 2) == 0 ? 0 : pick(50, 1000));
      line.powers.resize(static_cast<std::size_t>(cells));
      lines_.push_back(line);
    }
  }

  std::string program() const {
    std::string text = fmt::format("G21 G90 G0 X0 Y0\n{} S0 F18000\n", by_speed_ ? "M4" : "M3");
    for (const CellLine& line : lines_) {
      text +=
          fmt::format("{} X{} Y{}{}", line.powers.empty() ? "G0" : "G1", line.to.x / steps_per_mm,
                      line.to.y / steps_per_mm, line.powers.empty() ? "" : " S");
      for (std::size_t i = 0; i < line.powers.size();) {
        std::size_t end = i + 1;
        while (end < line.powers.size() && line.powers[end] == line.powers[i]) ++end;
        text += fmt::format("{}{}", i == 0 ? "" : ":", line.powers[i]);
        if (line.powers.size() > 1) text += fmt::format("*{}", end - i);
        i = end;
      }
      text += '\n';
    }
    return text + "M5\nM2\n";
  }

  /// Light on the lines, from the pins only.
  struct Judgement {
    long lit = 0, wrong = 0;  ///< intervals between two steps
    double first_wrong_s = 0;
    long cells = 0, missing = 0;  ///< cells with power; cells without light in their middle
  };
  /// The laser answers `lead` after its command.
  Judgement judge(const PinMonitor& monitor, const sim::Beam& beam, Picoseconds lead) const {
    Judgement result;
    std::vector<std::vector<bool>> done;
    for (const CellLine& line : lines_) done.emplace_back(line.powers.size());
    std::vector<sim::BeamChange> light = beam.changes();
    for (sim::BeamChange& change : light) change.at += lead;
    const auto &x = monitor.steps(0), &y = monitor.steps(1);
    Spot at;
    Picoseconds since = 0;
    for (std::size_t i = 0, j = 0; i < x.size() || j < y.size();) {
      const bool first = j == y.size() || (i < x.size() && x[i].at <= y[j].at);
      const Picoseconds now = first ? x[i].at : y[j].at;
      judge_place(at, since, now, light, done, result);
      since = now;
      if (first)
        at.x = x[i++].position;
      else
        at.y = y[j++].position;
    }
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      for (std::size_t c = 0; c < done[i].size(); ++c) {
        if (lines_[i].powers[c] == 0) continue;
        ++result.cells;
        if (!done[i][c]) ++result.missing;
      }
    }
    return result;
  }

 private:
  static constexpr int rounding = 40;   ///< of 65535: a duty has 2000 counts
  static constexpr double reach = 1.5;  ///< steps: a step, and the staircase of two axes

  static int light_of(int power) { return (power * 65'535 + 500) / 1000; }
  bool is_light(int light, int power) const {
    const int wanted = light_of(power);
    return light <= wanted + rounding && (by_speed_ || light >= wanted - rounding);
  }

  void judge_place(const Spot& at, Picoseconds from, Picoseconds to,
                   const std::vector<sim::BeamChange>& light, std::vector<std::vector<bool>>& done,
                   Judgement& result) const {
    if (from == to) return;
    auto change = std::partition_point(light.begin(), light.end(),
                                       [from](const auto& c) { return c.at <= from; });
    if (change != light.begin()) --change;
    for (; change != light.end() && change->at < to; ++change) {
      const int now = change->light();
      // Gate and power of one change may occur in different microseconds.
      const auto next = change + 1;
      const Picoseconds end = next == light.end() ? to : std::min(to, next->at);
      if (now == 0 || end - std::max(from, change->at) < 2 * ps_per_us) continue;
      ++result.lit;
      if (is_right(at, now, done)) continue;
      if (result.wrong++ == 0) result.first_wrong_s = static_cast<double>(to) * 1e-12;
    }
  }
  bool is_right(const Spot& at, int light, std::vector<std::vector<bool>>& done) const {
    bool right = false;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const CellLine& line = lines_[i];
      if (line.powers.empty() || at.y < line.from.y - 2 || at.y > line.to.y + 2) continue;
      const Spot seen = line.seen_from(at);
      if (seen.y > reach || seen.x < -reach || seen.x > line.length() + reach) continue;
      const double cell = line.length() / static_cast<double>(line.powers.size());
      const auto cell_at = [&](double along) {
        const auto c = static_cast<long>(std::floor(along / cell));
        return static_cast<std::size_t>(
            std::clamp(c, 0L, static_cast<long>(line.powers.size()) - 1));
      };
      for (std::size_t c = cell_at(seen.x - reach); c <= cell_at(seen.x + reach); ++c) {
        if (!is_light(light, line.powers[c])) continue;
        right = true;
        const double middle = (static_cast<double>(c) + 0.5) * cell;
        if (std::fabs(seen.x - middle) <= reach) done[i][c] = true;
      }
    }
    return right;
  }

  bool by_speed_;
  std::vector<CellLine> lines_;
};

TEST(LateBatches, LightIsThatOfItsPlaceOrNone) {
  std::uint32_t late = 0;
  for (int round = 0; round < scaled(8); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    std::mt19937_64 random(static_cast<std::uint64_t>(round));
    const bool by_speed = round % 4 == 3;
    const Zigzag zigzag(static_cast<std::uint64_t>(round + 100), 25, by_speed);
    const double lead_us = round % 2 == 0 ? 0 : static_cast<double>(random() % 2001) - 1000;
    job::Profile machine = raster_machine(lead_us);
    job::state_setting(machine, Id::travel_y, 400, "test");
    if (round % 3 == 2) job::state_setting(machine, Id::jerk_x, 50, "test");
    Rig rig(machine);
    rig.run(ps_per_ms);
    ProgramSender sender(rig.board);
    sender.give(zigzag.program());
    const Picoseconds end = rig.now() + 100 * ps_per_s;
    while (!sender.answered() && rig.now() < end) {
      rig.board.set_planning_time(ps_per_ms *
                                  static_cast<Picoseconds>(random() % 15 != 0 ? 1 : random() % 60));
      sender.step(static_cast<Picoseconds>(random() % 20'000) * ps_per_us);
      late = std::max(late, rig.board.controller().program().starvations());
    }
    rig.board.set_planning_time(0);
    ASSERT_TRUE(sender.run_until_idle(end));
    ASSERT_EQ(sender.errors(), 0u);
    rig.run(20 * ps_per_ms);
    const Zigzag::Judgement light = zigzag.judge(rig.monitor, rig.board.world().beam(),
                                                 static_cast<Picoseconds>(lead_us * ps_per_us));
    EXPECT_EQ(light.wrong, 0) << "of " << light.lit << ", first at " << light.first_wrong_s << " s";
    EXPECT_EQ(light.missing, 0) << "of " << light.cells;
    EXPECT_GT(light.lit, 1000);
    EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  }
  EXPECT_GT(late, scaled(8) < 8 ? 0u : 10u) << "no batch was late";
}

}  // namespace
}  // namespace lamplock::test
