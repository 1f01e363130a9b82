#include "tests/judges/pin_monitor.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "shared/work_space.hpp"

namespace lamplock::test {
namespace {

constexpr double ps = 1e-12;
constexpr std::array<double, 6> windows_s{0.0005, 0.001, 0.002, 0.005, 0.010, 0.020};

double seconds(sim::Picoseconds t) { return static_cast<double>(t) * ps; }

}  // namespace

PinMonitor::PinMonitor(sim::PinBus& bus, const sim::Lamp& lamp) : bus_(bus), lamp_(lamp) {
  for (int axis = 0; axis < max_axes; ++axis) bus.listen(sim::step_pin(axis), *this);
  for (int axis = 0; axis < max_axes; ++axis) bus.listen(sim::dir_pin(axis), *this);
  bus.listen(sim::Pin::q_switch, *this);
  bus.listen(sim::Pin::lamp_sync, *this);
  for (int c = 0; c < sim::beam_channels; ++c) bus.listen(sim::shutter_pin(c), *this);
}

void PinMonitor::pin_changed(sim::Pin pin, bool level, sim::Picoseconds at) {
  if (pin == sim::Pin::lamp_sync) {
    if (level) edges_.push_back(at);
  } else if (pin == sim::Pin::q_switch) {
    if (level)
      fires_.push_back({at, sim::never, lamp_.periods(), edges_.empty() ? -1 : edges_.back()});
    else if (!fires_.empty())
      fires_.back().fall = at;
  } else if (static_cast<std::size_t>(pin) >= 2 * max_axes) {
    int open = 0;
    for (int c = 0; c < sim::beam_channels; ++c) open += bus_.level(sim::shutter_pin(c)) ? 1 : 0;
    openings_ += level ? 1 : 0;
    overlaps_ += open > 1 ? 1 : 0;
  } else {
    const auto axis = static_cast<std::size_t>(pin) / 2;
    if (static_cast<std::size_t>(pin) % 2 == 0) {
      if (!level) return;
      position_[axis] += bus_.level(sim::dir_pin(static_cast<int>(axis))) ? -1 : 1;
      steps_[axis].push_back({at, position_[axis]});
    }
  }
}

bool PinMonitor::nothing_happened() const {
  return fires_.empty() &&
         std::all_of(steps_.begin(), steps_.end(), [](const auto& steps) { return steps.empty(); });
}

std::int32_t PinMonitor::position_at(int axis, sim::Picoseconds at) const {
  const std::vector<Step>& all = steps(axis);
  const auto next =
      std::partition_point(all.begin(), all.end(), [at](const Step& s) { return s.at <= at; });
  return next == all.begin() ? 0 : std::prev(next)->position;
}

sim::Picoseconds PinMonitor::first_step() const {
  sim::Picoseconds first = sim::never;
  for (const auto& steps : steps_)
    if (!steps.empty()) first = std::min(first, steps.front().at);
  return first;
}

sim::Picoseconds PinMonitor::last_step() const {
  sim::Picoseconds last = 0;
  for (const auto& steps : steps_)
    if (!steps.empty()) last = std::max(last, steps.back().at);
  return last;
}

bool PinMonitor::stepped(sim::Picoseconds from, sim::Picoseconds to) const {
  return std::any_of(steps_.begin(), steps_.end(), [from, to](const auto& steps) {
    const auto next = std::upper_bound(steps.begin(), steps.end(), from,
                                       [](sim::Picoseconds t, const Step& s) { return t < s.at; });
    return next != steps.end() && next->at <= to;
  });
}

std::size_t PinMonitor::fired(sim::Picoseconds from, sim::Picoseconds to) const {
  return static_cast<std::size_t>(
      std::count_if(fires_.begin(), fires_.end(),
                    [from, to](const Fire& fire) { return from < fire.rise && fire.rise <= to; }));
}

std::string PinMonitor::violation(const settings::Values& values, sim::Picoseconds from,
                                  sim::Picoseconds to) const {
  for (int axis = 0; axis < max_axes; ++axis) {
    const auto& all = steps(axis);
    const auto first =
        std::partition_point(all.begin(), all.end(), [from](const Step& s) { return s.at < from; });
    const auto last =
        std::partition_point(first, all.end(), [to](const Step& s) { return s.at <= to; });
    if (first == last) continue;
    if (axis >= values.whole(settings::Id::axes))
      return fmt::format("axis {} moves and does not exist", axis);
    const std::int32_t before = first == all.begin() ? 0 : std::prev(first)->position;
    std::string text = judge(rules_of(values, axis), values, axis, before, {first, last}, to);
    if (!text.empty()) return text;
  }
  return {};
}

PinMonitor::Rules PinMonitor::rules_of(const settings::Values& values, int axis) const {
  using settings::Id;
  const double per_mm = values.milli(Id::steps_per_mm_x, axis) / 1000.0;
  const double slew = values.whole(Id::lamp_mode) == 1 ? values.milli(Id::slew_limit) / 1e5 : 0;
  // A tick lasts 1 us of the nominal beat; the lamp may be off by the lock range.
  const double tick_s = 1e-6 * (1 + values.milli(Id::lock_range) / 1e5 + slew);
  Rules rules{values.milli(Id::max_rate_x, axis) / 6e4 * per_mm,
              values.milli(Id::acceleration_x, axis) / 1e3 * per_mm, tick_s, slew};
  if (speed_jumps_) {
    // Rounding of points to steps adds two steps a beat (firmware/motion/path/geometry.hpp).
    rules.corners_s = values.milli(Id::lamp_frequency) / 1e3 * 1.05;
    rules.jump = values.milli(Id::speed_jump_x, axis) / 1e3 * per_mm + 2 * rules.corners_s;
  }
  return rules;
}

std::string PinMonitor::judge(const Rules& rules, const settings::Values& values, int axis,
                              std::int32_t before, const std::vector<Step>& steps,
                              sim::Picoseconds to) {
  const StepLimits space = work_space(values);
  std::int32_t last = before;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& s = steps[i];
    if (std::abs(s.position - last) != 1)
      return fmt::format("axis {} jumps at {} s", axis, seconds(s.at));
    last = s.position;
    if (!space.contains(axis, s.position))
      return fmt::format("axis {} leaves the work space at {} s: step {}", axis, seconds(s.at),
                         s.position);
    if (i == 0) continue;
    // Two steps in opposite directions may be a tick apart: the axis covers no distance between
    // them.
    const bool same_way = i < 2 || s.position != steps[i - 2].position;
    const double interval = seconds(s.at - steps[i - 1].at);
    if (same_way && (interval + rules.tick_s) * rules.speed < 1 - 1e-9)
      return fmt::format("axis {} too fast at {} s: {} s between two steps", axis, seconds(s.at),
                         interval);
  }
  for (const double h : windows_s) {
    std::string text = judge_window(rules, axis, before, steps, h, to);
    if (!text.empty()) return text;
  }
  return {};
}

