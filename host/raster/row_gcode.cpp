#include "host/raster/row_gcode.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/units.hpp"
#include "shared/units.hpp"
#include "shared/wire/framing.hpp"

namespace lamplock::raster {
namespace {

using settings::Id;

constexpr double max_s_word = 65'535;
/// Maximum decimals of a G-code number (docs/gcode.md).
constexpr int max_decimals = 7;

/// A number without trailing zeros.
std::string number(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (decimals == 0) return text;
  const auto last = text.find_last_not_of('0');
  text.resize(text[last] == '.' ? last : last + 1);
  return text == "-0" ? "0" : text;
}

/// Writes one job.
class Writer {
 public:
  Writer(const job::Job& job, PowerForm form)
      : job_(job), form_(form), full_s_(in_units(job.settings, Id::max_spindle_speed)) {}

  std::string program() {
    text_ = "(Rows of pixels, by lamplock raster)\nG21 G90 G94\n";
    text_ += job_.header.dry ? "M5\n" : "M4 S0\n";
    for (const job::Line& line : job_.rows.lines) {
      if (line.to.light)
        add_row(line);
      else
        text_ += "G0" + place(line.to.steps) + "\n";
      at_ = line.to.steps;
    }
    return text_ + "M5\nM2\n";
  }

 private:
  double mm(double steps, int axis) const {
    return steps / in_units(job_.settings, Id::steps_per_mm_x, axis);
  }

  std::string place(const StepPosition& steps) const {
    std::string text;
    for (int axis = 0; axis < job_.header.axes; ++axis)
      text += fmt::format(" {}{}", axis_letters[index(axis)],
                          number(mm(steps[index(axis)], axis), max_decimals));
    return text;
  }

  /// The shortest S word that the board reads as this power.
  const std::string& s_word(std::uint16_t run) {
    std::string& word = words_[run >> wire::run_code_bits];
    for (int decimals = 0; word.empty(); ++decimals) {
      std::string text = number(wire::run_power(run) / max_s_word * full_s_, decimals);
      const double power = std::stod(text) / full_s_ * max_s_word;
      const auto heard = wire::max_run(static_cast<std::uint16_t>(std::lround(power)), 1);
      if (heard >> wire::run_code_bits == run >> wire::run_code_bits || decimals == max_decimals)
        word = std::move(text);
    }
    return word;
  }

  using Runs = std::span<const std::uint16_t>;

  static std::uint32_t cells_of(Runs runs) {
    std::uint32_t cells = 0;
    for (const std::uint16_t run : runs) cells += wire::run_cells(run);
    return cells;
  }
  /// Removes the first runs of one power; returns their number of cells.
  static std::uint32_t take_stretch(Runs& runs) {
    const int power = runs.front() >> wire::run_code_bits;
    std::uint32_t cells = 0;
    for (; !runs.empty() && runs.front() >> wire::run_code_bits == power; runs = runs.subspan(1))
      cells += wire::run_cells(runs.front());
    return cells;
  }
  /// The move to the end of this part of a row. Rows are parallel to X.
  void add_move(const job::Line& line, double part) {
    const double to = at_[0] + part * (static_cast<double>(line.to.steps[0]) - at_[0]);
    text_ += fmt::format("G1 X{}", number(mm(to, 0), max_decimals));
    if (std::exchange(feed_milli_, line.to.feed_milli) != line.to.feed_milli)
      text_ += fmt::format(" F{}", number(line.to.feed_milli / milli_per_unit, 3));
  }

  void add_row(const job::Line& line) {
    if (job_.header.dry) {
      add_move(line, 1);
      text_ += "\n";
    } else if (form_ == PowerForm::lists) {
      add_lists(line);
    } else {
      add_stretches(line);
    }
  }

  /// A line of text for each stretch of one power.
  void add_stretches(const job::Line& line) {
    Runs runs = job_.rows.runs_of(line);
    const std::uint32_t all = cells_of(runs);
    for (std::uint32_t done = 0; !runs.empty();) {
      const std::string& power = s_word(runs.front());
      done += take_stretch(runs);
      add_move(line, static_cast<double>(done) / all);
      text_ += " S" + power + "\n";
    }
  }

  /// Lines of text with as many cells as fit into each.
  void add_lists(const job::Line& line) {
    Runs runs = job_.rows.runs_of(line);
    const std::uint32_t all = cells_of(runs);
    std::uint32_t done = 0;
    // Room for the words before the list.
    constexpr std::size_t other_words = 64, max_list_size = wire::max_line - other_words;
    while (!runs.empty()) {
      std::string list;
      while (!runs.empty() && list.size() < max_list_size) {
        list += (list.empty() ? "S" : ":") + s_word(runs.front());
        const std::uint32_t cells = take_stretch(runs);
        if (cells != 1) list += fmt::format("*{}", cells);
        done += cells;
      }
      add_move(line, static_cast<double>(done) / all);
      text_ += " " + list + "\n";
    }
  }

  const job::Job& job_;
  const PowerForm form_;
  const double full_s_;  ///< S word of full power
  std::vector<std::string> words_ = std::vector<std::string>(1u << wire::run_power_bits);
  std::string text_;
  StepPosition at_{};
  std::uint32_t feed_milli_ = 0;
};

}  // namespace

std::string row_gcode(const job::Job& job, PowerForm form) { return Writer(job, form).program(); }

}  // namespace lamplock::raster
