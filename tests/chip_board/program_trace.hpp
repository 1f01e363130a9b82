// Traces of a program at the pins of a board and their comparison between two boards: every step of
// every axis, the gate and the power of the continuous laser.
//
// Two boards begin to move at different times at the start and after each rest (a dwell, a change
// of the spindle), because their main loops differ in phase. Between two rests one plan runs, so
// one offset applies to everything. It is measured at the first step of such a stretch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "sim/world/beam.hpp"
#include "tests/judges/pin_monitor.hpp"

namespace lamplock::test {

/// Trace of one board.
struct ProgramTrace {
  PerAxis<std::vector<PinMonitor::Step>> steps;
  std::vector<sim::BeamChange> light;
  sim::Picoseconds end = 0;  ///< later events are unknown

  std::size_t total() const {
    std::size_t sum = 0;
    for (const auto& axis : steps) sum += axis.size();
    return sum;
  }
  sim::Picoseconds first_step() const {
    sim::Picoseconds first = sim::never;
    for (const auto& axis : steps)
      if (!axis.empty()) first = std::min(first, axis.front().at);
    return first;
  }
  /// Drops events after `at`.
  void cut(sim::Picoseconds at) {
    for (auto& axis : steps)
      axis.erase(std::partition_point(axis.begin(), axis.end(),
                                      [at](const PinMonitor::Step& s) { return s.at <= at; }),
                 axis.end());
    light.erase(std::partition_point(light.begin(), light.end(),
                                     [at](const sim::BeamChange& c) { return c.at <= at; }),
                light.end());
    end = std::min(end, at);
  }
};

/// A stretch of time without a rest, by the steps of one board.
struct Stretch {
  sim::Picoseconds first = 0, last = 0;  ///< times of its first and last step
  sim::Picoseconds offset = 0;           ///< the other board's delay
};

/// Two traces, step by step.
class TraceComparison {
 public:
  /// Minimum time without steps that counts as a rest.
  static constexpr sim::Picoseconds min_rest = 15 * sim::ps_per_ms;

  /// `to_the_end`: both traces reach the end of the program; else the other one may be longer.
  TraceComparison(const ProgramTrace& one, const ProgramTrace& other, bool to_the_end)
      : one_(one), other_(other), to_the_end_(to_the_end) {
    find_stretches();
    for (std::size_t a = 0; a < one_.steps.size(); ++a) compare_axis(a);
    compare_gate();
  }

  const std::vector<Stretch>& stretches() const { return stretches_; }
  /// Number of steps and gate edges that both have, in the same order.
  std::size_t steps() const { return steps_; }
  std::size_t gate_edges() const { return gate_edges_; }
  /// Largest difference of their times, without the stretch's offset.
  sim::Picoseconds max_step_error() const { return step_error_; }
  sim::Picoseconds max_gate_error() const { return gate_error_; }
  /// The first step or edge that only one trace has or that differs; or empty.
  const std::string& difference() const { return difference_; }

  /// Converts a time of the first board to the other board's time.
  sim::Picoseconds in_other(sim::Picoseconds at, bool of_the_stretch_to_come) const {
    return at + stretch_of(at, of_the_stretch_to_come).offset;
  }

 private:
  void find_stretches() {
    struct Place {
      sim::Picoseconds at;
      std::size_t axis, index;
    };
    std::vector<Place> places;
    for (std::size_t a = 0; a < one_.steps.size(); ++a)
      for (std::size_t i = 0; i < one_.steps[a].size(); ++i)
        places.push_back({one_.steps[a][i].at, a, i});
    std::stable_sort(places.begin(), places.end(),
                     [](const Place& a, const Place& b) { return a.at < b.at; });
    for (const Place& place : places) {
      if (stretches_.empty() || place.at - stretches_.back().last > min_rest) {
        const auto& theirs = other_.steps[place.axis];
        if (place.index >= theirs.size()) break;  // reported by compare_axis()
        stretches_.push_back({place.at, place.at, theirs[place.index].at - place.at});
      }
      stretches_.back().last = place.at;
    }
  }
  /// The last stretch that has begun by `at`, or the next one.
  const Stretch& stretch_of(sim::Picoseconds at, bool to_come) const {
    static const Stretch none;
    if (stretches_.empty()) return none;
    auto next = std::partition_point(
        stretches_.begin(), stretches_.end(),
        [at, to_come](const Stretch& s) { return to_come ? s.last < at : s.first <= at; });
    if (to_come) return next == stretches_.end() ? stretches_.back() : *next;
    return next == stretches_.begin() ? stretches_.front() : *(next - 1);
  }
  bool same_number(std::size_t ours, std::size_t theirs) const {
    return to_the_end_ ? ours == theirs : ours <= theirs;
  }
  void differ(std::string text) {
    if (difference_.empty()) difference_ = std::move(text);
  }
  void compare_axis(std::size_t axis) {
    const auto& ours = one_.steps[axis];
    const auto& theirs = other_.steps[axis];
    const std::size_t count = std::min(ours.size(), theirs.size());
    for (std::size_t i = 0; i < count; ++i) {
      if (ours[i].position != theirs[i].position)
        return differ(fmt::format("step {} of axis {} goes to {} and {}, at {} s", i, axis,
                                  ours[i].position, theirs[i].position,
                                  sim::seconds(ours[i].at - one_.first_step())));
      const sim::Picoseconds error = theirs[i].at - in_other(ours[i].at, false);
      step_error_ = std::max(step_error_, std::abs(error));
      ++steps_;
    }
    if (!same_number(ours.size(), theirs.size()))
      differ(fmt::format("axis {} makes {} and {} steps", axis, ours.size(), theirs.size()));
  }

