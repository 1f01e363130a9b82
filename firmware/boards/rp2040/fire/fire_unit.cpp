#include "firmware/boards/rp2040/fire/fire_unit.hpp"

#include "firmware/boards/rp2040/base/allocation.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"

namespace lamplock::rp2040 {
namespace {

using boards::Role;
using namespace pio;

static_assert(fire_machine.block == 0 && fire_machine.number == 3);  // as in cut_off()

constexpr unsigned q_switch_gpio = boards::gpio(Role::q_switch);
constexpr unsigned arm_gpio = boards::gpio(Role::shot_enable);
constexpr unsigned sync_gpio = boards::gpio(Role::lamp_sync);
constexpr std::uint32_t fire_shift = pio_shiftctrl::out_right;
/// Holds ARM low on the pad until FIRE has finished a decision begun before.
void wait_16_clocks() { asm volatile(".rept 16\n nop\n .endr" ::: "memory"); }

void set_sync(unsigned gpio) {
  fire_machine.machine().pinctrl = pio_pinctrl::set(q_switch_gpio, 1) | pio_pinctrl::in(gpio);
}

}  // namespace

void FireUnit::start() {
  pio::load(pio0(), fire_program.program, fire_offset);
  fire_machine.configure(fire_program.program, fire_offset, arm_gpio);
  fire_machine.make_outputs_low(q_switch_gpio, 1);
  set_sync(sync_gpio);
  io_bank0().gpio[q_switch_gpio].ctrl =
      io_ctrl::function(io_ctrl::Function::pio0) | io_ctrl::output_low;
  force_low(arm_gpio);
}

void FireUnit::restart() const {
  fire_machine.disable();
  fire_machine.restart(fire_shift, fire_offset + fire_program.program.wrap_target);
  fire_machine.execute(encode::set(SetTo::pins, 0));
  fire_machine.enable();
}

void FireUnit::configure(const machine::FireTiming& timing) {
  const bool same = timing.delay_clocks == timing_.delay_clocks &&
                    timing.width_clocks == timing_.width_clocks &&
                    timing.own_edges == timing_.own_edges;
  if (same || keeper_.is_out()) return;
  if (timing.own_edges != timing_.own_edges) {
    const bool own = timing.own_edges && boards::has(Role::lamp_trigger);
    const unsigned gpio = own ? boards::optional_gpio(Role::lamp_trigger) : sync_gpio;
    set_sync(gpio);
    lattice_.use_sync(gpio);
  }
  timing_ = timing;
  word_ = token_word(timing);
}

bool FireUnit::has_result() { return fire_machine.rx_level() != 0; }

void FireUnit::read_fifo(std::uint32_t& count) {
  while (count < max_results && fire_machine.rx_level() != 0)
    results_[count++] = fire_machine.read();
}

std::uint64_t FireUnit::edge_of(std::uint32_t result, std::uint64_t latest, std::uint64_t now) {
  const std::uint32_t age = result == fired_result ? timing_.delay_clocks : fire_decision_clock;
  std::uint64_t edge = 0;
  if (stamps_.find(lattice_.stamps(), latest - age, now, edge)) return edge;
  return latest - age;
}

void FireUnit::report(machine::Controller& core, std::uint32_t count, std::uint64_t now) {
  // The newest result belongs to the newest edge; reported in the order in which they happened.
  std::uint64_t edges[max_results];
  std::uint64_t latest = now + clocks_per_us;
  for (std::uint32_t i = count; i-- != 0;) {
    edges[i] = edge_of(results_[i], latest, now);
    latest = edges[i];  // FIRE accepts no two edges closer than a decision takes
  }
  stamps_.used(edges[count - 1]);
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool fired = results_[i] == fired_result;
    const bool spent = keeper_.result(results_[i] != 0);
    core.lamp_edge(edges[i], fired, spent);
  }
}

bool FireUnit::is_running() { return (pio0().ctrl & pio_ctrl::enable(fire_machine.mask())) != 0; }

bool FireUnit::load() {
  const AllMasked masked;  // a cut in between would be undone
  if (!is_running()) return false;
  release(arm_gpio);
  fire_machine.write(word_);
  keeper_.loaded();
  return true;
}

bool FireUnit::pulse_lasts() {
  const unsigned place = fire_machine.place(fire_offset);
  return place >= fire_program.delay && place < fire_program.after;
}

bool FireUnit::withdraw() const {
  force_low(arm_gpio);
  wait_16_clocks();
  const AllMasked masked;  // a cut in between would be undone
  if (!is_running() || pulse_lasts()) return false;
  fire_machine.disable();
  const bool there = fire_machine.tx_level() != 0;
  if (there) {
    fire_machine.execute(encode::pull(false, false));
    // If FIRE is between its pull and its out, it finds no token.
    fire_machine.execute(encode::move(MoveTo::osr, MoveFrom::null));
  }
  fire_machine.enable();
  return there;
}

void FireUnit::change_token(machine::Controller& core, std::uint64_t now) {
  using Action = TokenKeeper::Action;
  std::uint64_t tick = 0;
  bool known = false;  // finding the tick takes longer than the rest
  // At most: withdraw one, take the next, load it.
  for (int i = 0; i < 3 && is_due(core, now); ++i) {
    if (!known) {
      tick = feed_.tick_at(now);
      known = true;
    }
    switch (keeper_.next(tick, core.shots().permitted())) {
      case Action::nothing:
        return;
      case Action::take: {
        lamp::FireToken token;
        if (!core.next_token(token, tick)) return;
        keeper_.taken(token);
        has_due_ = false;
        break;
      }
      case Action::load:
        if (!load()) return;
        has_due_ = false;
        break;
      case Action::drop:
        keeper_.dropped();
        core.token_expired();
        break;
      case Action::withdraw:
        if (!withdraw()) return;
        keeper_.withdrawn();
        core.token_expired();
        break;
    }
  }
}

bool FireUnit::next_clock(std::uint64_t& clock) {
  std::uint64_t tick = 0;
  if (!keeper_.next_tick(tick)) return false;
  // The length of a tick never changes.
  if (!has_due_) has_due_ = feed_.clock_of(tick, due_clock_);
  clock = due_clock_;
  return has_due_;
}

void FireUnit::stopped(machine::Controller& core, std::uint64_t cut) {
  force_low(arm_gpio);
  std::uint32_t count = 0;
  read_fifo(count);
  if (count != 0) report(core, count, cut);
  if (!keeper_.is_out()) return;
  if (!keeper_.is_loaded() || fire_machine.tx_level() != 0) {
    keeper_.withdrawn();
    core.token_expired();
    return;
  }
  // An edge has consumed the token and its result was not read: fired if the pulse began.
  const unsigned place = fire_machine.place(fire_offset);
  const bool fired = place >= fire_program.pulse && place < fire_program.after;
  results_[0] = fired ? fired_result : 1;
  report(core, 1, cut);
}

}  // namespace lamplock::rp2040
