#include "host/cli/progress.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <tuple>
#include <utility>

#include "host/duration_text.hpp"
#include "host/number_text.hpp"
#include "host/printable.hpp"
#include "host/remark.hpp"

namespace lamplock::cli {
namespace {

constexpr std::size_t max_bar_width = 30, min_bar_width = 10;
constexpr std::size_t line_every_percent = 10;
/// What is over sooner needs no line.
constexpr std::chrono::milliseconds line_interval{500};

std::size_t percent(std::size_t done, std::size_t total) {
  return total == 0 ? 100 : done * 100 / total;
}

constexpr double end_shown_from_s = 60;
constexpr std::time_t day_s = 24 * 3600;
/// The time of the end is not shown for what takes longer.
constexpr double end_shown_to_s = 1e8;

/// The time left and the time of the end; an empty text where it is not known or not of use.
std::pair<std::string, std::string> left_and_end(double seconds, std::time_t now) {
  if (!(seconds >= end_shown_from_s))
    return {whole_seconds_text(std::max(0.0, seconds)) + " left", ""};
  if (seconds > end_shown_to_s) return {"years left", ""};
  const std::time_t end = now + static_cast<std::time_t>(seconds);
  const std::tm local = fmt::localtime(end);
  return {whole_seconds_text(seconds) + " left", end - now < day_s
                                                     ? fmt::format("ends {:%H:%M}", local)
                                                     : fmt::format("ends {:%F %H:%M}", local)};
}

/// The fields in their order on the line.
enum Field : std::size_t { title, bar, percentage, count, state, speed, left, ends, typed, fields };

/// The order in which they are left out; the time left of a machine that is held can wait.
constexpr std::array left_out_first{bar, ends, count, speed, left, title, state, typed};
constexpr std::array left_out_first_at_rest{bar, ends, count, left, speed, title, state, typed};

using FieldTexts = std::array<std::string, fields>;

std::size_t length_of(const FieldTexts& texts) {
  std::size_t length = 0;
  for (const std::string& text : texts) length += text.size();
  return length;
}

std::string bar_text(std::size_t done, std::size_t total, std::size_t width) {
  const std::size_t filled = percent(done, total) * width / 100;
  return fmt::format(" [{:#<{}}{:-<{}}]", "", filled, "", width - filled);
}

std::string after_comma(const std::string& text) { return text.empty() ? "" : ", " + text; }

}  // namespace

std::string left_text(double seconds, std::time_t now) {
  const auto [left, ends] = left_and_end(seconds, now);
  return after_comma(left) + after_comma(ends);
}

std::string progress_line(const ProgressFields& shown, std::size_t columns) {
  const std::size_t frame = bar_text(0, 1, 0).size();
  FieldTexts texts{shown.title,
                   "",
                   fmt::format(" {:3} %", percent(shown.done, shown.total)),
                   fmt::format(", {} of {}", grouped(shown.done), grouped(shown.total)),
                   after_comma(shown.state),
                   after_comma(shown.speed),
                   after_comma(shown.left),
                   after_comma(shown.ends),
                   shown.typed.empty() ? "" : " > " + shown.typed};
  const std::size_t others = length_of(texts) + frame;
  if (others + min_bar_width <= columns)
    texts[bar] = bar_text(shown.done, shown.total, std::min(max_bar_width, columns - others));
  for (const Field field : shown.state.empty() ? left_out_first : left_out_first_at_rest)
    if (length_of(texts) > columns) texts[field].clear();
  std::string line;
  for (const std::string& text : texts) line += text;
  return line.substr(0, columns);
}

ProgressBar::ProgressBar(std::string title, std::size_t total, std::size_t first)
    : title_(std::move(title)),
      total_(total),
      first_(first),
      done_(first),
      next_line_percent_((percent(first, total) / line_every_percent + 1) * line_every_percent) {
  if (!LiveLine::can_show(stderr)) return;
  quiet_.emplace(QuietTerminal::Reads::lines);
  line_.emplace(stderr, [this](std::size_t columns) { return progress_line(fields(), columns); });
}

void ProgressBar::update(std::size_t done) {
  done_ = done;
  if (line_) return line_->refresh();
  const std::size_t now = percent(done, total_);
  if (now < next_line_percent_ || Clock::now() - printed_at_ < line_interval) return;
  printed_at_ = Clock::now();
  next_line_percent_ = (now / line_every_percent + 1) * line_every_percent;
  const auto left = left_s(done);
  write_remark(fmt::format("{}: {} %, {} of {}{}\n", title_, now, grouped(done), grouped(total_),
                           left ? left_text(*left, std::time(nullptr)) : ""));
}

void ProgressBar::set_state(const run::ProgressState& state) {
  if (state.word.empty() != is_working() || state.speed != state_.speed) {
    const auto now = Clock::now();
    if (is_working()) worked_ += now - working_since_;
    working_since_ = now;
  }
  if (state.speed != state_.speed) {
    worked_ = Clock::duration{0};
    first_ = done_;
  }
  state_ = state;
}

void ProgressBar::note(const std::string& line) {
  if (line_) return line_->note(printable(line));
  write_remark(printable(line) + '\n');
}

std::optional<double> ProgressBar::left_s(std::size_t done) const {
  if (left_s_) return left_s_;
  if (done <= first_ || done >= total_) return std::nullopt;
  const std::chrono::duration<double> taken =
      worked_ + (is_working() ? Clock::now() - working_since_ : Clock::duration{0});
  const double pace = taken.count() / static_cast<double>(done - first_);
  return pace * static_cast<double>(total_ - done);
}

ProgressFields ProgressBar::fields() const {
  ProgressFields shown{title_, done_, total_, state_.word, state_.speed, "", "", state_.typed};
  if (const auto left = left_s(done_)) {
    std::tie(shown.left, shown.ends) = left_and_end(*left, std::time(nullptr));
    // A machine that is held has no time of its end.
    if (!is_working()) shown.ends.clear();
  }
  return shown;
}

}  // namespace lamplock::cli
