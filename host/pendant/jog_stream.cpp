#include "host/pendant/jog_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/link/line_port.hpp"
#include "host/units.hpp"
#include "shared/gcode_errors.hpp"

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;
using settings::Id;

constexpr double s_per_min = 60;

/// Distance sent ahead of the machine, and length of an increment, as times at the jog speed:
/// enough for a round of the loop and of the cable (16 ms with slow adapters), and for planning.
constexpr Time lead = 60ms, increment = 10ms;
/// Steps are accepted that far ahead.
constexpr Time step_lead = 250ms;
/// Increments without answer.
constexpr std::size_t max_unanswered = 8;
/// Maximum age of a reported position.
constexpr double report_age_s = 0.15;
/// The last digit of a line.
constexpr double resolution_mm = 0.001;
/// A cancel that had no effect is sent again.
constexpr Time cancel_interval = 50ms;

double seconds(Time time) { return std::chrono::duration<double>(time).count(); }
Time time_of(double s) { return Time(static_cast<Time::rep>(std::llround(s * 1e6))); }

double length(const PerAxis<double>& way) {
  double sum = 0;
  for (const double mm : way) sum += mm * mm;
  return std::sqrt(sum);
}

PerAxis<double> unit(PerAxis<double> way) {
  const double all = length(way);
  for (double& mm : way) mm = all > 0 ? mm / all : 0;
  return way;
}

PerAxis<double> unit(const Direction& direction) {
  PerAxis<double> way{};
  for (std::size_t a = 0; a < way.size(); ++a) way[a] = direction[a];
  return unit(way);
}

}  // namespace

JogLimits jog_limits(const settings::Values& values) {
  JogLimits limits;
  limits.axes = static_cast<int>(values.whole(Id::axes));
  for (int a = 0; a < max_axes; ++a) {
    limits.rate_mm_min[index(a)] = in_units(values, Id::max_rate_x, a);
    limits.acceleration_mm_s2[index(a)] = in_units(values, Id::acceleration_x, a);
  }
  return limits;
}

/// The feed along the path is limited so that no axis exceeds its rate: the board would slow down,
/// and the time sent ahead would be wrong.
double JogStream::max_feed(const Way& direction, double feed_mm_min) const {
  for (int a = 0; a < max_axes; ++a)
    if (const double share = std::abs(direction[index(a)]); share > 0)
      feed_mm_min = std::min(feed_mm_min, limits_.rate_mm_min[index(a)] / share);
  return feed_mm_min;
}

void JogStream::run(const Direction& direction, double feed_mm_min, Time until) {
  const Way along = unit(direction);
  const double feed = max_feed(along, feed_mm_min);
  if (!(feed > 0) || direction == Direction{}) return stop();
  wanted_ = Run{along, feed / s_per_min, until};
  ends_at_.reset();
  travels_ = false;
}

bool JogStream::travel(const Way& way_mm, double feed_mm_min, Time until) {
  if (wanted_ || moves_ || stopping_ || !talk_.answers()) return false;
  const Way along = unit(way_mm);
  const double feed = max_feed(along, feed_mm_min);
  if (!(feed > 0) || length(way_mm) < resolution_mm) return false;
  wanted_ = Run{along, feed / s_per_min, until, length(way_mm)};
  ends_at_.reset();
  travels_ = true;
  return true;
}

void JogStream::extend(Time until) {
  if (!travels_) return;
  if (wanted_) wanted_->until = until;
  if (ends_at_) ends_at_ = until;
}

