#include "firmware/boards/rp2040/board.hpp"

#include <new>

#include "firmware/boards/rp2040/base/interrupts.hpp"
#include "firmware/boards/rp2040/base/rom.hpp"
#include "firmware/boards/rp2040/base/second_core.hpp"
#include "firmware/boards/rp2040/base/sensor.hpp"
#include "firmware/boards/rp2040/fault.hpp"

extern "C" void second_core();

namespace lamplock::rp2040 {
namespace {
using std::string_view_literals::operator""sv;

/// At the end of memory, where alignment causes no gaps (toolchain/arm/rp2040.ld).
[[gnu::section(".bss.rings.stamps")]] StampRing stamp_ring;
[[gnu::section(".bss.rings.power")]] PowerRing power_ring;
[[gnu::section(".bss.rings.lattice")]] LatticeRings lattice_rings;
[[gnu::section(".bss.rings.ticks")]] TickRing tick_ring;

/// The one board; built by main().
alignas(Board) std::byte board_memory[sizeof(Board)];

Board& board() { return *std::launder(reinterpret_cast<Board*>(board_memory)); }

/// The UART's send pin in maps that have one.
constexpr unsigned uart_send_gpio = boards::optional_gpio(boards::Role::uart_tx);

constexpr bool has_drives = boards::this_board.drives.has_value();

boards::Pins pins_of(const settings::Values& stored) {
  return boards::this_board.map(static_cast<boards::PinMap>(stored.whole(settings::Id::pin_map)))
      .pins;
}
/// Shortest beat. A job with a point on every beat of this length keeps core 0 busy for nine tenths
/// of the time (docs/chip-timing.md).
constexpr std::uint32_t min_beat_clocks = 25'000;

boards::SettingLimits limits_of(boards::Pins map) {
  boards::SettingLimits limits = boards::limits_of(boards::this_board, map);
  limits.max_lamp_milli_hz = clock_hz / min_beat_clocks * 1000;
  return limits;
}
machine::BoardFeatures features_of(boards::Pins map) {
  return {.name = boards::this_board.name,
          .limits = limits_of(map),
          .inputs = Inputs(map).all(),
          .outputs = boards::program_outputs(map),
          .second_wire = boards::axes_of_z_enable(map),
          .parts = machine::HandoutMode::staged,
          .loads_planners = true};
}
/// The settings in flash; those of another board are replaced.
settings::Values settings_of(Storage& storage, const machine::BoardFeatures& features) {
  settings::Values values = storage.load_settings();
  boards::fit_settings(features.limits, values);
  return values;
}

/// Time for the last messages to reach the host before the boot loader starts.
constexpr std::uint64_t last_words_us = 50'000;
static_assert(last_words_us < Watchdog::timeout_us);

constexpr std::uint32_t used_blocks = reset_bit::busctrl | reset_bit::dma | reset_bit::io_bank0 |
                                      reset_bit::pads_bank0 | reset_bit::pio0 | reset_bit::pio1 |
                                      reset_bit::pwm | reset_bit::syscfg | reset_bit::sysinfo |
                                      reset_bit::timer;

}  // namespace

// The settings are read twice: a permanent copy would use SRAM.
Board::Board(const Rings& rings)
    : map_(pins_of(storage_.load_settings())),
      core_(settings_of(storage_, features_of(map_)), mask_, features_of(map_)),
      ports_(uart_send_gpio),
      real_time_(map_, rings) {}

void Board::start_ports() {
  const std::array<char, 16> number = flash_unique_number();
  ports_.usb().set_serial_number({number.data(), number.size()});
  ports_.usb().start();
  if (boards::find_gpio(map_, boards::Role::uart_tx)) ports_.uart().start(clock_hz);
}

void Board::report_rejected(std::string_view what, std::uint32_t records) {
  if (records == 0) return;
  TextLine line;
  line.add(what).add(": rejected records ").add(std::int64_t{records});
  core_.report_message(line.view());
}

/// Names the first stored setting that the image has replaced, if the settings are those of another
/// board.
void Board::report_replaced() {
  if (!storage_.has_settings()) return;
  const settings::Id id = boards::unfit_setting(features_of(map_).limits, storage_.load_settings());
  if (id == settings::Id::count) return;
  TextLine line;
  line.add("Settings of another board replaced: $"sv).add(std::int64_t{settings::number(id)});
  line.add("; check $$"sv);
  core_.report_message(line.view());
}

void Board::start_kept() {
  machine::PersistentState kept;
  storage_.load_program(kept);
  core_.set_kept(kept);
  report_rejected("Program", storage_.rejected_programs());
}

void Board::start() {
  TextLine line;
  const LastRun last = take_last_run();
  describe(last, line);
  core_.report_message(line.view());
  if (last.in_job) core_.start_in_alarm();
  report_rejected("Settings", storage_.rejected_settings());
  report_replaced();
  start_kept();
  for (const InterruptEntry& entry : interrupt_entries)
    set_priority(entry.irq, static_cast<std::uint32_t>(entry.level));
  start_ports();
  watchdog_.start();
  // Last: from here on ticks run out unless they are fed.
  const bool is_this_board = real_time_.start(core_);
  Sensor::start();
  if (is_this_board && has_drives) {
    drives_.start();
    drives_.begin(features_of(map_), core_.stored(), timer().timerawl);
  }
  nvic().iser =
      irqs_of(Level::estop) | irqs_of(Level::beat) | irqs_of(Level::link) | irqs_of(Level::fill);
  second_core_ = start_second_core(second_core);
  if (!second_core_) core_.report_message("Core 1 does not answer: core 0 plans");
}

void Board::run() {
  start();
  for (;;) {
    if (!pass()) wait_for_interrupt();
  }
}

void Board::plan_for_ever() {
  for (;;) {
    while (!core_.plan_waits()) wait_for_event();
    bool more = true;
    while (more) {
      more = core_.plan();
      // Also after the last slice: a batch of lines is only one, and the next may follow at once.
      watchdog_.sign(Signer::planner);
    }
    send_event();
  }
}

bool Board::pass() {
  if constexpr (has_drives) serve_drives();
  if (drives_.settled()) receive();
  store_kept();
  store_settings();  // before a job that followed them in the same bytes begins to move
  const bool more = work();
  transmit();
  {
    const machine::Masked masked(mask_);
    real_time_.poll(core_);
    note_job();
  }
  if (core_.loader_requested()) enter_loader();
  sign();
  return more;
}

bool Board::load_planner() {
  const machine::PlannerKind missing = core_.missing_planner();
  if (missing == machine::PlannerKind::none) return false;
  core_.set_loaded_planner(machine::PlannerKind::none);
  core_.set_loaded_planner(planners_.load(missing));
  return true;
}

void Board::sign() {
  watchdog_.sign(Signer::main_loop);
  if (!second_core_ || !core_.planning()) watchdog_.sign(Signer::planner);
  watchdog_.service();
}

void Board::receive() {
  if (ports_.take_loss()) core_.lose_lines();
  core_.set_host_present(ports_.host_present());
  std::array<std::uint8_t, piece> bytes;
  for (int i = 0; i < max_pieces; ++i) {
    if (ports_.realtime_waits()) receive_realtime();
    // Read each time: the last bytes may have begun a job, or filled the room for lines.
    const std::size_t room = core_.receive_room();
    const auto free = std::span<std::uint8_t>(bytes).first(room < piece ? room : piece);
    const std::size_t n = ports_.read(free, core_.job_unfinished());
    if (ports_.take_new_connection()) core_.new_connection();
    if (n == 0) return;
    core_.set_host_present(ports_.host_present());
    core_.receive(free.first(n), ports_.before_jog_cancel());
    if (core_.batch_waits()) return;  // the other core is idle meanwhile
  }
}

/// Commands of one byte bypass the lines before them.
void Board::receive_realtime() {
  std::uint8_t byte = 0;
  for (std::uint32_t i = 0; i < wire::RealtimeInbox::capacity; ++i) {
    const bool any = ports_.read_realtime(byte, core_.job_unfinished());
    if (ports_.take_new_connection()) core_.new_connection();
    if (!any) break;
    core_.receive_realtime(byte);
  }
}

bool Board::work() {
  bool more = prepare();
  if (!second_core_ && more) more = core_.plan();  // only a slice: the host must not wait
  if (hand_out()) more = prepare();                // the other core need not wait for a whole round
  return more;
}

bool Board::prepare() {
  bool plan = false;
  core_.look_ahead();
  if constexpr (Sensor::exists) core_.measure_sensor(Sensor::level());
  {
    const machine::Masked masked(mask_);
    real_time_.top_up(core_);
    plan = core_.prepare(real_time_.now());
  }
  if (!plan) return load_planner();  // while it is missing no plan is handed out
  if (!second_core_) return true;
  if (core_.plan_waits()) send_event();
  return !core_.planning();
}

bool Board::hand_out() {
  bool any = false;
  do {
    core_.stage();
    const machine::Masked masked(mask_);
    real_time_.top_up(core_);
    any = core_.commit() || any;
  } while (core_.part_waits());
  return any;
}

void Board::transmit() {
  core_.service_host();
  std::array<std::uint8_t, piece> bytes;
  for (std::size_t room = ports_.room(); room != 0;) {
    const std::size_t n =
        core_.transmit(std::span<std::uint8_t>(bytes).first(room < piece ? room : piece));
    if (n == 0) break;
    ports_.write(std::span<const std::uint8_t>(bytes).first(n));
    room -= n;
  }
  ports_.poll();
}

void Board::store_settings() {
  if (!core_.settings_due()) return;  // called in every round, and a copy is long
  settings::Values values;
  core_.take_settings(values);
  real_time_.change_pulses(core_, mask_);
  watchdog_.allow(Watchdog::max_us);
  if (!storage_.save(values)) core_.report_message("Settings could not be stored");
  if constexpr (has_drives) {
    // A move that follows in the same bytes must find the drives enabled: a tenth of a second.
    drives_.begin(features_of(map_), values, timer().timerawl);
    while (!drives_.settled()) serve_drives();
    core_.drives_were_off();
  }
}

void Board::serve_drives() {
  drives_.service(timer().timerawl, core_.state() != wire::MachineState::run,
                  [this](std::string_view line) { core_.report_message(line); });
  const machine::Masked masked(mask_);
  real_time_.permit_drives(drives_.ready(), drives_.failed());
}

void Board::store_kept() {
  const machine::PersistentState* kept = core_.take_kept();
  if (kept == nullptr) return;
  watchdog_.allow(Watchdog::max_us);
  if (!storage_.save(*kept)) core_.report_message("Offsets could not be stored");
}

void Board::enter_loader() {
  watchdog_.allow(Watchdog::timeout_us);
  const std::uint64_t end = microseconds() + last_words_us;
  while (microseconds() < end) transmit();
  asm volatile("cpsid i" ::: "memory");
  make_outputs_safe();
  forget_run();
  Watchdog::stop();
  release_second_core();
  for (;;) reset_to_usb_boot();
}

}  // namespace lamplock::rp2040

void estop_irq() { lamplock::rp2040::board().estop_interrupt(); }
void edge_irq() { lamplock::rp2040::board().edge_interrupt(); }
void beat_irq() { lamplock::rp2040::board().beat_interrupt(); }
void usb_irq() { lamplock::rp2040::board().usb_interrupt(); }
void uart_irq() { lamplock::rp2040::board().uart_interrupt(); }
void fill_irq() { lamplock::rp2040::board().fill_interrupt(); }
void second_core() { lamplock::rp2040::board().plan_for_ever(); }

int main() {
  using namespace lamplock::rp2040;
  release_reset(used_blocks);
  (new (board_memory) Board({tick_ring, lattice_rings, power_ring, stamp_ring}))->run();
}
