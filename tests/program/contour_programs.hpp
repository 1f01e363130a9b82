// Random programs with cutter compensation, for tests.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace lamplock::program::test {

/// A line or an arc of a contour, mm; anticlockwise if the sweep is above 0.
struct ContourBlock {
  std::array<double, 2> from{}, to{}, centre{};
  double sweep = 0;  ///< of an arc; 0: a line
};

inline double contour_distance(const ContourBlock& block, double x, double y) {
  const double dx = x - block.from[0], dy = y - block.from[1];
  const double ex = block.to[0] - block.from[0], ey = block.to[1] - block.from[1];
  if (block.sweep == 0) {
    const double along = (dx * ex + dy * ey) / (ex * ex + ey * ey);
    const double t = std::fmin(1, std::fmax(0, along));
    return std::hypot(dx - t * ex, dy - t * ey);
  }
  const auto angle = [&](const std::array<double, 2>& at) {
    return std::atan2(at[1] - block.centre[1], at[0] - block.centre[0]);
  };
  constexpr double turn = 2 * std::numbers::pi;
  const double sign = block.sweep < 0 ? -1 : 1;
  double to = std::fmod(sign * (angle({x, y}) - angle(block.from)), turn);
  if (to < 0) to += turn;
  const double radius =
      std::hypot(block.from[0] - block.centre[0], block.from[1] - block.centre[1]);
  if (to <= std::abs(block.sweep))
    return std::abs(std::hypot(x - block.centre[0], y - block.centre[1]) - radius);
  return std::fmin(std::hypot(dx, dy), std::hypot(x - block.to[0], y - block.to[1]));
}

/// A place on a block; `part` from 0 to 1.
inline std::array<double, 2> contour_place(const ContourBlock& block, double part) {
  if (block.sweep == 0)
    return {block.from[0] + (block.to[0] - block.from[0]) * part,
            block.from[1] + (block.to[1] - block.from[1]) * part};
  const double x = block.from[0] - block.centre[0], y = block.from[1] - block.centre[1];
  const double c = std::cos(block.sweep * part), s = std::sin(block.sweep * part);
  return {block.centre[0] + x * c - y * s, block.centre[1] + x * s + y * c};
}

/// Makes programs: an approach, an entry, a contour, an exit.
class ContourPrograms {
 public:
  explicit ContourPrograms(unsigned seed) : random_(seed) {}

  /// A contour of lines and arcs at random; also such that the cutter does not fit.
  std::vector<std::string> any_program() {
    begin(random_() % 2 == 0);
    std::vector<std::string> lines{"G0 X0 Y0 Z0", relative_ ? "G91" : "G90",
                                   on(0.1 + 0.9 * part())};
    const double angle = part() * 2 * std::numbers::pi, length = random_() % 12 == 0 ? 0.4 : 3;
    lines.push_back(
        line_to("G1", at_[0] + length * std::cos(angle), at_[1] + length * std::sin(angle)));
    for (auto left = 3 + random_() % 6; left != 0; --left) {
      if (random_() % 8 == 0) lines.push_back(between());
      lines.push_back(random_() % 3 == 0 ? random_arc() : random_line());
    }
    if (random_() % 4 == 0) lines.push_back(between());
    lines.emplace_back("G40");
    lines.push_back(line_to("G0", 0, 0));
    return lines;
  }

