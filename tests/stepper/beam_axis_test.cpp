// The beam axis: edges of cells at their ticks, compared with the positions of the axes.
#include "firmware/stepper/beam_axis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "firmware/stepper/tick_generator.hpp"
#include "tests/scale.hpp"

namespace lamplock::stepper {
namespace {

constexpr double unit_q62 = 1.0 / (1ll << 62);
constexpr double fastest = 0.2;  ///< steps a tick

double value(const Int128& q64) {
  return static_cast<double>(q64.hi()) + std::ldexp(static_cast<double>(q64.lo()), -64);
}

/// Records axis, lattice and light of every tick.
class Board {
 public:
  explicit Board(int axis) : axis_(axis) {}

  void put_axis(int axis, const AxisRun& run, std::uint32_t ticks) {
    if (axis != axis_) return;
    for (std::uint32_t i = 0; i < ticks; ++i) position.push_back(value(run.position_after(i)));
    last_ = value(run.position_after(ticks));
  }
  void put_still(int axis, std::uint32_t ticks) {
    if (axis == axis_) position.insert(position.end(), ticks, last_);
  }
  void set_step(int, std::int32_t) {}
  void put_bits(std::uint8_t bits, std::uint32_t ticks) {
    gate.insert(gate.end(), ticks, (bits & gate_bit) != 0);
  }
  void put_power(std::uint16_t p, std::uint32_t ticks) { power.insert(power.end(), ticks, p); }
  void play(const TickBlock& block) {
    for (std::uint32_t i = 0; i < block.ticks; ++i)
      position.push_back(value(block.axis[index(axis_)].position_after(i)));
    put_bits(block.bits, block.ticks);
    for (std::uint32_t i = 0; i < block.ticks; ++i)
      power.push_back(gate.back() ? block.power(i) : std::uint16_t{0});
  }

  std::vector<double> position;  ///< at the beginning of each tick
  std::vector<bool> gate;
  std::vector<std::uint16_t> power;

 private:
  int axis_;
  double last_ = 0.5;
};

/// Segments along one axis with cells of equal length.
struct BeamLine {
  std::vector<Segment> segments;
  double from = 0, steps = 0;  ///< signed
  double fastest = 0;
};

class Lines {
 public:
  Lines(std::uint64_t seed, int axis) : random_(seed), axis_(axis) {
    end_.axis[index(axis)].position_q64 = middle_of_step(0);
    end_.tick = 100;
  }

  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  /// Starts and ends at rest where requested, otherwise at its current speed.
  BeamLine next(std::size_t segments, bool from_rest, bool to_rest, bool ramps) {
    BeamLine line;
    if (from_rest) backwards_ = below(2) != 0;
    line.from = position();
    for (std::size_t i = 0; i < segments; ++i)
      line.segments.push_back(segment(to_rest && i + 1 == segments, ramps, line));
    line.steps = position() - line.from;
    return line;
  }
  std::uint64_t end_tick() const { return end_.tick; }
  bool backwards() const { return backwards_; }

 private:
  double position() const { return value(end_.axis[index(axis_)].position_q64); }
  std::int64_t some_speed() {
    const double speed = fastest * (1 + below(1000)) / 1001;
    return static_cast<std::int64_t>((backwards_ ? -speed : speed) / unit_q62);
  }
  Segment segment(bool to_rest, bool ramps, BeamLine& line) {
    Segment s;
    s.start_tick = end_.tick;
    AxisProfile& p = s.axis[index(axis_)];
    p.speed_q62 = end_.axis[index(axis_)].speed_q62;
    p.lead_ticks = below(4) == 0 && p.speed_q62 != 0 ? 0 : 1 + below(4000);
    p.cruise_ticks = below(4) == 0 ? 0 : 1 + below(6000);
    const bool none = p.lead_ticks + p.cruise_ticks == 0;
    p.tail_ticks = !to_rest && !none && below(3) == 0 ? 0 : 1 + below(4000);
    const auto accel = [](std::int64_t change, std::uint32_t ticks, std::uint8_t ramp) {
      const std::int64_t a = change / static_cast<std::int64_t>(full_ticks(ticks, ramp));
      return ramp == 0 ? a & ~std::int64_t{1} : a / pulse_accel_unit * pulse_accel_unit;
    };
    const auto ramp = [&](std::uint32_t ticks) {
      return static_cast<std::uint8_t>(ramps && ticks > 600 ? below(max_ramp + 1) : 0);
    };
    if (p.lead_ticks != 0) {
      p.lead_ramp = ramp(p.lead_ticks);
      p.lead_accel_q62 = accel(some_speed() - p.speed_q62, p.lead_ticks, p.lead_ramp);
    }
    const std::int64_t cruise = p.cruise_speed_q62();
    if (p.tail_ticks != 0) {
      p.tail_ramp = ramp(p.tail_ticks);
      const std::int64_t end = to_rest ? 0 : some_speed();
      p.tail_accel_q62 = accel(end - cruise, p.tail_ticks, p.tail_ramp);
    }
    s.ticks = p.ticks();
    for (AxisProfile& other : s.axis)
      if (&other != &p) other.cruise_ticks = s.ticks;
    const auto size = [](std::int64_t speed) {
      return std::fabs(static_cast<double>(speed)) * unit_q62;
    };
    line.fastest =
        std::max({line.fastest, size(p.speed_q62), size(cruise), size(p.end_speed_q62())});
    end_.tick = s.end_tick();
    AxisState& at = end_.axis[index(axis_)];
    at.position_q64 = at.position_q64 + (displacement_q62(p) << 2);
    at.speed_q62 = to_rest ? 0 : p.end_speed_q62();
    s.end = end_;
    return s;
  }

