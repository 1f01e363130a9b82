#include "sim/virtual_board/virtual_board.hpp"

#include <algorithm>
#include <array>

#include "shared/boards/all_boards.hpp"

namespace lamplock::sim {
namespace {

/// Period of the main loop.
constexpr Picoseconds service_period = 250 * ps_per_us;
/// Tick lengths and steps are computed this far ahead.
constexpr Picoseconds timing_lead = 300 * ps_per_us;
constexpr std::uint32_t motion_lead_ticks = 2000;
constexpr std::uint32_t span_ticks = 256;
/// Maximum block length. Long blocks save time, but a hold no longer affects what is filled.
constexpr std::uint32_t block_ticks = 1u << 12;
/// Full-speed USB: 19 packets of 64 bytes in a frame of 1 ms; a quarter of it per service.
constexpr std::size_t bytes_per_service = 19 * 64 / 4;
/// Bytes that the host's computer keeps for a program that does not read.
constexpr std::size_t host_buffer = 65'536;
/// Blocks kept after they were played, to look back from a late edge to its lattice tick.
constexpr std::size_t remembered_blocks = 64;

/// Pins of switches and their inputs.
struct InputPin {
  Pin pin;
  machine::Input input;
};
constexpr std::array input_pins{InputPin{Pin::estop, machine::Input::estop},
                                InputPin{Pin::door, machine::Input::door},
                                InputPin{Pin::probe, machine::Input::probe},
                                InputPin{Pin::aux_in, machine::Input::aux},
                                InputPin{Pin::limit_x, machine::Input::limit_x},
                                InputPin{Pin::limit_y, machine::Input::limit_y},
                                InputPin{Pin::limit_z, machine::Input::limit_z},
                                InputPin{Pin::limit_a, machine::Input::limit_a}};

/// Axes, channels and switches of every map; outputs and inputs of programs as the map has them.
machine::BoardFeatures features_of(const settings::Values& stored) {
  const auto map = static_cast<boards::PinMap>(stored.whole(settings::Id::pin_map));
  machine::BoardFeatures features;
  features.outputs = boards::program_outputs(map);
  features.second_wire = boards::axes_of_z_enable(map);
  features.limits.has_sensor = boards::find_gpio(map, boards::Role::sensor).has_value();
  if (boards::find_gpio(map, boards::Role::aux_in))
    features.inputs |= machine::set_of(machine::Input::aux);
  return features;
}

/// The tick that begins a lag before another one. If the lattice lags the lamp, the tick of a shot
/// has no time yet: from there on ticks are assumed as long as the last one that has a time.
std::uint64_t tick_before(const TickLine& line, std::uint64_t tick, Picoseconds lag) {
  const std::uint64_t end = line.end_tick();
  if (tick <= end) return line.first_tick_from(line.time_of(tick) - lag);
  const lamp::TickSpan& last = line.span_of(end);
  const Picoseconds length = static_cast<Picoseconds>(last.clocks) * ps_per_clock;
  const auto ticks = static_cast<Picoseconds>(last.ticks);
  const Picoseconds untimed = static_cast<Picoseconds>(tick - end) * length / ticks;
  if (untimed >= lag) return tick - static_cast<std::uint64_t>(lag * ticks / length);
  return line.first_tick_from(line.end_time() - (lag - untimed));
}

}  // namespace

VirtualBoard::VirtualBoard(const settings::Values& stored, const WorldConfig& world,
                           const machine::PersistentState& kept)
    : stored_(stored),
      kept_(kept),
      world_(std::make_unique<World>(world, bus_)),
      controller_(std::make_unique<machine::Controller>(stored, machine::InterruptMask{},
                                                        features_of(stored))) {
  controller_->set_kept(kept_);
  for (const Pin pin : {Pin::lamp_sync, Pin::lamp_trigger}) bus_.listen(pin, *this);
  for (const InputPin& input : input_pins) bus_.listen(input.pin, *this);
  for (int channel = 0; channel < beam_channels; ++channel)
    bus_.listen(photosensor_pin(channel), *this);
  const stepper::PulseOutput output = stepper::pulse_output(stored);
  for (int axis = 0; axis < max_axes; ++axis) {
    max_lag_ = std::max(max_lag_, world_->drives().lag(axis));
    axes_[index(axis)].start(bus_, axis, output);
  }
}

VirtualBoard::~VirtualBoard() = default;

std::size_t VirtualBoard::write(std::span<const std::uint8_t> bytes) {
  return from_host_.write(bytes);
}

std::size_t VirtualBoard::read(std::span<std::uint8_t> bytes) {
  const std::size_t n = std::min(bytes.size(), to_host_.size());
  const auto end = to_host_.begin() + static_cast<std::ptrdiff_t>(n);
  std::copy(to_host_.begin(), end, bytes.begin());
  to_host_.erase(to_host_.begin(), end);
  return n;
}

void VirtualBoard::reconnect() {
  from_host_.clear();
  to_host_.clear();
  controller_->set_host_present(false);
  controller_->new_connection();
  controller_->set_host_present(true);
}

void VirtualBoard::set_host_present(bool present) { controller_->set_host_present(present); }

void VirtualBoard::pin_changed(Pin pin, bool level, Picoseconds at) {
  switch (pin) {
    case Pin::lamp_sync:
      if (!own_edges_) fire_.sync_changed(level, at);
      break;
    case Pin::lamp_trigger:
      if (own_edges_) fire_.sync_changed(level, at);
      break;
    case Pin::photosensor_1:
    case Pin::photosensor_2:
    case Pin::photosensor_3:
    case Pin::photosensor_4: {
      if (!level) break;
      const int channel = static_cast<int>(pin) - static_cast<int>(Pin::photosensor_1);
      const auto clock = static_cast<std::uint64_t>(at / ps_per_clock);
      controller_->photosensors(0, clock);  // the sensor's time may be over
      controller_->photosensors(static_cast<std::uint8_t>(1 << channel), clock);
      break;
    }
    default:
      report_input(pin);
      break;
  }
  check_outputs();
}

/// Reports an input to the core after a change of its level or of its polarity in the settings.
void VirtualBoard::report_input(Pin pin) {
  using machine::Input;
  const auto* found = std::find_if(input_pins.begin(), input_pins.end(),
                                   [pin](const InputPin& known) { return known.pin == pin; });
  const Input input = found->input;
  const machine::InputSet bit = machine::set_of(input);
  const bool low_is_active = (machine::active_low(stored_) & bit) != 0;
  const bool active = bus_.level(pin) != low_is_active;
  if (active == ((told_inputs_ & bit) != 0)) return;
  told_inputs_ = static_cast<machine::InputSet>(told_inputs_ ^ bit);
  if (input == Input::estop && active) stop_dead();
  controller_->input_changed(input, active, present_position());
  if (machine::is_limit(input) && active && controller_->state() == wire::MachineState::alarm)
    stop_dead();
}

/// Position of the motors: steps put out so far.
StepPosition VirtualBoard::present_position() const {
  StepPosition steps{};
  if (!blocks_.empty()) steps = position_at_tick(std::max(played_, blocks_.front().first_tick));
  for (int a = 0; a < max_axes; ++a) steps[index(a)] -= axes_[index(a)].owed();
  return steps;
}

Picoseconds VirtualBoard::token_expiry() const {
  if (!token_held_ || token_.expires_tick >= ticks_.end_tick()) return never;
  return std::max(now_, ticks_.time_of(std::max(token_.expires_tick, played_)));
}

Picoseconds VirtualBoard::next_event() const {
  return std::min({world_->next_event(), next_service_, fire_.next_event(), bits_change_,
                   token_expiry(), next_change()});
}

/// When outputs of the program change next, as far as ticks have a time.
Picoseconds VirtualBoard::next_change() const {
  std::uint32_t low = 0;
  if (!controller_->next_change(low)) return never;
  const auto ahead = static_cast<std::int32_t>(low - static_cast<std::uint32_t>(played_));
  if (ahead <= 0) return now_;
  const std::uint64_t tick = played_ + static_cast<std::uint64_t>(ahead);
  return tick < ticks_.end_tick() ? std::max(now_, ticks_.time_of(tick)) : never;
}

void VirtualBoard::play_changes() {
  while (next_change() <= now_) {
    std::uint32_t low = 0;
    controller_->next_change(low);
    controller_->play_changes(low);
    put_switched_outputs();
  }
}

void VirtualBoard::put_switched_outputs() {
  const machine::SwitchedOutputs outputs = controller_->switched_outputs();
  bus_.set_aux(outputs.aux, now_);
  bus_.set(Pin::air, outputs.air, now_);
  bus_.set(Pin::enable_z, outputs.z_enable, now_);
}

/// Steps that may operate a switch are put out in short slices.
Picoseconds VirtualBoard::next_look() const {
  const Picoseconds look = world_->next_look(now_);
  if (look == never) return never;
  const bool moves = std::any_of(blocks_.begin(), blocks_.end(),
                                 [](const stepper::TickBlock& block) { return block.moving; });
  return moves ? look : never;
}

void VirtualBoard::run_until(Picoseconds until) {
  while (now_ < until) {
    const Picoseconds next = std::max(now_, std::min({until, next_event(), next_look()}));
    play(next);
    now_ = next;
    play_changes();
    if (fire_.drive(bus_, now_)) report_shot(true);
    world_->advance(now_);
    if (fire_.decision_due(now_)) decide();
    if (token_expiry() <= now_) {
      withdraw_token();
      take_token();
    }
    if (next_service_ <= now_) service();
  }
}

void VirtualBoard::service() {
  next_service_ = now_ + service_period;
  controller_->photosensors(0, static_cast<std::uint64_t>(now_ / ps_per_clock));
  for (const InputPin& input : input_pins) report_input(input.pin);
  if (planned_at_ == never) {
    main_loop();
  } else if (planned_at_ <= now_) {
    planned_at_ = never;
    controller_->commit();
    controller_->service_host();
  }
  feed_lattice();
  check_outputs();
  take_token();
}

void VirtualBoard::main_loop() {
  std::uint8_t command = 0;
  while (from_host_.pop_realtime(command)) controller_->receive_realtime(command);
  std::array<std::uint8_t, bytes_per_service> packet;
  const auto room = std::span(packet).first(std::min(packet.size(), controller_->receive_room()));
  const std::size_t received = from_host_.pop(room);
  if (received != 0) controller_->receive(room.first(received), from_host_.before_jog_cancel());
  // Steps that are filled have the old times.
  if (controller_->take_settings(stored_)) new_times_tick_ = filled_;
  if (const machine::PersistentState* kept = controller_->take_kept()) kept_ = *kept;
  controller_->measure_sensor(sensor_level());
  controller_->prepare(static_cast<std::uint64_t>(now_ / ps_per_clock));
  if (controller_->plan_waits()) {
    while (controller_->plan()) {
    }
    if (planning_time_ != 0) planned_at_ = now_ + planning_time_;
  }
  if (planned_at_ == never) controller_->commit();
  controller_->service_host();
  const std::size_t free = host_buffer - std::min(host_buffer, to_host_.size());
  const std::size_t sent =
      controller_->transmit(std::span(packet).first(std::min(packet.size(), free)));
  to_host_.insert(to_host_.end(), packet.begin(),
                  packet.begin() + static_cast<std::ptrdiff_t>(sent));

  const machine::FireTiming timing = controller_->fire_timing();
  fire_.configure(timing);
  own_edges_ = timing.own_edges;
}

/// As a converter of 12 bits sees it.
std::uint16_t VirtualBoard::sensor_level() const {
  constexpr double results = 4096;
  const double result = bus_.sensor_volts() / HeatSensor::reference_volts * results;
  return static_cast<std::uint16_t>(static_cast<unsigned>(std::min(result, results - 1)) << 4);
}

void VirtualBoard::feed_lattice() {
  while (ticks_.end_time() < now_ + timing_lead) next_span();
  while (filled_ < ticks_.end_tick() + motion_lead_ticks) {
    // At rest, fill no more ticks than needed, because the next motion waits for their end; the
    // same for motion that a real board would have been commanded to stop by then.
    const bool runs = controller_->runner().generator().running();
    // The scale of the power acts on what is filled.
    const bool is_scaled = controller_->values().milli(settings::Id::loop) != 0;
    const bool ends_anytime = controller_->may_abort_move() || is_scaled;
    const auto missing =
        static_cast<std::uint32_t>(ticks_.end_tick() + motion_lead_ticks - filled_);
    stepper::TickBlock block;
    controller_->fill(block, !runs ? motion_lead_ticks : ends_anytime ? missing : block_ticks);
    filled_ = block.first_tick + block.ticks;
    blocks_.push_back(block);
  }
  bits_change_ = never;
  for (const stepper::TickBlock& block : blocks_) {
    if (block.bits == bits_ || block.first_tick < played_) continue;
    if (block.first_tick < ticks_.end_tick()) bits_change_ = ticks_.time_of(block.first_tick);
    break;
  }
}

void VirtualBoard::next_span() {
  const std::uint64_t beat = controller_->clock().next_beat();
  ticks_.push(controller_->next_span(span_ticks));
  if (listener_ != nullptr && controller_->clock().next_beat() != beat)
    listener_->beat_begins(ticks_.end_tick(), ticks_.end_time());
}

void VirtualBoard::play(Picoseconds until) {
  const std::uint64_t to_tick = std::min(ticks_.first_tick_from(until), filled_);
  while (played_ < to_tick) {
    const stepper::TickBlock& block = blocks_.front();
    const std::uint64_t end = block.first_tick + block.ticks;
    if (played_ == block.first_tick) begin_block(block);
    play_block(block, std::min(end, to_tick));
    if (end > to_tick) break;
    recent_blocks_.push_back(block);
    blocks_.pop_front();
  }
  forget();
  // A block that begins right here changes the bits now.
  if (bits_change_ <= until) {
    if (!blocks_.empty() && blocks_.front().first_tick <= played_ && blocks_.front().bits != bits_)
      apply_bits(blocks_.front().bits, until);
    bits_change_ = never;
    feed_lattice();
  }
}

/// Drops ticks that are older than any look-back.
void VirtualBoard::forget() {
  // A tick is not shorter than three quarters of a microsecond.
  const auto lag_ticks = static_cast<std::uint64_t>(max_lag_ / (ps_per_us * 3 / 4));
  const std::uint64_t before = played_ > lag_ticks ? played_ - lag_ticks : 0;
  while (recent_blocks_.size() > remembered_blocks &&
         recent_blocks_[recent_blocks_.size() - remembered_blocks].first_tick < before)
    recent_blocks_.pop_front();
  ticks_.drop_before(before);
}

void VirtualBoard::begin_block(const stepper::TickBlock& block) {
  if (block.first_tick >= new_times_tick_) {
    for (AxisOutput& axis : axes_) axis.set_times(stepper::pulse_output(stored_));
    new_times_tick_ = no_tick;
  }
  if (block.bits != bits_) apply_bits(block.bits, ticks_.time_of(block.first_tick));
  for (int a = 0; a < max_axes; ++a)
    cursors_[index(a)] =
        block.moving ? StepCursor(block.axis[index(a)], block.ticks) : StepCursor();
}

void VirtualBoard::play_block(const stepper::TickBlock& block, std::uint64_t to_tick) {
  const auto time_of = [this](std::uint64_t tick) { return ticks_.time_of(tick); };
  for (int a = 0; a < max_axes; ++a)
    axes_[index(a)].play(block, cursors_[index(a)], played_, to_tick, time_of);
  play_power(block, to_tick);
  if (listener_ != nullptr) report_ticks(block, to_tick);
  played_ = to_tick;
}

/// Puts out the block's laser power up to a tick.
void VirtualBoard::play_power(const stepper::TickBlock& block, std::uint64_t to_tick) {
  if ((block.bits & stepper::gate_bit) == 0) return;
  // In power cells from the start of a change on, as fill_axes() counts them.
  constexpr std::uint64_t cell = stepper::power_cell_ticks;
  const std::uint64_t end = block.first_tick + block.ticks;
  for (std::uint64_t tick = played_; tick < to_tick;) {
    const std::uint64_t into = (tick - block.first_tick) % cell;
    if (into == 0) {
      const std::uint64_t middle = tick + std::min(cell, end - tick) / 2;
      power_ = block.power(static_cast<std::uint32_t>(middle - block.first_tick));
      put_power(ticks_.time_of(tick));
    }
    tick += cell - into;
  }
}

void VirtualBoard::report_ticks(const stepper::TickBlock& block, std::uint64_t to_tick) {
  if (to_tick == played_) return;
  listener_->ticks_played(
      {block, played_, to_tick, ticks_.time_of(played_), ticks_.time_of(to_tick)});
}

void VirtualBoard::apply_bits(std::uint8_t bits, Picoseconds at) {
  bits_ = bits;
  // The laser first: listeners to the other pins read all outputs when one of them changes.
  put_gate(at);
  if ((bits & stepper::gate_bit) == 0 && power_ != 0) {
    power_ = 0;
    put_power(at);
  }
  bus_.set(Pin::arm, (bits & stepper::arm_bit) != 0, at);
  bus_.set(Pin::lamp_trigger, (bits & stepper::trigger_bit) != 0, at);
}

void VirtualBoard::put_gate(Picoseconds at) {
  bus_.set(Pin::laser_gate, laser_enabled_ && (bits_ & stepper::gate_bit) != 0, at);
}

void VirtualBoard::put_power(Picoseconds at) {
  bus_.set_power(laser_enabled_ ? power_ : controller_->outputs().attenuator, at);
}

/// Position of the motors.
StepPosition VirtualBoard::position_at_tick(std::uint64_t tick) const {
  StepPosition steps{};
  for (const auto* blocks : {&recent_blocks_, &blocks_}) {
    for (const stepper::TickBlock& block : *blocks) {
      if (tick > block.first_tick + block.ticks || tick < block.first_tick) continue;
      const auto n = static_cast<std::uint32_t>(tick - block.first_tick);
      for (int a = 0; a < max_axes; ++a)
        steps[index(a)] = static_cast<std::int32_t>(block.axis[index(a)].position_after(n).hi());
      return steps;
    }
  }
  return steps;
}

/// The loads at a tick of the lattice: they follow the steps a lag later.
StepPosition VirtualBoard::load_at_tick(std::uint64_t tick) const {
  StepPosition steps = position_at_tick(tick);
  for (int axis = 0; axis < max_axes; ++axis) {
    const Picoseconds lag = world_->drives().lag(axis);
    if (lag == 0) continue;
    steps[index(axis)] = position_at_tick(tick_before(ticks_, tick, lag))[index(axis)];
  }
  return controller_->runner().generator().kinematics().loads_of(steps);
}

void VirtualBoard::decide() {
  const bool loaded = token_held_ && controller_->outputs().fire_enable &&
                      played_ >= token_.not_before_tick && played_ < token_.expires_tick;
  const Verdict verdict = fire_.decide((bits_ & stepper::arm_bit) != 0, loaded);
  if (loaded) token_held_ = false;
  if (verdict.fired) {
    shot_ = verdict;
    return;
  }
  controller_->lamp_edge(verdict.edge_clock, false, loaded);
  take_token();
}

void VirtualBoard::report_shot(bool fired) {
  if (!shot_.fired) return;
  if (fired) {
    const std::uint64_t tick = controller_->clock().tick_of_beat(token_.beat);
    lattice_shots_.push_back({token_.beat, load_at_tick(tick)});
  }
  shot_.fired = false;
  controller_->lamp_edge(shot_.edge_clock, fired, true);
  take_token();
}

void VirtualBoard::take_token() {
  if (!token_held_) token_held_ = controller_->next_token(token_, played_);
  apply_beam();
}

void VirtualBoard::apply_beam() {
  const machine::Outputs outputs = controller_->outputs();
  // Close shutters first, so that no two are open together.
  for (const bool level : {false, true})
    for (int channel = 0; channel < beam_channels; ++channel)
      if ((outputs.shutters >> channel & 1) == (level ? 1 : 0))
        bus_.set(shutter_pin(channel), level, now_);
  bus_.set_attenuator(outputs.attenuator);
  laser_enabled_ = outputs.laser_enable || laser_enabled_by_hand_;
  put_gate(now_);
  put_power(now_);
}

void VirtualBoard::withdraw_token() {
  if (!token_held_) return;
  token_held_ = false;
  controller_->token_expired();
}

void VirtualBoard::check_outputs() {
  const machine::Outputs outputs = controller_->outputs();
  bus_.set(Pin::enable, outputs.drives_enable, now_);
  put_switched_outputs();
  apply_beam();
  if (outputs.fire_enable) return;
  withdraw_token();
}

void VirtualBoard::stop_dead() {
  // The tick line stops: filled ticks are lost; the steps put out so far are the position.
  fire_.disarm(bus_, now_);
  report_shot(false);
  const StepPosition steps = present_position();
  for (AxisOutput& axis : axes_) axis.stop();
  cursors_ = {};
  for (stepper::TickBlock& block : blocks_) {
    block.moving = false;
    block.bits = 0;
    for (int a = 0; a < max_axes; ++a) {
      block.axis[index(a)] = stepper::AxisRun{};
      block.axis[index(a)].position_q64 = stepper::middle_of_step(steps[index(a)]);
    }
  }
  apply_bits(0, now_);
  controller_->stopped_at(steps);
}

}  // namespace lamplock::sim
