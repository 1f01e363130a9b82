#include "host/cli/progress.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "host/printable.hpp"

namespace lamplock::cli {
namespace {

constexpr std::size_t bar_width = 30;
constexpr std::size_t line_every_percent = 10;
constexpr std::chrono::milliseconds redraw_interval{50};
/// What is over sooner needs no line.
constexpr std::chrono::milliseconds line_interval{500};
/// Back to the start of the line and clear it (ECMA-48).
constexpr const char* clear_line = "\r\033[K";

std::size_t percent(std::size_t done, std::size_t total) {
  return total == 0 ? 100 : done * 100 / total;
}

std::string clock_text(double seconds) {
  const auto s = static_cast<long long>(std::ceil(seconds));
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

constexpr double told_from_s = 60;
constexpr std::time_t day_s = 24 * 3600;
/// What takes longer has no end that is worth telling.
constexpr double told_to_s = 1e8;

}  // namespace

std::string left_text(double seconds, std::time_t now) {
  if (!(seconds >= told_from_s))
    return fmt::format(", {} left", clock_text(std::max(0.0, seconds)));
  if (seconds > told_to_s) return ", years left";
  const std::time_t end = now + static_cast<std::time_t>(seconds);
  const std::tm local = fmt::localtime(end);
  const std::string ends =
      end - now < day_s ? fmt::format("{:%H:%M}", local) : fmt::format("{:%F %H:%M}", local);
  return fmt::format(", {} left, ends {}", clock_text(seconds), ends);
}

ProgressBar::ProgressBar(std::string title, std::size_t total, std::size_t first)
    : title_(std::move(title)),
      total_(total),
      first_(first),
      terminal_(::isatty(STDERR_FILENO) == 1),
      next_line_percent_((percent(first, total) / line_every_percent + 1) * line_every_percent) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::update(std::size_t done) {
  if (terminal_) {
    const auto now = Clock::now();
    if (now - drawn_at_ < redraw_interval) return;
    drawn_at_ = now;
    return draw(done);
  }
  const std::size_t now = percent(done, total_);
  if (now < next_line_percent_ || Clock::now() - drawn_at_ < line_interval) return;
  drawn_at_ = Clock::now();
  next_line_percent_ = (now / line_every_percent + 1) * line_every_percent;
  fmt::print(stderr, "{}: {} %, {} of {}{}\n", title_, now, done, total_, left(done));
}

void ProgressBar::note(const std::string& line) {
  clear();
  fmt::print(stderr, "{}\n", printable(line));
}

std::string ProgressBar::left(std::size_t done) const {
  if (left_s_) return left_text(*left_s_, std::time(nullptr));
  if (done <= first_ || done >= total_) return "";
  const std::chrono::duration<double> taken = Clock::now() - start_;
  const double pace = taken.count() / static_cast<double>(done - first_);
  return left_text(pace * static_cast<double>(total_ - done), std::time(nullptr));
}

void ProgressBar::draw(std::size_t done) {
  const std::size_t filled = percent(done, total_) * bar_width / 100;
  fmt::print(stderr, "{}{} [{:#<{}}{:-<{}}] {:3} %, {} of {}{}", clear_line, title_, "", filled, "",
             bar_width - filled, percent(done, total_), done, total_, left(done));
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::clear() {
  if (!drawn_) return;
  std::fputs(clear_line, stderr);  // never throws: a destructor calls this
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace lamplock::cli
