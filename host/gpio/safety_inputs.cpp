#include "host/gpio/safety_inputs.hpp"

#include <fmt/format.h>

#include <utility>

namespace lamplock::gpio {
namespace {

/// Half a period of the lamp when it blinks for attention: 2 Hz.
constexpr SafetyInputs::Time lamp_half_period{250'000};

/// A square wave from the clock.
bool first_half(SafetyInputs::Time now, SafetyInputs::Time half_period) {
  return now / half_period % 2 == 0;
}

std::optional<SafeInput> watch(Lines& lines, const std::optional<LineRequest>& wanted,
                               SafetyInputs::Time debounce) {
  if (!wanted) return std::nullopt;
  return SafeInput(lines.input(*wanted), wanted->place, debounce);
}

std::unique_ptr<Output> off(Lines& lines, const std::optional<LineRequest>& wanted) {
  return wanted ? lines.output(*wanted, false) : nullptr;
}

std::string place_of(const std::optional<LineRequest>& wanted) {
  return wanted ? wanted->place : "";
}

/// The state of an input that is not well: `what`, or "line lost".
std::string trouble(const SafeInput& input, const char* what) {
  return fmt::format("{} ({})", input.lost() ? "line lost" : what, input.place());
}

constexpr const char* pressed = "e-stop pressed";
constexpr const char* open = "door open";
constexpr const char* lost = "line lost";

}  // namespace

SafetyInputs::SafetyInputs(Lines& lines, const LineTable& table)
    : debounce_(table.debounce),
      interlock_beat_(table.interlock_beat),
      estop_(watch(lines, table.estop, debounce_)),
      door_(watch(lines, table.door, debounce_)),
      interlock_place_(place_of(table.interlock)),
      lamp_place_(place_of(table.lamp)),
      interlock_(off(lines, table.interlock)),
      lamp_(off(lines, table.lamp)) {}

SafetyInputs::~SafetyInputs() { end(); }

SafetyState SafetyInputs::poll(Time now) {
  if (estop_) estop_->poll(now);
  if (door_) door_->poll(now);
  judge();
  switch_outputs(now);
  return state_;
}

std::string SafetyInputs::unsettled() const {
  if (estop_ && !estop_->well()) return trouble(*estop_, pressed);
  if (door_ && !door_->well()) return trouble(*door_, open);
  return "";
}

bool SafetyInputs::settled() const { return unsettled().empty(); }

void SafetyInputs::judge() {
  if (!working_ || state_ == SafetyState::stop) return;
  if (estop_ && !estop_->well()) return stop(estop_->lost() ? lost : pressed, estop_->place());
  if (door_ && door_->lost()) return stop(lost, door_->place());
  const bool closed = !door_ || door_->well();
  if (!closed) waits_ = true;
  state_ = closed ? SafetyState::clear : SafetyState::door;
  reason_ = closed ? "" : trouble(*door_, open);
}

void SafetyInputs::stop(const char* what, const std::string& place) {
  state_ = SafetyState::stop;
  reason_ = fmt::format("{} ({})", what, place);
}

void SafetyInputs::switch_outputs(Time now) {
  const bool well = working_ && state_ == SafetyState::clear && !waits_;
  const bool beat = interlock_beat_ == Time{0} || first_half(now, interlock_beat_);
  if (interlock_ && !interlock_->set(well && fires_ && beat) && working_)
    stop(lost, interlock_place_);
  const bool light = well || (working_ && first_half(now, lamp_half_period));
  if (lamp_ && !lamp_->set(light) && working_) stop(lost, lamp_place_);
  // A line lost in this function turns off the interlock in the same call.
  if (interlock_ && state_ == SafetyState::stop) interlock_->set(false);
}

void SafetyInputs::begin(LaserUse work) {
  working_ = true;
  fires_ = work == LaserUse::laser;
}

void SafetyInputs::resume() { waits_ = false; }

void SafetyInputs::end() {
  working_ = false;
  if (interlock_) interlock_->set(false);
  if (lamp_) lamp_->set(false);
}

}  // namespace lamplock::gpio