  struct Edge {
    sim::Picoseconds at;
    bool level;
  };
  static std::vector<Edge> gate_of(const ProgramTrace& trace) {
    std::vector<Edge> edges;
    bool level = false;
    for (const sim::BeamChange& change : trace.light) {
      if (change.gate == level) continue;
      level = change.gate;
      edges.push_back({change.at, level});
    }
    return edges;
  }
  /// The gate may open before the first step of a stretch and close after its last.
  void compare_gate() {
    const std::vector<Edge> ours = gate_of(one_), theirs = gate_of(other_);
    gate_edges_ = std::min(ours.size(), theirs.size());
    for (std::size_t i = 0; i < gate_edges_; ++i) {
      const sim::Picoseconds error = theirs[i].at - in_other(ours[i].at, ours[i].level);
      gate_error_ = std::max(gate_error_, std::abs(error));
    }
    if (!same_number(ours.size(), theirs.size()))
      differ(fmt::format("the gate has {} and {} edges", ours.size(), theirs.size()));
  }

  const ProgramTrace& one_;
  const ProgramTrace& other_;
  const bool to_the_end_;
  std::vector<Stretch> stretches_;
  std::size_t steps_ = 0, gate_edges_ = 0;
  sim::Picoseconds step_error_ = 0, gate_error_ = 0;
  std::string difference_;
};

/// The light of two traces whose steps agree. Each board outputs power in its own raster, so the
/// other's power at a time is compared with the first's powers within `raster` of that time.
class LightComparison {
 public:
  LightComparison(const ProgramTrace& one, const ProgramTrace& other, const TraceComparison& times,
                  sim::Picoseconds raster)
      : one_(one), other_(other), raster_(raster) {
    for (const Stretch& stretch : times.stretches())
      for (sim::Picoseconds at = stretch.first; at <= stretch.last; at += sample)
        compare(at, at + stretch.offset);
    energy_ = energy(one, one.end);
    other_energy_ = energy(other, times.in_other(one.end, false));
  }

  /// Number of samples at which both have light.
  std::size_t samples() const { return samples_; }
  /// Largest power outside the permitted range; of 65535.
  int max_error() const { return error_; }
  /// Energy as seconds of full power.
  double energy() const { return energy_; }
  double other_energy() const { return other_energy_; }

 private:
  static constexpr sim::Picoseconds sample = 7 * sim::ps_per_us;

  static auto behind(const ProgramTrace& trace, sim::Picoseconds at) {
    return std::partition_point(trace.light.begin(), trace.light.end(),
                                [at](const sim::BeamChange& c) { return c.at <= at; });
  }
  static sim::BeamChange at(const ProgramTrace& trace, sim::Picoseconds time) {
    const auto next = behind(trace, time);
    return next == trace.light.begin() ? sim::BeamChange{} : *(next - 1);
  }
  void compare(sim::Picoseconds ours, sim::Picoseconds theirs) {
    const sim::BeamChange other = at(other_, theirs);
    if (!other.gate || !at(one_, ours).gate) return;
    int low = at(one_, ours - raster_).power, high = low;
    for (auto c = behind(one_, ours - raster_); c != one_.light.end() && c->at <= ours + raster_;
         ++c) {
      low = std::min(low, int{c->power});
      high = std::max(high, int{c->power});
    }
    error_ = std::max({error_, low - other.power, other.power - high});
    ++samples_;
  }
  static double energy(const ProgramTrace& trace, sim::Picoseconds end) {
    double sum = 0;
    for (std::size_t i = 0; i < trace.light.size() && trace.light[i].at < end; ++i) {
      const sim::Picoseconds to =
          i + 1 < trace.light.size() ? std::min(end, trace.light[i + 1].at) : end;
      sum += sim::seconds(to - trace.light[i].at) * trace.light[i].light() / 65'535.0;
    }
    return sum;
  }

  const ProgramTrace& one_;
  const ProgramTrace& other_;
  const sim::Picoseconds raster_;
  std::size_t samples_ = 0;
  int error_ = 0;
  double energy_ = 0, other_energy_ = 0;
};

}  // namespace lamplock::test
