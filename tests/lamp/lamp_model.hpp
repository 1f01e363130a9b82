// A simple model of a lamp and of a board's clock service, for tests of the beat clock.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "firmware/lamp/beat_clock.hpp"

namespace lamplock::test {

/// An edge of LAMP SYNC and the flash it belongs to.
struct LampEdge {
  std::uint64_t clock = 0;
  long flash = 0;
  bool extra = false;  ///< a second edge of the same flash
};

struct LampSpec {
  double hz = 100;
  double wander = 0;  ///< period swings by this share within `wander_seconds`
  double wander_seconds = 10;
  double jitter_us = 0;    ///< uniform, each way
  double drop_rate = 0;    ///< share of flashes without an edge
  double double_rate = 0;  ///< share of edges that come twice
};

/// Edges of `seconds` from `start_s` on, in order. Flashes are numbered from `first_flash`.
inline std::vector<LampEdge> lamp_edges(const LampSpec& spec, double start_s, double seconds,
                                        std::mt19937_64& random, long first_flash = 0) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<LampEdge> edges;
  long flash = first_flash;
  for (double t = 0; t < seconds; ++flash) {
    const double jitter = spec.jitter_us * 1e-6 * (2 * unit(random) - 1);
    const auto clock = static_cast<std::uint64_t>(std::llround((start_s + t + jitter) * clock_hz));
    if (unit(random) >= spec.drop_rate) {
      edges.push_back({clock, flash, false});
      if (unit(random) < spec.double_rate)
        edges.push_back(
            {clock + 10 * clocks_per_us + random() % (100 * clocks_per_us), flash, true});
    }
    // A full swing down and up again: once the wander in wander_seconds, then back.
    const double phase = 3.14159265358979 * t / spec.wander_seconds;
    t += (1 + spec.wander / 2 * std::cos(phase)) / spec.hz;
  }
  return edges;
}

/// Runs a beat clock like a board: every 250 us it requests lengths of ticks until 300 us ahead;
/// edges are reported when they occur.
class ClockBench {
 public:
  explicit ClockBench(lamp::BeatClock& clock) : clock_(clock) {}

  using OnSpan = std::function<void(const lamp::TickSpan&)>;
  using OnEdge = std::function<void(const LampEdge&, const lamp::EdgeInfo&)>;

  void run(const std::vector<LampEdge>& edges, std::uint64_t until_clock, const OnEdge& on_edge,
           const OnSpan& on_span = {}) {
    std::size_t next = 0;
    for (; now_ < until_clock; now_ += service_clocks) {
      while (next < edges.size() && edges[next].clock <= now_) {
        const lamp::EdgeInfo info = clock_.edge(edges[next].clock);
        if (on_edge) on_edge(edges[next], info);
        ++next;
      }
      while (span_end_ < now_ + lead_clocks) hand_out(on_span);
    }
  }

  /// Time of the lattice tick of a beat, past or future, clocks; 0 if not known.
  std::uint64_t time_of_beat(std::uint64_t beat) const {
    const auto at = beats_.find(beat);
    return at == beats_.end() ? 0 : at->second;
  }
  bool gapless() const { return gapless_; }
  std::uint64_t now() const { return now_; }

 private:
  static constexpr std::uint64_t service_clocks = 250 * clocks_per_us;
  static constexpr std::uint64_t lead_clocks = 300 * clocks_per_us;

  void hand_out(const OnSpan& on_span) {
    const std::uint64_t beat = clock_.beat_at_or_after(clock_.next_tick());
    const bool first_of_beat = clock_.tick_of_beat(beat) == clock_.next_tick();
    const lamp::TickSpan span = clock_.next_span(256);
    if (started_) gapless_ = gapless_ && span.first_tick == tick_ && span.first_clock == span_end_;
    started_ = true;
    gapless_ = gapless_ && span.ticks > 0 && clock_.next_tick() == span.first_tick + span.ticks;
    tick_ = span.first_tick + span.ticks;
    span_end_ = span.first_clock + span.clocks;
    if (first_of_beat) beats_[beat] = span.first_clock;
    if (on_span) on_span(span);
  }

  lamp::BeatClock& clock_;
  std::uint64_t now_ = 0;
  std::uint64_t span_end_ = 0, tick_ = 0;
  bool started_ = false, gapless_ = true;
  std::map<std::uint64_t, std::uint64_t> beats_;
};

}  // namespace lamplock::test