int JogStream::step(int axis, double step_mm, int count, double feed_mm_min) {
  if (wanted_ || goes_ || stopping_ || !talk_.answers()) return 0;
  if (count == 0 || !(step_mm > 0)) return 0;
  Way direction{};
  direction[index(axis)] = count > 0 ? 1 : -1;
  const double feed = max_feed(direction, feed_mm_min);
  if (!(feed > 0)) return 0;
  const Time begin = std::max(busy_until_, talk_.now());
  const Time room = talk_.now() + step_lead - begin;
  if (room <= Time(0) || talk_.unanswered(LineKind::jog) >= max_unanswered) return 0;
  const double fit = std::floor(seconds(room) * feed / s_per_min / step_mm);
  const int taken = std::min(std::abs(count), std::max(1, static_cast<int>(std::min(fit, 1e6))));
  Way way{};
  way[index(axis)] = step_mm * taken * direction[index(axis)];
  under_way_ = direction;
  send(way, feed, time_of(step_mm * taken / (feed / s_per_min)));
  return taken;
}

bool JogStream::go(const std::string& words, double feed_mm_min) {
  if (wanted_ || stopping_ || moves_ || !talk_.answers()) return false;
  talk_.send(fmt::format("$J={}F{:.0f}", words, feed_mm_min), LineKind::jog);
  unanswered_.push_back({});
  ++counts_.lines;
  moves_ = goes_ = true;
  reports_then_ = talk_.machine().reports;
  return true;
}

void JogStream::stop() {
  wanted_.reset();
  if (!moves_ || stopping_) return;
  stopping_ = true;
  for (const Answered& line : talk_.drop_lines())
    if (line.kind == LineKind::jog && !unanswered_.empty()) unanswered_.pop_back();
  cancel_again_ = talk_.inside_line();
  send_cancel();
}

void JogStream::send_cancel() {
  talk_.send_byte(link::realtime::jog_cancel);
  cancelled_at_ = talk_.now();
  reports_then_ = talk_.machine().reports;
  ++counts_.cancels;
}

void JogStream::forget() {
  wanted_.reset();
  unanswered_.clear();
}

void JogStream::take(const Answered& answer) {
  if (answer.kind != LineKind::jog || unanswered_.empty()) return;
  const Way way = unanswered_.front();
  unanswered_.pop_front();
  reports_then_ = talk_.machine().reports;
  if (answer.error == 0) return;
  ++counts_.refused;
  for (std::size_t a = 0; a < way.size(); ++a) sent_mm_[a] -= way[a];
  // At the end of the travel the increments accepted before are inside and are completed, but not
  // after the deadline.
  constexpr auto end_of_travel = static_cast<int>(GcodeError::jog_out_of_travel);
  if (answer.error != end_of_travel) return stop();
  if (wanted_) ends_at_ = wanted_->until;
  wanted_.reset();
}

void JogStream::poll() {
  const Time now = talk_.now();
  if (stopping_) keep_stopping();
  if (wanted_ && (now >= wanted_->until || !talk_.answers())) stop();
  if (moves_ && !stopping_ && !talk_.answers()) stop();
  if (ends_at_ && now >= *ends_at_) stop();
  if (wanted_ && !stopping_) feed();
  check_at_rest();
}

void JogStream::keep_stopping() {
  // A line that was sent in part before the first cancel begins a jog when its rest arrives.
  const bool line_is_out = cancel_again_ && !talk_.inside_line();
  if (!line_is_out && talk_.now() - cancelled_at_ < cancel_interval) return;
  if (line_is_out) cancel_again_ = false;
  send_cancel();
}

/// The machine is at rest when all lines are answered and later reports say so.
void JogStream::check_at_rest() {
  const MachineNow& machine = talk_.machine();
  if (talk_.unanswered(LineKind::jog) == 0) unanswered_.clear();
  if (!unanswered_.empty() || (wanted_ && !stopping_) || cancel_again_) return;
  if (machine.reports < reports_then_ + sure_reports) return;
  // A machine that reports a jog moves, and must be stopped.
  moves_ = machine.status.is("Jog");
  if (moves_) return;
  stopping_ = goes_ = false;
  travels_ = travels_ && wanted_;
  ends_at_.reset();
  busy_until_ = talk_.now();
  under_way_ = {};
}

