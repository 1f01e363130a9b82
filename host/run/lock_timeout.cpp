#include "host/run/lock_timeout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/error.hpp"
#include "host/link/sender.hpp"
#include "host/units.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::run {
namespace {

/// Six swings of a lamp that wanders (sim/world/lamp.hpp), or, of a slow one, many times the 16
/// edges of the longest setting for a lock ($907).
constexpr double patience_s = 60, patience_beats = 200;

constexpr const char* remedy = "check --wander, --jitter and --dropouts";

/// Beats that a lamp in order would not have cost.
constexpr std::array lost_by_lamp{BeatReason::not_locked, BeatReason::no_edge,
                                  BeatReason::outside_tolerance, BeatReason::returning};

}  // namespace

LockTimeout::LockTimeout(const settings::Values& values) {
  const double beats_s = patience_beats / in_units(values, settings::Id::lamp_frequency);
  const std::chrono::duration<double> patience(std::max(patience_s, beats_s));
  patience_ = std::chrono::round<std::chrono::microseconds>(patience);
}

LockTimeout::Count LockTimeout::count(const wire::Status& status) {
  Count count;
  for (const BeatsByReason* beats : {&status.beats_by_reason, &status.beats_outside}) {
    for (const std::uint32_t one : *beats) count.all += one;
    for (const BeatReason reason : lost_by_lamp)
      count.lost += (*beats)[static_cast<std::size_t>(reason)];
  }
  return count;
}

void LockTimeout::poll(const link::JobSender& sender, std::chrono::microseconds now) {
  const wire::Status& status = sender.status();
  if (status.session == sender.session() && status.hold_reason == wire::HoldReason::lamp)
    throw Error(Exit::job_failed, "simulated lamp",
                "it does not flash when it is triggered, the machine holds", remedy);
  const bool runs = status.session == sender.session() && status.state == wire::MachineState::run;
  const bool progress = sender.points_fired() != points_ || status.shots != shots_;
  if (!begun_ || !runs || progress) {
    begun_ = runs;
    since_ = now;
    points_ = sender.points_fired();
    shots_ = status.shots;
    before_ = count(status);
    return;
  }
  if (now - since_ < patience_) return;
  const Count after = count(status);
  const std::uint64_t lost = after.lost - before_.lost, all = after.all - before_.all;
  // Without any flash there may be no beats to be counted either: a machine that triggers its lamp
  // counts what comes back.
  const bool by_lamp = 2 * lost >= all;
  if (!by_lamp) {
    begun_ = false;  // a long way or pause: time counts from here
    return;
  }
  throw Error(Exit::job_failed, "simulated lamp",
              fmt::format("its beat cannot be followed, nothing was fired for {:.0f} s",
                          std::chrono::duration<double>(now - since_).count()),
              remedy);
}

}  // namespace lamplock::run
