#include "sim/chip_board/chip_board.hpp"

#include <algorithm>
#include <bit>

#include "firmware/settings/store.hpp"
#include "shared/boards/pico_flash.hpp"

namespace lamplock::sim {
namespace {

using boards::Role;
using chip::External;

/// The settings area as the image's own flash driver sees it.
struct SettingsArea {
  static constexpr std::uint32_t sectors = boards::settings_sectors;
  std::span<std::uint8_t> bytes;
  void read(std::uint32_t offset, std::span<std::uint8_t> out) const {
    std::copy_n(bytes.begin() + offset, out.size(), out.begin());
  }
  void erase(std::uint32_t offset) const {
    std::fill_n(bytes.begin() + offset, settings::flash_sector, settings::flash_blank);
  }
  void program(std::uint32_t offset,
               std::span<const std::uint8_t, settings::flash_page> page) const {
    std::copy(page.begin(), page.end(), bytes.begin() + offset);
  }
};
static_assert(settings::SettingsFlash<SettingsArea>);

SettingsArea settings_area(chip::Chip& chip) {
  return {chip.flash().storage().subspan(
      boards::settings_offset, std::size_t{SettingsArea::sectors} * settings::flash_sector)};
}

struct Wire {
  Role role;
  Pin pin;
  bool inverted;
};
constexpr std::array output_wires{
    Wire{Role::step_x, Pin::step_x, false},
    Wire{Role::dir_x, Pin::dir_x, false},
    Wire{Role::step_y, Pin::step_y, false},
    Wire{Role::dir_y, Pin::dir_y, false},
    Wire{Role::step_z, Pin::step_z, false},
    Wire{Role::dir_z, Pin::dir_z, false},
    Wire{Role::step_a, Pin::step_a, false},
    Wire{Role::dir_a, Pin::dir_a, false},
    Wire{Role::q_switch, Pin::q_switch, false},
    Wire{Role::lamp_trigger, Pin::lamp_trigger, false},
    Wire{Role::laser_gate, Pin::laser_gate, false},
    Wire{Role::shot_enable, Pin::arm, false},
    Wire{Role::drives_enable, Pin::enable, true},
    Wire{Role::drives_enable_2, Pin::enable, true},
    Wire{Role::drives_enable_3, Pin::enable, true},
    Wire{Role::drives_enable_4, Pin::enable, true},
    Wire{Role::z_enable, Pin::enable_z, true},
    Wire{Role::air, Pin::air, false},
    Wire{Role::aux_out, Pin::aux_out, false},
    Wire{Role::shutter_1, Pin::shutter_1, false},
    Wire{Role::shutter_2, Pin::shutter_2, false},
    Wire{Role::shutter_3, Pin::shutter_3, false},
    Wire{Role::shutter_4, Pin::shutter_4, false},
};
/// Switches are closed to ground at rest, with the pull-up of the pad or of the board.
constexpr std::array input_wires{
    Wire{Role::lamp_sync, Pin::lamp_sync, false},
    Wire{Role::estop, Pin::estop, false},
    Wire{Role::door, Pin::door, false},
    Wire{Role::probe, Pin::probe, false},
    Wire{Role::aux_in, Pin::aux_in, false},
    Wire{Role::limit_x, Pin::limit_x, false},
    Wire{Role::limit_y, Pin::limit_y, false},
    Wire{Role::limit_z, Pin::limit_z, false},
    Wire{Role::photosensor_1, Pin::photosensor_1, false},
    Wire{Role::photosensor_2, Pin::photosensor_2, false},
    Wire{Role::photosensor_3, Pin::photosensor_3, false},
    Wire{Role::photosensor_4, Pin::photosensor_4, false},
};
/// Of LASER PWM: 62.5 kHz.
constexpr Picoseconds pwm_period = 16 * ps_per_us;
constexpr std::array chained_limits{Pin::limit_x, Pin::limit_y, Pin::limit_z, Pin::limit_a};

}  // namespace

ChipBoard::ChipBoard(const chip::Image& image, const settings::Values& stored,
                     const WorldConfig& world, const ChipBoardOptions& options)
    : world_(std::make_unique<World>(world, bus_)),
      chip_(options.chip),
      host_(chip_.wheel(), chip_.usb(), options.usb),
      slot_(chip_.wheel().add(*this)),
      map_(options.wiring.value_or(
          static_cast<boards::PinMap>(stored.whole(settings::Id::pin_map)))) {
  chip_.load(image, "image");
  SettingsArea area = settings_area(chip_);
  settings::Store store(area);
  store.load();
  store.save(stored);
  const boards::BoardRow& row = *boards::find_board(map_);
  enables_ = boards::enable_pins(row);
  if (row.drives) drive_wire_.emplace(chip_, *row.drives);
  connect_pads(stored, world.drives);
  if (options.wiring) connect_resistors(stored);
  plan();
  chip_.power_on();
}

ChipBoard::~ChipBoard() = default;

settings::Values ChipBoard::stored_settings() {
  SettingsArea area = settings_area(chip_);
  return settings::Store(area).load();
}

void ChipBoard::connect_pads(const settings::Values& stored, const DriveConfig& drives) {
  // Drives on the board have a polarity of their own.
  const bool enabled_high =
      !boards::find_board(map_)->drives && stored.whole(settings::Id::enable_invert) != 0;
  for (const Wire& wire : output_wires)
    if (const auto gpio = boards::find_gpio(map_, wire.role))
      outputs_[*gpio] = Pad{wire.pin, wire.inverted && !enabled_high};
  for (int axis = 0; axis < max_axes; ++axis) {
    const auto first = boards::find_gpio(map_, boards::step_role(axis));
    const auto second = boards::find_gpio(map_, boards::dir_role(axis));
    if (!first || !second) continue;
    outputs_[*first]->pulled_up = drives.first_active_low[index(axis)];
    outputs_[*second]->pulled_up = drives.second_active_low[index(axis)];
  }
  for (const Wire& wire : input_wires) {
    if (!boards::find_gpio(map_, wire.role)) continue;
    bus_.listen(wire.pin, *this);
    drive(wire.pin, bus_.level(wire.pin));
  }
  if (boards::find_gpio(map_, Role::limits)) {
    for (const Pin pin : chained_limits) bus_.listen(pin, *this);
    drive(Pin::limit_x, false);
  }
  bus_.listen_to_sensor(*this);
  chip_.gpio().listen(static_cast<chip::PadListener&>(*this));
}

/// Pull-ups of the board, and those of enables that are active low.
void ChipBoard::connect_resistors(const settings::Values& stored) {
  const boards::Pins pins = boards::pins(map_);
  std::uint32_t pulled_up = boards::find_board(map_)->pulled_up;
  if (boards::find_board(map_)->drives || stored.whole(settings::Id::enable_invert) == 0)
    pulled_up |= enables_ | boards::pin_of(pins, Role::z_enable);
  // Switches are stronger.
  for (const boards::PinUse& use : pins)
    if (use.direction == boards::Direction::input) pulled_up &= ~(1u << use.gpio);
  for (unsigned gpio = 0; gpio < chip::gpio_count; ++gpio)
    if ((pulled_up >> gpio & 1) != 0)
      chip_.gpio().set_external(gpio, External::pulled_up, chip_.wheel().now());
}

void ChipBoard::pin_changed(Pin pin, bool level, Picoseconds /*at*/) { drive(pin, level); }

void ChipBoard::voltage_changed(double volts, Picoseconds /*at*/) {
  if (const auto gpio = boards::find_gpio(map_, Role::sensor))
    chip_.system().adc.set_input(*gpio - boards::first_analog_gpio, volts);
}

void ChipBoard::drive(Pin pin, bool level) {
  const chip::Cycle now = chip_.wheel().now();
  const auto put = [&](std::uint8_t gpio, bool high) {
    const bool inverted = (boards::inverted_pins(boards::pins(map_)) >> gpio & 1) != 0;
    chip_.gpio().set_external(gpio, high != inverted ? External::high : External::low, now);
  };
  for (const Wire& wire : input_wires)
    if (wire.pin == pin)
      if (const auto gpio = boards::find_gpio(map_, wire.role)) return put(*gpio, level);
  if (const auto gpio = boards::find_gpio(map_, Role::limits))
    put(*gpio, std::any_of(chained_limits.begin(), chained_limits.end(),
                           [this](Pin limit) { return bus_.level(limit); }));
}

void ChipBoard::pad_changed(unsigned gpio, bool level, chip::Cycle at) {
  const Picoseconds time = chip_.wheel().time_of(at);
  if (gpio == boards::find_gpio(map_, Role::laser_pwm)) return measure_pwm(level, time);
  if (!outputs_[gpio]) return;
  if (outputs_[gpio]->pulled_up && (chip_.gpio().driven() >> gpio & 1) == 0) level = true;
  if (outputs_[gpio]->pin == Pin::enable) return switch_drives(time);
  const Picoseconds before = world_->next_event();
  if (outputs_[gpio]->pin == Pin::q_switch) bus_.set_attenuator(attenuator(time));
  bus_.set(outputs_[gpio]->pin, level != outputs_[gpio]->inverted, time);
  // A triggered lamp has future edges.
  if (world_->next_event() != before) plan();
}

/// Drives that have an enable each count as enabled if all are.
void ChipBoard::switch_drives(Picoseconds at) {
  const bool active_low = outputs_[index(std::countr_zero(enables_))]->inverted;
  const std::uint32_t high = chip_.gpio().pad_levels() & enables_;
  bus_.set(Pin::enable, active_low ? high == 0 : high == enables_, at);
}

/// A rise begins a period: the high time before a fall consists of whole periods at full power and
/// a part of one, which counts as a whole period.
void ChipBoard::measure_pwm(bool level, Picoseconds at) {
  settle_pwm(at);
  pwm_.level = level;
  if (level) {
    pwm_.rose = at;
    return;
  }
  const Picoseconds high = at - pwm_.rose, whole = high / pwm_period;
  pwm_.ends = pwm_.rose + whole * pwm_period;
  if (high == whole * pwm_period) return put_power(0, at);
  put_power(static_cast<std::uint16_t>(high % pwm_period * 65'535 / pwm_period), pwm_.ends);
  pwm_.ends += pwm_period;
}

/// Applies what is known without another edge: full power, and none after the last period.
void ChipBoard::settle_pwm(Picoseconds at) {
  if (pwm_.level) {
    if (at - pwm_.rose >= pwm_period) put_power(65'535, pwm_.rose);
  } else if (at > pwm_.ends) {
    put_power(0, pwm_.ends);
  }
}

void ChipBoard::put_power(std::uint16_t power, Picoseconds at) {
  pwm_.power = power;
  bus_.set_power(power, at);
}

std::uint16_t ChipBoard::attenuator(Picoseconds at) {
  settle_pwm(at);
  return pwm_.power;
}

void ChipBoard::plan() {
  const Picoseconds next = world_->next_event();
  chip_.wheel().set(slot_, chip_.wheel().cycle_at(next));
}

void ChipBoard::run(chip::Cycle to) {
  world_->advance(chip_.wheel().time_of(std::min(to, chip_.wheel().now())));
  plan();
}

void ChipBoard::run_until(Picoseconds until) {
  plan();  // switches may have been scheduled
  while (now() < until) {
    // A change of the clock moves the cycle that a time means.
    const chip::Cycle target = chip_.wheel().cycle_at(until);
    if (target <= chip_.wheel().now()) break;
    chip_.run_until(target);
    settle_pwm(now());
    world_->advance(std::min(now(), until));
    plan();
  }
}

void ChipBoard::talk_over(chip::UsbFunction function) {
  function_ = function;
  host_.open_serial(function == chip::UsbFunction::serial);
  host_.claim_vendor(function == chip::UsbFunction::vendor);
}

bool ChipBoard::run_until_found(Picoseconds limit) {
  const Picoseconds end = now() + limit;
  for (Picoseconds next = now() + ps_per_ms; !host_.enumerated() && next <= end; next += ps_per_ms)
    run_until(next);
  return host_.enumerated();
}

}  // namespace lamplock::sim
