#include "host/feed_optimiser/feed_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "host/feed_optimiser/motion_meter.hpp"

namespace lamplock::feed_optimiser {
namespace {

/// Chords of an arc are as close to it as the firmware's (setting 12, 0.002 mm).
constexpr double max_sagitta_mm = 0.002;
/// A shorter piece has no direction in the decimals of the program.
constexpr double min_piece_mm = 0.002;
constexpr double s_per_min = 60;
constexpr unsigned xy = 3;  // of all_axes

std::string axis_words(const Point& p, const Point& origin, unsigned axes) {
  const std::array<double, feed_optimiser::axes> at{p.x - origin.x, p.y - origin.y, p.z - origin.z};
  std::string words;
  for (std::size_t a = 0; a < at.size(); ++a)
    if ((axes >> a & 1u) != 0) words += fmt::format(" {}{:.5f}", "XYZ"[a], at[a] + 0.0);
  return words;
}

/// A board without a Z axis refuses Z words: they are left out where nothing moves along Z.
bool moves_z(const FeedProgram& program, const Point& origin) {
  for (const Part& part : program.parts)
    for (const Block& block : part.blocks)
      if (block.from.z != origin.z || block.to.z != origin.z ||
          (block.arc && block.arc->along != 2))
        return true;
  return false;
}

/// Writes lines, and the laser where it changes.
class Writer {
 public:
  Writer(const FeedProgram& program, const Point& origin)
      : program_(program), origin_(origin), axes_(moves_z(program, origin) ? all_axes : xy) {
    text_ = "G21 G90 G94 G17\n";
  }

  void begin(const Part& part) {
    for (const std::string& line : part.lines_before) {
      text_ += line + '\n';
      if (line.starts_with("M3") || line.starts_with("M4") || line.starts_with("M5")) code_.clear();
    }
    if (part.blocks.empty()) return;
    if (is_first_ && program_.start) text_ += move("G0", *program_.start, all_axes) + '\n';
    is_first_ = false;
    if (part.laser.code.empty() || part.blocks.front().rapid) return;
    if (part.laser.code != code_) {
      text_ += part.laser.code;
      if (part.laser.code != "M5") text_ += s_word_ = fmt::format(" S{:.3f}", part.laser.s);
      text_ += '\n';
    }
    code_ = part.laser.code;
  }

  void rapid(const Block& block) { text_ += move("G0", block.to, block.placed_axes) + '\n'; }
  /// To a place of the block.
  void feed(const Block& block, const Point& to, double feed_mm_s, double s) {
    text_ += move("G1", to, block.placed_axes) + fmt::format(" F{:.3f}", feed_mm_s * s_per_min);
    if (!code_.empty() && code_ != "M5")
      if (std::string word = fmt::format(" S{:.3f}", s); word != s_word_) {
        text_ += word;
        s_word_ = std::move(word);
      }
    text_ += '\n';
  }
  std::string finish() {
    for (const std::string& line : program_.lines_after) text_ += line + '\n';
    return std::move(text_);
  }

 private:
  std::string move(const char* code, const Point& to, unsigned axes) const {
    return code + axis_words(to, origin_, axes & axes_);
  }