void JogStream::feed() {
  const Run run = *wanted_;
  if (moves_ && under_way_ != run.direction) {
    stop();
    wanted_ = run;  // continues after the stop
    return;
  }
  const Time now = talk_.now();
  const Time begin = std::max(busy_until_, now);
  Time duration = now + lead + increment - begin;
  if (duration < increment || talk_.unanswered(LineKind::jog) >= max_unanswered) return;
  if (moves_ && too_far_ahead()) return;
  // The motion missed in a long pause of this program is not sent later.
  duration = std::min(duration, lead + increment);
  const int parts = increments_of(run.speed_mm_s, duration);
  for (int i = 0; i < parts && wanted_; ++i) send_increment(run, duration / parts);
}

/// The board refuses an increment beyond the end of the travel as a whole, so it may not be long,
/// and is not so short that its rounding matters.
int JogStream::increments_of(double speed_mm_s, Time duration) const {
  constexpr double min_mm = 10 * resolution_mm;
  const double by_length = speed_mm_s * seconds(duration) / min_mm;
  const double by_time = seconds(duration) / seconds(increment);
  const auto room = static_cast<double>(max_unanswered - talk_.unanswered(LineKind::jog));
  return std::max(1, static_cast<int>(std::min({by_length, by_time, room})));
}

void JogStream::send_increment(const Run& run, Time duration) {
  const double ahead_mm = run.speed_mm_s * seconds(duration);
  if (ahead_mm < resolution_mm) return;  // accumulates to one step of the resolution
  const double mm = std::min(ahead_mm, wanted_->left_mm.value_or(ahead_mm));
  Way way = run.direction;
  for (double& part : way) part *= mm;
  under_way_ = run.direction;
  send(way, run.speed_mm_s * s_per_min, duration);
  if (!wanted_->left_mm) return;
  *wanted_->left_mm -= mm;
  if (*wanted_->left_mm > 0) return;
  ends_at_ = wanted_->until;
  wanted_.reset();
}

/// The machine is slower than its settings say, or busy.
bool JogStream::too_far_ahead() const {
  const std::vector<double>& place = talk_.machine().status.position;
  if (place.size() != stood_at_mm_.size()) return true;
  Way ahead{};
  double acceleration = std::numeric_limits<double>::max();
  for (std::size_t a = 0; a < std::min(ahead.size(), place.size()); ++a) {
    ahead[a] = sent_mm_[a] - (place[a] - stood_at_mm_[a]);
    if (wanted_->direction[a] != 0)
      acceleration = std::min(acceleration, limits_.acceleration_mm_s2[a]);
  }
  const double v = wanted_->speed_mm_s;
  return length(ahead) >
         v * v / (2 * acceleration) + v * (seconds(lead + 2 * increment) + report_age_s);
}

void JogStream::send(const Way& way, double feed_mm_min, Time duration) {
  if (!moves_) {
    stood_at_mm_ = talk_.machine().status.position;
    sent_mm_ = rest_ = {};
  }
  std::string line = "$J=G91G21";
  Way written{};
  for (int a = 0; a < limits_.axes; ++a) {
    const double mm = way[index(a)] + rest_[index(a)];
    written[index(a)] = std::round(mm / resolution_mm) * resolution_mm;
    rest_[index(a)] = mm - written[index(a)];
    if (written[index(a)] != 0)
      line += fmt::format("{}{:.3f}", axis_letters[index(a)], written[index(a)]);
    sent_mm_[index(a)] += written[index(a)];
  }
  busy_until_ = std::max(busy_until_, talk_.now()) + duration;
  if (length(written) == 0) return;
  talk_.send(fmt::format("{}F{:.3f}", line, feed_mm_min), LineKind::jog);
  unanswered_.push_back(written);
  ++counts_.lines;
  moves_ = true;
  reports_then_ = talk_.machine().reports;
}

}  // namespace lamplock::pendant