  std::mt19937_64 random_;
  int axis_;
  bool backwards_ = false;
  MotionState end_;
};

std::uint32_t ratio(double cells_per_step) {
  int exponent = 0;
  const double mantissa = std::frexp(cells_per_step, &exponent);
  return static_cast<std::uint32_t>(std::lround(std::ldexp(mantissa, 24))) << 8 |
         static_cast<std::uint32_t>(24 - exponent);
}

std::uint16_t cell_ticks(double ticks) {
  int exponent = 0;
  const double mantissa = std::frexp(ticks, &exponent);
  return CellTicks::of(static_cast<std::uint32_t>(std::ldexp(mantissa, 12)), exponent - 1);
}

/// Sets the beam of each segment: where it begins, in cells, and the common ratio.
void set_beam(BeamLine& line, int axis, double cells, double begin, int place_bits, BeamKind kind) {
  double at = begin;
  const double per_step = cells / std::fabs(line.steps);
  for (Segment& s : line.segments) {
    s.shines = true;
    s.beam_axis = static_cast<std::uint8_t>(axis & 3);
    s.beam_kind = kind;
    s.beam = {};
    s.beam.place = static_cast<std::uint32_t>(
        static_cast<std::uint64_t>(std::ldexp(at, place_bits)) & 0xffffffffu);
    s.beam.ratio = ratio(per_step);
    at += std::fabs(value(displacement_q62(s.axis[index(axis)]) << 2)) * per_step;
  }
}

/// Runs lines axis by axis, as the board does, or in blocks.
struct Machine {
  explicit Machine(int axis) : board(axis) {}

  void run(const std::vector<BeamLine>& lines, std::uint64_t to_tick, bool blocks,
           std::mt19937_64& random) {
    std::vector<const Segment*> all;
    for (const BeamLine& line : lines)
      for (const Segment& s : line.segments) all.push_back(&s);
    std::size_t fed = 0;
    while (board.gate.size() < to_tick) {
      while (fed < all.size() && queue.free() != 0) queue.push(*all[fed++]);
      const auto most = static_cast<std::uint32_t>(
          std::min<std::uint64_t>(1 + random() % 700, to_tick - board.gate.size()));
      if (blocks) {
        TickBlock block;
        generator.fill(block, most);
        board.play(block);
      } else {
        generator.fill_axes(most, board);
      }
    }
    ASSERT_EQ(board.position.size(), board.gate.size());
    ASSERT_EQ(board.power.size(), board.gate.size());
    ASSERT_FALSE(generator.underrun());
  }