  /// A closed contour round (0, 0) without narrow places, some of its sides arcs; the entry is on
  /// one side.
  std::vector<std::string> ring_program(double radius) {
    begin(random_() % 2 == 0);
    const auto sides = 5 + random_() % 8;
    const bool backward = random_() % 2 == 0;
    std::vector<std::array<double, 2>> corners;
    for (unsigned i = 0; i < sides; ++i) {
      const double angle = (backward ? -1 : 1) * 2 * std::numbers::pi * (i + 0.4 * part()) /
                           static_cast<double>(sides);
      const double r = 8 + 6 * part();
      corners.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
    // From the middle of the last side, where the contour ends as well.
    const std::array<double, 2> first = corners.front(), last = corners.back();
    const std::array<double, 2> middle{(first[0] + last[0]) / 2, (first[1] + last[1]) / 2};
    std::vector<std::string> lines{fmt::format("G0 X{:.6f} Y{:.6f}", last[0], last[1]),
                                   relative_ ? "G91" : "G90", on(radius)};
    at_ = {rounded(last[0]), rounded(last[1])};
    lines.push_back(line_to("G1", middle[0], middle[1]));
    contour_.clear();
    for (std::size_t i = 0; i < corners.size(); ++i)
      lines.push_back(i != 0 && random_() % 3 == 0 ? arc_to(corners[i], (part() - 0.5) * 0.7)
                                                   : line_to("G1", corners[i][0], corners[i][1]));
    lines.push_back(line_to("G1", middle[0], middle[1]));
    lines.emplace_back("G40");
    return lines;
  }

  /// The blocks after the entry.
  const std::vector<ContourBlock>& contour() const { return contour_; }
  /// Of the cutter.
  double radius() const { return radius_; }
  /// Distance between blocks that are not neighbours; the first block and the last one are.
  double narrowest() const {
    constexpr int samples = 50;
    double least = 1e9;
    for (std::size_t i = 0; i < contour_.size(); ++i)
      for (std::size_t k = i + 2; k < contour_.size() - (i == 0 ? 1 : 0); ++k)
        for (int s = 0; s <= samples; ++s) {
          const std::array<double, 2> at =
              contour_place(contour_[i], static_cast<double>(s) / samples);
          least = std::fmin(least, contour_distance(contour_[k], at[0], at[1]));
        }
    return least;
  }

 private:
  double part() { return static_cast<double>(random_() % 10001) / 10000; }
  static double rounded(double mm) { return std::round(mm * 1e6) / 1e6; }

  void begin(bool relative) {
    relative_ = relative;
    at_ = {};
    contour_.clear();
    heading_ = 0;
  }
  std::string on(double radius) {
    radius_ = radius;
    return fmt::format("G4{}.1 D{:.4f}", 1 + random_() % 2, 2 * radius);
  }
  std::string between() {
    switch (random_() % 3) {
      case 0:
        return fmt::format("G1 Z{}", relative_ ? "0.5" : one_of_levels());
      case 1:
        return "G4 P.5";
      default:
        return "M3 S50";
    }
  }
  const char* one_of_levels() { return random_() % 2 == 0 ? "1.5" : "2"; }
  std::string words(double x, double y) const {
    return fmt::format("X{:.6f} Y{:.6f}", x - (relative_ ? at_[0] : 0),
                       y - (relative_ ? at_[1] : 0));
  }
  std::string line_to(const char* code, double x, double y) {
    x = rounded(x);
    y = rounded(y);
    std::string text = fmt::format("{} {}", code, words(x, y));
    heading_ = std::atan2(y - at_[1], x - at_[0]);
    contour_.push_back({at_, {x, y}, {}, 0});
    at_ = {x, y};
    return text;
  }
  /// A corner that is neither nearly straight nor a reversal: there rs274 has other rules.
  double turn() {
    const double degrees = 5 + 165 * part();
    return (random_() % 2 == 0 ? -1 : 1) * degrees * std::numbers::pi / 180;
  }
  std::string random_line() {
    const double angle = heading_ + turn(), length = 0.5 + 6 * part();
    return line_to("G1", at_[0] + length * std::cos(angle), at_[1] + length * std::sin(angle));
  }
  std::string random_arc() {
    const bool left = random_() % 2 == 0;
    const double tangent = random_() % 3 == 0 ? heading_ : heading_ + turn(),
                 radius = 0.4 + 4 * part();
    const double side = (left ? 1 : -1) * std::numbers::pi / 2;
    const std::array<double, 2> centre{rounded(at_[0] + radius * std::cos(tangent + side)),
                                       rounded(at_[1] + radius * std::sin(tangent + side))};
    const double sweep = (left ? 1 : -1) * (20 + 300 * part()) * std::numbers::pi / 180;
    const double end = tangent - side + sweep;
    return arc(rounded(centre[0] + radius * std::cos(end)),
               rounded(centre[1] + radius * std::sin(end)), centre, sweep);
  }
  /// `bulge`: height over half of the chord, -1 to 1.
  std::string arc_to(const std::array<double, 2>& to, double bulge) {
    if (std::abs(bulge) < 0.1) return line_to("G1", to[0], to[1]);
    const double x = rounded(to[0]), y = rounded(to[1]);
    const double half_sweep = 2 * std::atan(bulge);  // to the left: anticlockwise
    const double back = 1 / std::tan(half_sweep) / 2;
    const std::array<double, 2> centre{rounded((at_[0] + x) / 2 - (y - at_[1]) * back),
                                       rounded((at_[1] + y) / 2 + (x - at_[0]) * back)};
    return arc(x, y, centre, 2 * half_sweep);
  }
  std::string arc(double x, double y, const std::array<double, 2>& centre, double sweep) {
    std::string text = fmt::format("G{} {} I{:.6f} J{:.6f}", sweep < 0 ? 2 : 3, words(x, y),
                                   centre[0] - at_[0], centre[1] - at_[1]);
    contour_.push_back({at_, {x, y}, centre, sweep});
    at_ = {x, y};
    heading_ =
        std::atan2(y - centre[1], x - centre[0]) + (sweep < 0 ? -1 : 1) * std::numbers::pi / 2;
    return text;
  }

  std::mt19937 random_;
  bool relative_ = false;
  std::array<double, 2> at_{};
  double heading_ = 0, radius_ = 0;
  std::vector<ContourBlock> contour_;
};

}  // namespace lamplock::program::test
