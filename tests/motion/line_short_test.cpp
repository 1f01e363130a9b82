// Straight runs and curves that a program divides into short lines take the time that they take
// undivided.
#include <numbers>
#include <random>

#include "tests/motion/line_machine.hpp"

namespace lamplock::test::line_short_test {
namespace {

constexpr double pi = std::numbers::pi;

/// A number of a program whose last decimal this is.
double rounded(double mm, double digit_mm) { return std::round(mm / digit_mm) * digit_mm; }
std::uint8_t digit_of(double digit_mm) {
  return static_cast<std::uint8_t>(std::max(1.0, std::ceil(digit_mm * 1000 - 1e-9)));
}

LineTarget target_at(const LineMachine& m, double x, double y, double digit_mm, double mm_s) {
  LineTarget t;
  put_place(t, 0, rounded(x, digit_mm) * m.steps_mm[0]);
  put_place(t, 1, rounded(y, digit_mm) * m.steps_mm[1]);
  t.digit_um = digit_of(digit_mm);
  t.feed_um_min = static_cast<std::uint32_t>(mm_s * 60e3);
  return t;
}

/// Legs of 5 mm that turn left and right by an angle, in pieces.
std::vector<LineTarget> legs(const LineMachine& m, double turn_deg, double piece_mm,
                             double digit_mm) {
  std::vector<LineTarget> targets;
  double x = 0, y = 0, direction = 0.3;
  for (int leg = 0; leg < 8; ++leg) {
    const double leg_mm = 5;
    const int pieces = std::max(1, static_cast<int>(std::lround(leg_mm / piece_mm)));
    for (int i = 1; i <= pieces; ++i)
      targets.push_back(target_at(m, x + std::cos(direction) * leg_mm * i / pieces,
                                  y + std::sin(direction) * leg_mm * i / pieces, digit_mm, 100));
    x += std::cos(direction) * leg_mm, y += std::sin(direction) * leg_mm;
    direction += (leg % 2 == 0 ? 1 : -1) * turn_deg * pi / 180;
  }
  return targets;
}

struct Ride {
  double seconds = 0;
  double accel = 0;  ///< largest of an axis over its limit, over spans of 2 ms
};

/// The planner alone: its lines have no numbers, so it may join them.
class Planned {
 public:
  explicit Planned(const LineMachine& m)
      : limits_(m.limits()), line_limits_(m.line_limits(limits_)) {
    for (stepper::AxisState& a : start_.axis) a.position_q64 = stepper::middle_of_step(0);
    planner_.start(start_);
  }
  std::vector<LineSegment> run(const std::vector<LineTarget>& targets) {
    std::vector<LineSegment> segments;
    std::size_t next = 0;
    for (;;) {
      while (next < targets.size() && planner_.push(targets[next])) ++next;
      LineSegment s;
      if (!planner_.next(s)) return segments;
      segments.push_back(s);
    }
  }