  SegmentQueue queue;
  TickGenerator generator{queue};
  Board board;
};

/// Cells of random powers, including runs of equal power.
std::vector<std::uint16_t> some_cells(Lines& make, std::uint32_t count) {
  std::vector<std::uint16_t> cells;
  while (cells.size() < count) {
    const std::uint32_t run =
        make.below(3) != 0 ? 1 : 1 + make.below(make.below(5) == 0 ? 200 : 20);
    const auto power = static_cast<std::uint16_t>(make.below(4) == 0 ? 0 : make.below(65'536));
    cells.insert(cells.end(), run, power);
  }
  cells.resize(count);
  return cells;
}

std::uint16_t write_list(PowerTable& table, const std::vector<std::uint16_t>& cells) {
  for (std::size_t i = 0; i < cells.size();) {
    std::size_t end = i;
    while (end < cells.size() && cells[end] == cells[i]) ++end;
    EXPECT_TRUE(table.add(cells[i], static_cast<std::uint32_t>(end - i)));
    i = end;
  }
  return table.end_list();
}

/// Half of the least significant bit of a table.
constexpr double power_rounding = 17;

/// Each tick has the power of the cell that it lies in; an edge may be a tick late.
void expect_pixels(bool by_speed, bool blocks, std::uint64_t seed) {
  const int axis = static_cast<int>(seed % 3);
  Lines make(seed, axis);
  std::mt19937_64 random(seed);
  auto machine = std::make_unique<Machine>(axis);
  machine->generator.set_position({});
  std::vector<BeamLine> lines;
  std::vector<std::vector<std::uint16_t>> cells;
  std::vector<double> per_tick;  // of a cell at full power
  for (int i = 0; i < 3; ++i) {
    lines.push_back(make.next(1 + make.below(5), i == 0, i == 2, seed % 2 == 0));
    BeamLine& line = lines.back();
    const double most = std::fabs(line.steps) / line.fastest / 40;
    cells.push_back(
        some_cells(make, 1 + make.below(static_cast<std::uint32_t>(std::min(most + 1, 400.0)))));
    const auto count = static_cast<double>(cells.back().size());
    set_beam(line, axis, count, 0, pixel_place_bits,
             by_speed ? BeamKind::pixels_by_speed : BeamKind::pixels);
    per_tick.push_back(line.fastest * count / std::fabs(line.steps));
    const std::uint16_t list = write_list(machine->generator.beam().table(), cells.back());
    for (Segment& s : line.segments) {
      s.beam.list = list;
      s.beam.cell_ticks = cell_ticks(1 / per_tick.back());
    }
  }
  ASSERT_NO_FATAL_FAILURE(machine->run(lines, make.end_tick() + 100, blocks, random));
  const Board& board = machine->board;
  int judged = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const BeamLine& line = lines[i];
    const auto count = static_cast<double>(cells[i].size());
    const std::uint64_t end = line.segments.back().end_tick();
    const auto place = [&](std::uint64_t t) {
      return (board.position[t] - line.from) / line.steps * count;
    };
    for (std::uint64_t t = line.segments.front().start_tick + 1; t + 1 < end; ++t) {
      const double at = place(t), before = place(t - 1);
      // Allows a tick of delay and the rounding of a segment's place.
      if (std::floor(before - 1e-4) != std::floor(at + 1e-4)) continue;
      const auto cell = static_cast<std::size_t>(std::clamp(at, 0.0, count - 1));
      double wanted = cells[i][cell], room = power_rounding;
      if (by_speed) {
        const double rate = (place(t + 1) - before) / 2 / per_tick[i];
        wanted *= rate;
        // Cells span 16 ticks; a cell's ticks have 12 bits.
        room += wanted / 2048 + 1;
        const std::uint64_t first = line.segments.front().start_tick;
        double away = 0;
        for (std::uint64_t n = std::max(t, first + 16) - 16; n < std::min(t + 16, end); ++n)
          away = std::max(away, std::fabs((place(n + 1) - place(n)) / per_tick[i] - rate));
        room += cells[i][cell] * away;
      }
      ASSERT_NEAR(board.power[t], wanted, room)
          << "seed " << seed << " line " << i << " cell " << at << " tick " << t;
      if (!by_speed) {
        ASSERT_EQ(board.gate[t], cells[i][cell] > 15) << "tick " << t;
      }
      ++judged;
    }
  }
  EXPECT_GT(judged, 1000);
}

TEST(BeamAxis, PixelsHaveTheirPowersAtTheirTicks) {
  for (int i = 0; i < test::scaled(120); ++i)
    ASSERT_NO_FATAL_FAILURE(expect_pixels(false, i % 3 == 0, static_cast<std::uint64_t>(i)));
}

TEST(BeamAxis, PixelsFollowTheSpeedInEveryPowerCell) {
  for (int i = 0; i < test::scaled(120); ++i)
    ASSERT_NO_FATAL_FAILURE(expect_pixels(true, i % 3 == 0, static_cast<std::uint64_t>(i)));
}

/// Pulses at whole numbers of cells, across the ends of segments and lines.
void expect_pulses(bool blocks, std::uint64_t seed) {
  const int axis = static_cast<int>(seed % 3);
  Lines make(seed, axis);
  std::mt19937_64 random(seed);
  auto machine = std::make_unique<Machine>(axis);
  machine->generator.set_position({});
  const std::uint32_t pulse = 1 + make.below(seed % 3 == 0 ? 20'000 : 100);
  machine->generator.beam().set_pulse(pulse);
  const double per_step = (0.002 + make.below(1000) / 1000.0) / fastest / 40;
  std::vector<BeamLine> lines;
  std::vector<double> begins;
  double begin = 0.5;
  for (int i = 0; i < 4; ++i) {
    lines.push_back(make.next(1 + make.below(4), i == 0, i == 3, seed % 2 == 0));
    begins.push_back(begin);
    set_beam(lines.back(), axis, std::fabs(lines.back().steps) * per_step, begin, pulse_place_bits,
             BeamKind::pulses);
    begin += std::fabs(lines.back().steps) * per_step;
    for (Segment& s : lines.back().segments) s.beam.power = 40'000;
  }
  lines.front().segments.front().beam_begins = true;
  ASSERT_NO_FATAL_FAILURE(machine->run(lines, make.end_tick() + 30'000, blocks, random));
  const Board& board = machine->board;
  const std::uint64_t first = lines.front().segments.front().start_tick, end = make.end_tick();
  // The exact positions of edges, and the light that they cause.
  std::vector<bool> wanted(board.gate.size(), false), near(board.gate.size(), false);
  const double from = lines.front().from;
  std::uint64_t edges = 0, merged = 0, lit_until = 0;
  for (std::uint64_t t = first + 1; t < end; ++t) {
    const auto place = [&](std::uint64_t tick) {
      return 0.5 + std::fabs(board.position[tick] - from) * per_step;
    };
    if (std::floor(place(t)) == std::floor(place(t - 1))) continue;
    ++edges;
    if (t < lit_until) ++merged;
    lit_until = t + pulse;
    for (std::uint64_t k = t; k < std::min<std::uint64_t>(t + pulse, end); ++k) wanted[k] = true;
    for (const std::uint64_t k : {t, t + pulse})
      for (std::uint64_t n = k - 1; n <= k + 1; ++n)
        if (n < near.size()) near[n] = true;
  }
  std::uint64_t lit = 0;
  for (std::uint64_t t = 0; t < board.gate.size(); ++t) {
    if (board.gate[t]) ++lit;
    ASSERT_EQ(board.power[t], board.gate[t] ? 40'000 : 0) << "tick " << t;
    if (near[t] && t < end) continue;
    ASSERT_EQ(board.gate[t], wanted[t])
        << "seed " << seed << " tick " << t << " of " << end << ", at "
        << 0.5 + std::fabs(board.position[t] - from) * per_step << ", pulse " << pulse;
  }
  // A pulse that starts just as another ends may or may not be counted as merged.
  EXPECT_NEAR(static_cast<double>(machine->generator.beam().merged()), static_cast<double>(merged),
              0.02 * static_cast<double>(edges) + 1);
  if (edges > 2) {
    EXPECT_GT(lit, 0u);
  }
}

TEST(BeamAxis, PulsesBeginAtWholeNumbersOfCells) {
  for (int i = 0; i < test::scaled(200); ++i)
    ASSERT_NO_FATAL_FAILURE(expect_pulses(i % 3 == 0, static_cast<std::uint64_t>(i)));
}

/// If rounding moves a segment's end just before an edge and the next segment's start just past it,
/// the pulse is not lost; in the opposite case it is not doubled.
TEST(BeamAxis, AnEdgeBetweenTwoSegmentsIsPassedOnce) {
  for (const double jump : {3e-5, -3e-5}) {
    Lines make(4, 0);
    std::mt19937_64 random(4);
    auto machine = std::make_unique<Machine>(0);
    machine->generator.set_position({});
    machine->generator.beam().set_pulse(20);
    std::vector<BeamLine> lines{make.next(1, true, false, false), make.next(1, false, true, false)};
    // One edge at the joint, off by half of the jump; the next edge would be past the end.
    set_beam(lines[0], 0, 0.4 - jump / 2, 0.6, pulse_place_bits, BeamKind::pulses);
    set_beam(lines[1], 0, 0.4, 1 + jump / 2, pulse_place_bits, BeamKind::pulses);
    for (BeamLine& line : lines) line.segments.front().beam.power = 1000;
    lines[0].segments.front().beam_begins = true;
    ASSERT_NO_FATAL_FAILURE(machine->run(lines, make.end_tick() + 100, false, random));
    const std::vector<bool>& gate = machine->board.gate;
    int pulses = 0;
    for (std::size_t t = 1; t < gate.size(); ++t) pulses += gate[t] && !gate[t - 1] ? 1 : 0;
    EXPECT_EQ(pulses, 1) << jump;
    EXPECT_EQ(std::count(gate.begin(), gate.end(), true), 20) << jump;
  }
}

/// Edges faster than the board can follow are merged, and the light is no longer than that of all
/// edges together.
TEST(BeamAxis, EdgesThatAreTooFastAreMerged) {
  Lines make(1, 0);
  std::mt19937_64 random(1);
  auto machine = std::make_unique<Machine>(0);
  machine->generator.set_position({});
  machine->generator.beam().set_pulse(3);
  std::vector<BeamLine> lines{make.next(4, true, true, false)};
  set_beam(lines.front(), 0, std::fabs(lines.front().steps) * 4, 0.5, pulse_place_bits,
           BeamKind::pulses);
  for (Segment& s : lines.front().segments) s.beam.power = 1000;
  ASSERT_NO_FATAL_FAILURE(machine->run(lines, make.end_tick() + 100, false, random));
  std::uint64_t last = 0, shortest = ~0ull, count = 0;
  for (std::uint64_t t = 1; t < machine->board.gate.size(); ++t) {
    if (!machine->board.gate[t] || machine->board.gate[t - 1]) continue;
    if (last != 0) shortest = std::min(shortest, t - last);
    last = t;
    ++count;
  }
  EXPECT_GT(count, 50u);
  EXPECT_GE(shortest, 31u);
  EXPECT_LE(shortest, 33u);
}

/// The ring of powers returns what was stored and accepts no more than it has room for.
TEST(PowerTable, KeepsRunsInOrder) {
  std::mt19937_64 random(5);
  auto table = std::make_unique<PowerTable>();
  for (int i = 0; i < test::scaled(200); ++i) {
    std::vector<std::pair<std::uint16_t, std::uint32_t>> runs;
    std::uint32_t cells = 0;
    for (auto n = 1 + random() % 200; n != 0; --n) {
      const auto count = static_cast<std::uint32_t>(1 + random() % (random() % 10 == 0  ? 20'000
                                                                    : random() % 3 == 0 ? 40
                                                                                        : 1));
      const auto power = static_cast<std::uint16_t>(random());
      if (cells + count > 65'535 || !table->add(power, count)) break;
      cells += count;
      runs.emplace_back(power, count);
    }
    if (runs.empty()) {
      table->forget();
      continue;
    }
    const std::uint16_t list = table->end_list();
    ASSERT_EQ(table->cells(list), cells);
    std::uint16_t place = list;
    for (const auto& [power, count] : runs) {
      for (std::uint32_t left = count; left != 0;) {
        const std::uint16_t run = table->run(++place);
        ASSERT_NEAR(wire::run_power(run), power, 17);
        ASSERT_LE(wire::run_cells(run), left);
        left -= wire::run_cells(run);
      }
    }
    if (random() % 3 == 0) table->release(place);
  }
  EXPECT_EQ(wire::run_power(0xffff), 65'535);
  EXPECT_EQ(wire::run_power(0x001f), 0);
}

TEST(PowerTable, RefusesEntriesWhenFull) {
  auto table = std::make_unique<PowerTable>();
  std::uint32_t added = 0;
  while (table->add(static_cast<std::uint16_t>(added * 37), 1)) ++added;
  EXPECT_EQ(added, PowerTable::capacity - 1);  // the header
  const std::uint16_t list = table->end_list();
  for (std::uint32_t i = 0; i < added; ++i) {
    ASSERT_NEAR(wire::run_power(table->run(static_cast<std::uint16_t>(list + 1 + i))),
                static_cast<std::uint16_t>(i * 37), 17);
  }
  EXPECT_FALSE(table->add(1, 1));
  table->release(static_cast<std::uint16_t>(list + 3));
  EXPECT_TRUE(table->add(1, 1));  // with its header
  table->drop_list();
  EXPECT_TRUE(table->add(1, 32));
  EXPECT_FALSE(table->add(1, 31));
}

}  // namespace
}  // namespace lamplock::stepper