  const FeedProgram& program_;
  const Point origin_;
  const unsigned axes_;  ///< of the machine
  bool is_first_ = true;
  std::string text_, code_, s_word_;
};

double max_piece_mm(const Block& block) {
  if (!block.arc) return block.length_mm;
  return std::max(std::sqrt(8 * block.arc->radius_mm * max_sagitta_mm), min_piece_mm);
}

void write_block(Writer& writer, const OptimisedBlock& optimised, const Laser& laser,
                 double piece_s) {
  const double period = optimised.table->period_s(), max_mm = max_piece_mm(optimised.block);
  const std::vector<double> s = distances(optimised.profile, optimised.task, *optimised.table);
  std::size_t begun = 0;
  const std::size_t last = s.size() - 1;
  for (std::size_t i = 1; i <= last; ++i) {
    const double length = s[i] - s[begun], time = static_cast<double>(i - begun) * period;
    const bool is_full = time + period > piece_s || (i < last && s[i + 1] - s[begun] > max_mm);
    if (i != last && (!is_full || length < min_piece_mm || s[last] - s[i] < min_piece_mm)) continue;
    const double feed = length / time, programmed = optimised.block.feed_mm_s;
    // M4 scales the power by the speed over the feed: with a lower feed this has to be in S.
    const bool scales = laser.code == "M4" && std::isfinite(programmed);
    const double power = scales ? laser.s * std::min(1.0, feed / programmed) : laser.s;
    // The way of one control period may be longer than a chord.
    const auto chords = static_cast<std::size_t>(std::max(1.0, std::ceil(length / max_mm - 1e-9)));
    const double chord_mm = length / static_cast<double>(chords);
    for (std::size_t k = 1; k < chords; ++k)
      writer.feed(optimised.block, optimised.block.at(s[begun] + static_cast<double>(k) * chord_mm),
                  feed, power);
    writer.feed(optimised.block, i == last ? optimised.block.to : optimised.block.at(s[i]), feed,
                power);
    begun = i;
  }
}

}  // namespace

std::vector<Block> FeedProgram::all_blocks() const {
  std::vector<Block> blocks;
  for (const Part& part : parts)
    blocks.insert(blocks.end(), part.blocks.begin(), part.blocks.end());
  return blocks;
}

std::string rapid_line(const Block& block) {
  return "G0" + axis_words(block.to, {}, block.placed_axes);
}

void join_straight(FeedProgram& program, const Method& method) {
  for (Part& part : program.parts) part.blocks = join_straight(part.blocks, method);
}

std::string plain_program(const FeedProgram& program, const Point& origin, double feed_mm_s) {
  Writer writer(program, origin);
  for (const Part& part : program.parts) {
    writer.begin(part);
    for (const Block& block : part.blocks) {
      if (block.rapid) {
        writer.rapid(block);
        continue;
      }
      const auto pieces = static_cast<std::size_t>(
          std::max(1.0, std::ceil(block.length_mm / max_piece_mm(block) - 1e-9)));
      const double feed = std::isfinite(block.feed_mm_s) ? block.feed_mm_s : feed_mm_s;
      for (std::size_t i = 1; i <= pieces; ++i)
        writer.feed(block,
                    i == pieces ? block.to
                                : block.at(block.length_mm * static_cast<double>(i) /
                                           static_cast<double>(pieces)),
                    feed, part.laser.s);
    }
  }
  return writer.finish();
}

std::string optimised_program(const FeedProgram& program,
                              const std::vector<OptimisedBlock>& optimised, const Point& origin,
                              double piece_s) {
  Writer writer(program, origin);
  std::size_t next = 0;
  for (const Part& part : program.parts) {
    writer.begin(part);
    for (const Block& block : part.blocks) {
      if (block.rapid)
        writer.rapid(block);
      else
        write_block(writer, optimised[next], part.laser, piece_s);
      ++next;
    }
  }
  return writer.finish();
}

void points_csv(const std::vector<OptimisedBlock>& optimised,
                const std::function<void(std::string_view)>& write) {
  write("block,line,step,time_s,x_mm,y_mm,z_mm,distance_mm,speed_mm_s,jerk_mm_s3\n");
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  std::size_t number = 0, steps_before = 0;
  for (const OptimisedBlock& block : optimised) {
    ++number;
    const std::vector<Point> at = places(block);
    const std::vector<double> s = distances(block.profile, block.task, *block.table),
                              jerk = law_values(block.profile, *block.table);
    const double period = block.table->period_s();
    for (std::size_t i = number == 1 ? 0 : 1; i < at.size(); ++i) {
      const double speed = i == 0 ? 0 : (s[i] - s[i - 1]) / period;
      fmt::format_to(out, "{},{},{},{:.7f},{},{},{},{:.9f},{:.6f},{:.6f}\n", number,
                     block.block.line, i, static_cast<double>(steps_before + i) * period, at[i].x,
                     at[i].y, at[i].z, s[i], speed + 0.0, i == 0 ? 0.0 : jerk[i - 1] + 0.0);
    }
    steps_before += block.profile.steps();
    write({text.data(), text.size()});
    text.clear();
  }
}

}  // namespace lamplock::feed_optimiser