 private:
  motion::Limits limits_;
  motion::LineLimits line_limits_;
  motion::LineRing ring_;
  stepper::MotionState start_;
  motion::LinePlanner planner_{ring_, line_limits_, limits_};
};

Ride ride(const LineMachine& m, const std::vector<LineTarget>& targets) {
  std::vector<std::array<double, 3>> at{{0, 0, 0}};  // s, mm/s
  for (const LineSegment& s : Planned(m).run(targets))
    at.push_back({static_cast<double>(s.segment.end.tick) * 1e-6,
                  line_q62(s.segment.end.axis[0].speed_q62) * 1e6 / m.steps_mm[0],
                  line_q62(s.segment.end.axis[1].speed_q62) * 1e6 / m.steps_mm[1]});
  Ride out;
  out.seconds = at.back()[0];
  constexpr double span_s = 2e-3;
  std::size_t from = 0;
  for (std::size_t i = 1; i < at.size(); ++i) {
    while (at[i][0] - at[from + 1][0] > span_s && from + 1 < i) ++from;
    const double s = at[i][0] - at[from][0];
    if (s < span_s) continue;
    for (const std::size_t a : {1u, 2u})
      out.accel = std::max(out.accel, std::fabs(at[i][a] - at[from][a]) / s / m.accel_mm_s2[a - 1]);
  }
  return out;
}

/// Last decimals of mm, and of inches.
constexpr double digits_mm[] = {0.0001, 0.001, 0.01, 0.0254, 0.00254};
constexpr double pieces_mm[] = {1, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005};

TEST(ShortLines, CornersTakeTheTimeOfLongLines) {
  const LineMachine m;
  for (const double digit : digits_mm) {
    for (const double turn : {30.0, 60.0, 90.0, 120.0, 150.0, 179.0}) {
      const Ride whole = ride(m, legs(m, turn, 5, digit));
      for (const double piece : pieces_mm) {
        SCOPED_TRACE(testing::Message() << digit << " mm, " << turn << " deg, " << piece << " mm");
        const Ride parts = ride(m, legs(m, turn, piece, digit));
        EXPECT_LT(parts.seconds, whole.seconds * (piece < 0.02 ? 1.06 : 1.02));
        EXPECT_LT(parts.accel, 2.7);
      }
    }
  }
}

/// Time along a circle if only the acceleration of an axis limits the speed.
double circle_seconds(double radius_mm, double length_mm, double accel_mm_s2, double mm_s) {
  double seconds = 0, v = mm_s;
  constexpr int parts = 1000;
  for (int i = 0; i < parts; ++i) {
    const double angle = length_mm / radius_mm * i / parts;
    const double along = std::max(std::fabs(std::sin(angle)), std::fabs(std::cos(angle)));
    v = std::min(mm_s, std::sqrt(accel_mm_s2 * radius_mm / along));
    seconds += length_mm / parts / v;
  }
  return seconds + v / accel_mm_s2;
}

TEST(ShortLines, CirclesTakeTheTimeOfTheirCurve) {
  LineMachine m;
  m.accel_mm_s2.fill(1000);
  for (const double digit : digits_mm) {
    for (const double radius : {1.0, 3.0, 10.0, 30.0}) {
      const double length = std::max(2 * pi * radius, 20.0);
      const double best = circle_seconds(radius, length, 1000, 200);
      for (const double piece : pieces_mm) {
        if (piece > radius / 5) continue;  // a polygon
        SCOPED_TRACE(testing::Message() << digit << " mm, R " << radius << ", " << piece << " mm");
        std::vector<LineTarget> targets;
        for (int i = 1; i <= static_cast<int>(length / piece); ++i) {
          const double angle = piece * i / radius;
          targets.push_back(
              target_at(m, radius * std::sin(angle), radius * (1 - std::cos(angle)), digit, 200));
        }
        const Ride parts = ride(m, targets);
        // Lines far shorter than the last decimal are noise: 16 of them still fill the look-ahead.
        const bool is_fine = digit < 0.002 || piece > 2.5 * digit;
        EXPECT_LT(parts.seconds, best * (is_fine ? 1.3 : 2.4));
        EXPECT_LT(parts.accel, is_fine ? 4 : 8);
      }
    }
  }
}

/// The end of a segment, steps.
LineVector end_of(const LineSegment& s) {
  LineVector at{};
  for (std::size_t a = 0; a < 4; ++a)
    at[a] = steps_off_middle(s.segment.end.axis[a].position_q64, 0);
  return at;
}

/// Joined lines pass every place of the program, in order, within what rounding explains, and end
/// on the last place.
TEST(ShortLines, PassEveryPlaceWithinRounding) {
  double joined = 0, all = 0;
  for (int seed = 0; seed < scaled(60); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(static_cast<std::uint64_t>(seed) + 40);
    const auto pick = [&](double low, double high) {
      return low * std::pow(high / low, std::uniform_real_distribution<>(0, 1)(random));
    };
    LineMachine m;
    m.axes = 4;
    for (double& steps : m.steps_mm) steps = pick(6, 800);
    for (std::size_t a = 0; a < 4; ++a) m.speed_mm_s[a] = 9e5 / m.steps_mm[a] / 4;
    const double digit = digits_mm[static_cast<std::size_t>(seed) % std::size(digits_mm)];
    std::vector<LineTarget> targets;
    LineVector at{}, direction{1, 0, 0, 0};
    std::normal_distribution<> normal;
    for (int i = 0; i < 400; ++i) {
      const double bend = random() % 16 == 0 ? 1 : 0.02;
      double squares = 0;
      for (double& d : direction) d += bend * normal(random), squares += d * d;
      const double length = pick(0.002, 0.2);
      for (std::size_t a = 0; a < 4; ++a) at[a] += length * (direction[a] /= std::sqrt(squares));
      LineTarget t = target_at(m, at[0], at[1], digit, 50);
      put_place(t, 2, rounded(at[2], digit) * m.steps_mm[2]);
      put_place(t, 3, rounded(at[3], digit) * m.steps_mm[3]);
      targets.push_back(t);
    }
    LineVector from{};
    std::size_t next = 0;
    for (const LineSegment& s : Planned(m).run(targets)) {
      if (!s.ends_line) continue;
      const LineVector to = end_of(s);
      for (bool reached = false; !reached; ++next) {
        ASSERT_LT(next, targets.size());
        double along = 0, length_2 = 0;
        LineVector way{}, line{};
        for (std::size_t a = 0; a < 4; ++a) {
          way[a] = (steps_at(targets[next], a) - from[a]) / m.steps_mm[a];
          line[a] = (to[a] - from[a]) / m.steps_mm[a];
          along += way[a] * line[a], length_2 += line[a] * line[a];
        }
        reached = true;
        for (std::size_t a = 0; a < 4; ++a) {
          const double off_mm = std::fabs(way[a] - line[a] * std::min(1.0, along / length_2));
          // Places have 1/256 of a step of the coarsest axis.
          const double place_mm = 2.0 / 256 / m.coarsest();
          EXPECT_LT(off_mm, 1.1e-3 * digit_of(digit) + 0.08 / m.steps_mm[a] + place_mm)
              << "place " << next;
          if (std::fabs(steps_at(targets[next], a) - to[a]) > 1e-3) reached = false;
        }
        ++all;
        if (!reached) ++joined;
      }
      from = to;
    }
    // Places that the program repeats are no lines.
    while (next < targets.size() && steps_at(targets[next], 0) == steps_at(targets[next - 1], 0))
      ++next;
    EXPECT_EQ(next, targets.size());
  }
  EXPECT_GT(joined / all, 0.3);
}

}  // namespace
}  // namespace lamplock::test::line_short_test