std::string PinMonitor::judge_window(const Rules& rules, int axis, std::int32_t before,
                                     const std::vector<Step>& steps, double h,
                                     sim::Picoseconds to) {
  const auto h_ps = static_cast<sim::Picoseconds>(h / ps);
  std::size_t ahead = 0, past = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const sim::Picoseconds t = steps[i].at;
    if (t > to - h_ps) break;
    while (ahead + 1 < steps.size() && steps[ahead + 1].at <= t + h_ps) ++ahead;
    while (past < steps.size() && steps[past].at <= t - h_ps) ++past;
    const double x = steps[i].position;
    const double later = steps[std::max(ahead, i)].position;
    const double earlier = past == 0 ? before : steps[past - 1].position;
    const double way = std::max(std::abs(later - x), std::abs(x - earlier));
    if (way > rules.speed * (h + rules.tick_s) + 1)
      return fmt::format("axis {} too fast at {} s: {} steps in {} s", axis, seconds(t), way, h);
    const double bend = std::abs(later - 2 * x + earlier);
    const double fastest = std::min(rules.speed, (way + 1) / h + rules.accel * h);
    const double most = rules.accel * h * h + 2 +
                        fastest * (2 * rules.tick_s + 2 * rules.slew * h) +
                        rules.jump * h * std::ceil(2 * h * rules.corners_s);
    if (bend > most)
      return fmt::format("axis {} accelerates too hard at {} s: {} > {} steps over +-{} s", axis,
                         seconds(t), bend, most, h);
  }
  return {};
}

}  // namespace lamplock::test
