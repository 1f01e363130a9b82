#include "sim/chip/rom/boot_rom.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/chip/rom/crc32.hpp"

namespace lamplock::sim::chip {

/// Numbers of the traps: the immediate of UDF.
enum class BootRom::Trap : std::uint8_t {
  lookup = 1,
  popcount,
  reverse,
  leading_zeros,
  trailing_zeros,
  memset_start,
  memset_block,
  memset4_block,
  memcpy_start,
  memcpy_block,
  memcpy44_block,
  connect,
  connect_wait,
  exit_xip_start,
  exit_xip,
  erase_start,
  program_start,
  flash_write,
  flush,
  enter_xip,
  reset_usb,
  usb_boot,
  boot_start,
  boot_main,
  boot_attempt,
  boot_read,
  boot_check,
  boot_enter,
  wait_start,
  wait,
  bad
};

namespace {

// Addresses (RP2040 datasheet, 2.2) and fields; each is used in one function.
constexpr std::uint32_t set_alias = 0x2000, clear_alias = 0x3000;
constexpr std::uint32_t syscfg = 0x4000'4000, clocks = 0x4000'8000, resets = 0x4000'c000;
constexpr std::uint32_t psm_wdsel = 0x4001'0008;
constexpr std::uint32_t qspi_select_control = 0x4001'800c, io_qspi = 0x4001'8000;
constexpr std::uint32_t pads_sd0 = 0x4002'0008;  // VOLTAGE_SELECT, SCLK, SD0...
constexpr std::uint32_t watchdog = 0x4005'8000, chip_reset = 0x4006'4008;
constexpr std::uint32_t xip_ctrl = 0x1400'0000, ssi = 0x1800'0000;
constexpr std::uint32_t sio = 0xd000'0000, scs_vtor = 0xe000'ed08, scs_scr = 0xe000'ed10;

constexpr std::uint32_t reset_io_qspi = 1u << 6, reset_pads_qspi = 1u << 9, reset_syscfg = 1u << 18,
                        reset_timer = 1u << 21;
constexpr std::uint32_t reset_done = 8;
constexpr std::uint32_t rescue_flag = 1u << 24;
constexpr std::uint32_t scratch0 = watchdog + 0x0c, scratch4 = watchdog + 0x1c;
constexpr std::uint32_t boot_magic = 0xb007'c0d3;
constexpr std::uint32_t sram_end = 0x2004'2000;

// SSI registers.
constexpr std::uint32_t ssi_ctrlr0 = ssi, ssi_ctrlr1 = ssi + 4, ssi_enable = ssi + 8,
                        ssi_ser = ssi + 0x10, ssi_baud = ssi + 0x14, ssi_tx_level = ssi + 0x20,
                        ssi_rx_level = ssi + 0x24, ssi_status = ssi + 0x28, ssi_icr = ssi + 0x48,
                        ssi_data = ssi + 0x60, ssi_spi_ctrlr0 = ssi + 0xf4;
constexpr std::uint32_t bytes_both_ways = 7u << 16;
constexpr std::uint32_t boot_divider = 6;  // 2.8.3.1.3: "fixed SCK clock divisor of /6"
constexpr std::uint32_t in_flight = 14;    // less than the receive FIFO's 16

// Forcing of chip select (OUTOVER).
constexpr std::uint32_t force_none = 0, force_low = 2u << 8, force_high = 3u << 8;

// Flash commands.
constexpr std::uint32_t page_program = 0x02, read_data = 0x03, read_status = 0x05,
                        write_enable = 0x06, sector_erase = 0x20;

// Steps of a flash operation, in r4.
enum Phase : std::uint32_t { next, enable, enable_wait, command, data, poll, poll_wait };
// Steps of leaving XIP, in r4.
enum ExitPhase : std::uint32_t { delay_low, clocks_low, delay_high, clocks_high, ones };
constexpr std::uint32_t exit_delay_steps = 256, exit_delay_cycles = 24;  // 6000 in all, assumed

// Steps of core 1's launch, in r4; r5 = word to send.
enum WaitPhase : std::uint32_t {
  drain,
  send,
  receive_1,
  receive_vtor,
  receive_sp,
  receive_entry,
  launch
};
constexpr std::uint32_t fifo_status = sio + 0x50, fifo_write = sio + 0x54, fifo_read = sio + 0x58;
constexpr std::uint32_t fifo_valid = 1, fifo_ready = 2;

constexpr unsigned sp = 13, lr = 14, pc = 15;
constexpr int flash_attempts = 128;

}  // namespace

/// One step of one core: registers, accesses, and the cycles they cost.
class BootRom::Context {
 public:
  Context(RomCore& core, Cycle now) : core_(core), now_(now) {}

  std::uint32_t reg(unsigned number) const { return core_.reg(number); }
  void set(unsigned number, std::uint32_t value) { core_.set_reg(number, value); }
  std::uint32_t load(std::uint32_t address, Width width = Width::word) {
    return take(core_.load(address, width, now_ + cycles_)).value;
  }
  void store(std::uint32_t address, std::uint32_t value, Width width = Width::word) {
    take(core_.store(address, value, width, now_ + cycles_));
  }
  void spend(std::uint32_t cycles) { cycles_ += cycles; }
  /// Goes on behind the trap, or `halfwords` further.
  void leave(std::uint32_t halfwords = 0) { set(pc, core_.reg(pc) + 2 + 2 * halfwords); }
  unsigned core_id() const { return core_.id(); }
  Step result() const { return {std::max(cycles_, 1u), fault_}; }

 private:
  Access take(Access access) {
    cycles_ += 2 + access.wait;  // LDR and STR take two cycles (Cortex-M0+ TRM, 3.3)
    fault_ = fault_ || access.fault;
    return access;
  }
  RomCore& core_;
  Cycle now_;
  std::uint32_t cycles_ = 0;
  bool fault_ = false;
};

/// Lays Thumb code and tables down.
class BootRom::Assembler {
 public:
  explicit Assembler(std::span<std::uint8_t> memory, std::uint32_t at) : memory_(memory), at_(at) {}
  std::uint32_t here() const { return at_; }
  std::uint32_t half(std::uint32_t value) {
    memory_[at_] = static_cast<std::uint8_t>(value);
    memory_[at_ + 1] = static_cast<std::uint8_t>(value >> 8);
    at_ += 2;
    return at_ - 2;
  }
  std::uint32_t trap(Trap number) { return half(0xde00u | static_cast<std::uint32_t>(number)); }
  void branch(std::uint32_t to) { half(0xe000u | (((to - at_ - 4) >> 1) & 0x7ffu)); }
  void call(std::uint32_t to) {
    const std::uint32_t offset = to - at_ - 4;
    const std::uint32_t sign = offset >> 24 & 1u;
    half(0xf000u | sign << 10 | (offset >> 12 & 0x3ffu));
    const std::uint32_t j1 = (~(offset >> 23) ^ sign) & 1u, j2 = (~(offset >> 22) ^ sign) & 1u;
    half(0xd000u | j1 << 13 | j2 << 11 | (offset >> 1 & 0x7ffu));
  }
  void word(std::uint32_t value) {
    half(value & 0xffffu);
    half(value >> 16);
  }
  static constexpr std::uint32_t bx_lr = 0x4770, push = 0xb5f0, pop = 0xbdf0, wfe = 0xbf20,
                                 wfi = 0xbf30, sev = 0xbf40;

 private:
  std::span<std::uint8_t> memory_;
  std::uint32_t at_;
};

BootRom::BootRom(std::span<std::uint8_t> memory, const QspiPins& pins, NotModelled not_modelled,
                 RomTiming timing)
    : memory_(memory), pins_(pins), not_modelled_(std::move(not_modelled)), timing_(timing) {
  if (memory.size() != Bus::rom_size) throw std::invalid_argument("boot ROM: 16 KiB of memory");
  build();
}

void BootRom::build() {
  using A = Assembler;
  // Nothing that is not ours may run: UDF everywhere.
  for (std::size_t i = 0; i < memory_.size(); i += 2) {
    memory_[i] = static_cast<std::uint8_t>(Trap::bad);
    memory_[i + 1] = 0xde;
  }
  A code(memory_, 0x100);
  struct Entry {
    char first, second;
    std::uint32_t address;
  };
  std::vector<Entry> functions;
  const auto listed = [&](const char* letters, std::uint32_t address) {
    functions.push_back({letters[0], letters[1], address | 1u});
    return address;
  };
  // A leaf: one or more traps, then BX LR.
  const auto leaf = [&](std::initializer_list<Trap> traps) {
    const std::uint32_t at = code.here();
    for (const Trap trap : traps) code.trap(trap);
    code.half(A::bx_lr);
    return at;
  };
  // A function that keeps its state in r4..r7.
  const auto framed = [&](std::initializer_list<Trap> traps) {
    const std::uint32_t at = code.half(A::push);
    for (const Trap trap : traps) code.trap(trap);
    code.half(A::pop);
    return at;
  };

  const std::uint32_t lookup = leaf({Trap::lookup});
  listed("P3", leaf({Trap::popcount}));
  listed("R3", leaf({Trap::reverse}));
  listed("L3", leaf({Trap::leading_zeros}));
  listed("T3", leaf({Trap::trailing_zeros}));
  listed("MS", leaf({Trap::memset_start, Trap::memset_block}));
  listed("S4", leaf({Trap::memset_start, Trap::memset4_block}));
  listed("MC", leaf({Trap::memcpy_start, Trap::memcpy_block}));
  listed("C4", leaf({Trap::memcpy_start, Trap::memcpy44_block}));
  const std::uint32_t connect = listed("IF", leaf({Trap::connect, Trap::connect_wait}));
  const std::uint32_t exit_xip = listed("EX", framed({Trap::exit_xip_start, Trap::exit_xip}));
  listed("RE", framed({Trap::erase_start, Trap::flash_write}));
  listed("RP", framed({Trap::program_start, Trap::flash_write}));
  const std::uint32_t flush = listed("FC", leaf({Trap::flush}));
  listed("CX", leaf({Trap::enter_xip}));
  listed("UB", code.here());
  code.trap(Trap::reset_usb);
  dead_ = code.half(A::wfi);
  code.branch(dead_);

  wait_ = listed("WV", code.trap(Trap::wait_start));
  const std::uint32_t wait = code.trap(Trap::wait);
  code.half(A::wfe);
  code.branch(wait);
  code.half(A::sev);
  code.branch(wait);

  usb_boot_ = code.trap(Trap::usb_boot);
  code.branch(dead_);
  const std::uint32_t start = code.trap(Trap::boot_start);
  main_ = code.trap(Trap::boot_main);
  code.call(connect);
  code.call(exit_xip);
  code.half(0x2000);  // MOVS r0, #0
  code.half(0x4680);  // MOV r8, r0: attempts
  attempt_ = code.trap(Trap::boot_attempt);
  code.trap(Trap::boot_read);
  code.trap(Trap::boot_check);
  code.call(flush);
  code.trap(Trap::boot_enter);

  while (code.here() % 4 != 0) code.half(0);
  const std::uint32_t revision = code.here();
  code.word(0x1a30'0001);  // of this model, not of any real ROM
  const std::uint32_t copyright = code.here();
  constexpr char text[] = "lamplock model of the RP2040 boot ROM";
  static_assert(sizeof text % 2 == 0);
  for (std::size_t i = 0; i < sizeof text; i += 2)
    code.half(static_cast<std::uint8_t>(text[i]) |
              static_cast<std::uint32_t>(static_cast<std::uint8_t>(text[i + 1])) << 8);

  const auto table = [&](const std::vector<Entry>& entries) {
    const std::uint32_t at = code.here();
    for (const Entry& entry : entries) {
      code.half(static_cast<std::uint8_t>(entry.first) |
                static_cast<std::uint32_t>(static_cast<std::uint8_t>(entry.second)) << 8);
      code.half(entry.address);
    }
    code.half(0);
    return at;
  };
  function_table_ = table(functions);
  data_table_ = table({{'G', 'R', revision}, {'C', 'R', copyright}});

  // Vectors and the words at fixed places (2.8.3).
  A vectors(memory_, 0);
  vectors.word(boot2_address);
  vectors.word(start | 1u);
  vectors.word(dead_ | 1u);
  vectors.word(dead_ | 1u);
  vectors.half('M' | 'u' << 8);
  vectors.half(0x01 | 3u << 8);  // version 3: revision B2
  vectors.half(function_table_);
  vectors.half(data_table_);
  vectors.half(lookup | 1u);
}

bool BootRom::is_trap(std::uint32_t address) const {
  return address + 1 < memory_.size() && (address & 1u) == 0 && memory_[address + 1] == 0xde &&
         memory_[address] != static_cast<std::uint8_t>(Trap::bad);
}

BootRom::Step BootRom::step(RomCore& core, Cycle now) {
  const std::uint32_t at = core.reg(pc);
  Context context(core, now);
  if (!is_trap(at)) return {1, true};
  run(static_cast<Trap>(memory_[at]), context);
  return context.result();
}

void BootRom::run(Trap trap, Context& c) {
  const auto unary = [&](std::uint32_t value, std::uint32_t cycles) {
    c.set(0, value);
    c.spend(cycles - 2);  // the BX LR that follows takes the other two
    c.leave();
  };
  const std::uint32_t r0 = c.reg(0);
  switch (trap) {
    case Trap::lookup:
      lookup(c);
      return;
    case Trap::popcount:
      unary(static_cast<std::uint32_t>(std::popcount(r0)), timing_.popcount);
      return;
    case Trap::reverse: {
      std::uint32_t value = 0;
      for (unsigned bit = 0; bit < 32; ++bit) value |= ((r0 >> bit) & 1u) << (31 - bit);
      unary(value, timing_.reverse);
      return;
    }
    case Trap::leading_zeros:
      unary(static_cast<std::uint32_t>(std::countl_zero(r0)), timing_.leading_zeros);
      return;
    case Trap::trailing_zeros:
      unary(static_cast<std::uint32_t>(std::countr_zero(r0)), timing_.trailing_zeros);
      return;
    case Trap::memset_start:
      fill_start(c, false);
      return;
    case Trap::memcpy_start:
      fill_start(c, true);
      return;
    case Trap::memset_block:
      fill_block(c, false, false);
      return;
    case Trap::memset4_block:
      fill_block(c, false, true);
      return;
    case Trap::memcpy_block:
      fill_block(c, true, false);
      return;
    case Trap::memcpy44_block:
      fill_block(c, true, true);
      return;
    case Trap::connect:
    case Trap::connect_wait:
      connect_flash(c);
      return;
    case Trap::exit_xip_start:
      exit_xip_start(c);
      return;
    case Trap::exit_xip:
      exit_xip(c);
      return;
    case Trap::erase_start:
      c.set(1, r0 + c.reg(1));  // r1 = end
      c.set(7, 0);              // no data
      c.set(4, next);
      c.leave();
      return;
    case Trap::program_start: {
      const std::uint32_t source = c.reg(1);
      c.set(1, r0 + c.reg(2));
      c.set(7, source);
      c.set(2, 0);
      c.set(3, page_program);
      c.set(4, next);
      c.leave();
      return;
    }
    case Trap::flash_write:
      flash_write(c);
      return;
    case Trap::flush:
      flush_cache(c);
      return;
    case Trap::enter_xip:
      enter_command_xip(c);
      return;
    case Trap::reset_usb:
      usb_boot(c);
      return;
    case Trap::usb_boot:
      state_ = RomState::bootsel;
      if (not_modelled_) not_modelled_("ROM USB boot loader: the chip stays in it");
      c.leave();
      return;
    case Trap::boot_start:
      boot_start(c);
      return;
    case Trap::boot_main: {
      // Blocks the ROM starts afresh, and a majority of nine looks at the BOOTSEL button.
      c.store(resets + set_alias, reset_io_qspi | reset_pads_qspi | reset_timer);
      c.store(resets + clear_alias, reset_io_qspi | reset_pads_qspi | reset_timer);
      c.spend(1200 + 9 * 15);
      if ((pins_.inputs() >> QspiPins::ss & 1u) != 0)
        c.leave();
      else
        c.set(pc, usb_boot_);
      return;
    }
    case Trap::boot_attempt:
      boot_attempt(c);
      return;
    case Trap::boot_read:
      boot_read(c);
      return;
    case Trap::boot_check:
      boot_check(c);
      return;
    case Trap::boot_enter:
      state_ = RomState::running;
      c.set(0, boot2_address + 1);
      c.set(lr, 0);  // boot2 is to find the way by itself
      c.set(pc, boot2_address);
      c.spend(5);
      return;
    case Trap::wait_start:
      c.store(scs_scr, 4);  // SLEEPDEEP
      c.set(4, drain);
      c.leave();
      return;
    case Trap::wait:
      wait_for_vector(c);
      return;
    case Trap::bad:
      return;
  }
}

// --- tables ---

namespace {
std::uint32_t half_at(std::span<const std::uint8_t> memory, std::uint32_t at) {
  return memory[at] | static_cast<std::uint32_t>(memory[at + 1]) << 8;
}
std::uint32_t find(std::span<const std::uint8_t> memory, std::uint32_t table, char first,
                   char second) {
  const std::uint32_t code = static_cast<std::uint8_t>(first) |
                             static_cast<std::uint32_t>(static_cast<std::uint8_t>(second)) << 8;
  for (; half_at(memory, table) != 0; table += 4)
    if (half_at(memory, table) == code) return half_at(memory, table + 2);
  return 0;
}
}  // namespace

std::uint32_t BootRom::function(char first, char second) const {
  return find(memory_, function_table_, first, second);
}
std::uint32_t BootRom::datum(char first, char second) const {
  return find(memory_, data_table_, first, second);
}

void BootRom::lookup(Context& c) {
  constexpr unsigned longest = 256;  // a table without an end is no table
  std::uint32_t table = c.reg(0);
  const std::uint32_t code = c.reg(1);
  std::uint32_t value = 0;
  for (unsigned i = 0; i < longest; ++i, table += 4) {
    const std::uint32_t entry = (table & 1u) != 0 ? 0 : c.load(table, Width::half);
    if (entry == 0) break;
    c.spend(timing_.lookup_entry - 4);
    const std::uint32_t address = c.load(table + 2, Width::half);
    if (entry == code) {
      value = address;
      break;
    }
  }
  if (value == 0 && not_modelled_) {
    std::string letters;
    for (const std::uint32_t letter : {code & 0xffu, code >> 8 & 0xffu})
      letters += letter >= 0x20 && letter < 0x7f ? static_cast<char>(letter) : '?';
    not_modelled_("ROM function or data '" + letters + "'");
  }
  c.set(0, value);
  c.spend(4);
  c.leave();
}

// --- memory ---

void BootRom::fill_start(Context& c, bool copy) {
  c.set(12, c.reg(0));  // r0 is returned; r12 moves
  if (!copy) c.set(1, (c.reg(1) & 0xffu) * 0x0101'0101u);
  c.spend(timing_.copy_start);
  c.leave();
}

void BootRom::fill_block(Context& c, bool copy, bool words) {
  const std::uint32_t left = c.reg(2);
  if (left == 0) {
    c.leave();
    return;
  }
  const std::uint32_t to = c.reg(12);
  const std::uint32_t from = c.reg(1);
  const bool aligned = words || (to % 4 == 0 && (!copy || from % 4 == 0));
  const std::uint32_t bytes = std::min(left, aligned && left >= 16 ? 16u : 4u);
  const std::uint32_t before = c.result().cycles;
  const bool by_words = aligned && bytes % 4 == 0;
  for (std::uint32_t i = 0; i < bytes; i += by_words ? 4 : 1) {
    const Width width = by_words ? Width::word : Width::byte;
    const std::uint32_t value = copy ? c.load(from + i, width) : from;
    c.store(to + i, value, width);
  }
  // The accesses have cost what single ones do; the real function moves four words at a time.
  const std::uint32_t cost = bytes == 16 ? timing_.copy_block : bytes * timing_.copy_byte;
  const std::uint32_t spent = c.result().cycles - before;
  if (spent < cost) c.spend(cost - spent);
  c.set(12, to + bytes);
  if (copy) c.set(1, from + bytes);
  c.set(2, left - bytes);
}

// --- flash ---

void BootRom::connect_flash(Context& c) {
  constexpr std::uint32_t blocks = reset_io_qspi | reset_pads_qspi;
  const bool first = static_cast<Trap>(memory_[c.reg(pc)]) == Trap::connect;
  if (first) {
    c.store(resets + set_alias, blocks);
    c.store(resets + clear_alias, blocks);
    c.spend(8);
    c.leave();
    return;
  }
  c.spend(6);
  if ((c.load(resets + reset_done) & blocks) != blocks) return;
  for (std::uint32_t pin = 0; pin < 6; ++pin) c.store(io_qspi + 8 * pin + 4, 0);
  c.leave();
}

bool BootRom::put_get(Context& c, Send send, std::uint32_t skip, bool keep, std::uint32_t& last) {
  std::uint32_t to_send = c.reg(5), to_take = c.reg(6);
  const std::uint32_t flying = c.load(ssi_tx_level);
  const std::uint32_t arrived = c.load(ssi_rx_level);
  c.spend(timing_.flash_step);
  if (to_send != 0 && flying + arrived < in_flight) {
    std::uint32_t byte = send == Send::ones ? 0xffu : 0u;
    if (send == Send::memory) {
      byte = c.load(c.reg(7), Width::byte);
      c.set(7, c.reg(7) + 1);
    }
    c.store(ssi_data, byte);
    c.set(5, --to_send);
  }
  if (arrived != 0 && to_take != 0) {
    last = c.load(ssi_data) & 0xffu;
    c.set(6, --to_take);
    // The first `skip` bytes answer the command; r12 counts them.
    if (c.reg(12) < skip)
      c.set(12, c.reg(12) + 1);
    else if (keep) {
      c.store(c.reg(7), last, Width::byte);
      c.set(7, c.reg(7) + 1);
    }
  }
  if (to_send != 0 || to_take != 0) return false;
  c.store(qspi_select_control, force_high);
  return true;
}

void BootRom::exit_xip_start(Context& c) {
  c.store(ssi_enable, 0);
  c.load(ssi_status);
  c.load(ssi_icr);
  c.store(ssi_baud, boot_divider);
  c.store(ssi_ctrlr0, bytes_both_ways);
  c.store(ssi_ser, 1);
  c.store(ssi_enable, 1);
  const std::uint32_t pad = c.load(pads_sd0);
  c.set(7, pad);
  c.store(qspi_select_control, force_high);
  // Data lines cut off and pulled low, later high (2.8.1.2).
  for (std::uint32_t i = 0; i < 4; ++i) c.store(pads_sd0 + 4 * i, (pad & ~0x8cu) | 0x84u);
  c.set(4, delay_low);
  c.set(5, exit_delay_steps);
  c.leave();
}

void BootRom::exit_xip(Context& c) {
  const std::uint32_t phase = c.reg(4), pad = c.reg(7);
  const auto pads = [&](std::uint32_t value) {
    for (std::uint32_t i = 0; i < 4; ++i) c.store(pads_sd0 + 4 * i, value);
  };
  const auto begin = [&](std::uint32_t new_phase, std::uint32_t count) {
    c.set(4, new_phase);
    c.set(5, count);
    c.set(6, count);
    c.set(12, 0);
  };
  std::uint32_t last = 0;
  switch (phase) {
    case delay_low:
    case delay_high:
      c.spend(exit_delay_cycles);
      c.set(5, c.reg(5) - 1);
      if (c.reg(5) == 0) begin(phase + 1, 4);
      return;
    case clocks_low:
      if (!put_get(c, Send::zeros, 0, false, last)) return;
      c.store(qspi_select_control, force_low);
      pads((pad & ~0x8cu) | 0x88u);
      begin(delay_high, exit_delay_steps);
      return;
    case clocks_high:
      if (!put_get(c, Send::zeros, 0, false, last)) return;
      pads(pad);
      c.store(qspi_select_control, force_low);
      begin(ones, 2);
      return;
    default:
      if (!put_get(c, Send::ones, 0, false, last)) return;
      c.store(qspi_select_control, force_none);
      c.leave();
      return;
  }
}

void BootRom::next_write(Context& c) {
  const std::uint32_t at = c.reg(0), end = c.reg(1);
  if (at >= end) {
    c.leave();
    return;
  }
  c.set(4, enable);
  c.spend(8);
}

void BootRom::flash_write(Context& c) {
  // r0 = address, r1 = end, r2 = block size, r3 = block command, r7 = data or 0.
  const bool programs = c.reg(7) != 0;
  const std::uint32_t at = c.reg(0), block = c.reg(2);
  const bool whole_block = !programs && (at & (block - 1)) == 0 && c.reg(1) - at >= block;
  const std::uint32_t step = programs ? 256 : whole_block ? block : 4096;
  std::uint32_t last = 0;
  switch (c.reg(4)) {
    case next:
      next_write(c);
      return;
    case enable:
      c.store(qspi_select_control, force_low);
      c.store(ssi_data, write_enable);
      c.set(5, 0);
      c.set(6, 1);
      c.set(12, 0);
      c.set(4, enable_wait);
      return;
    case enable_wait:
      if (put_get(c, Send::zeros, 1, false, last)) c.set(4, command);
      return;
    case command: {
      const std::uint32_t code = programs      ? page_program
                                 : whole_block ? c.reg(3) & 0xffu
                                               : sector_erase;
      const std::uint32_t word = at | code << 24;
      c.store(qspi_select_control, force_low);
      for (int shift = 24; shift >= 0; shift -= 8) c.store(ssi_data, word >> shift & 0xffu);
      c.set(5, programs ? 256 : 0);
      c.set(6, programs ? 260 : 4);
      c.set(12, 0);
      c.set(4, data);
      return;
    }
    case data:
      if (put_get(c, programs ? Send::memory : Send::zeros, 4, false, last)) c.set(4, poll);
      return;
    case poll:
      c.store(qspi_select_control, force_low);
      c.store(ssi_data, read_status);
      c.set(5, 1);
      c.set(6, 2);
      c.set(12, 0);
      c.set(4, poll_wait);
      return;
    default:
      if (!put_get(c, Send::zeros, 1, false, last)) return;
      if ((last & 1u) != 0) {
        c.set(4, poll);
        return;
      }
      c.set(0, at + step);
      c.set(4, next);
      return;
  }
}

void BootRom::flush_cache(Context& c) {
  c.store(xip_ctrl + 4, 1);
  c.load(xip_ctrl + 4);
  c.store(xip_ctrl + set_alias, 1);
  c.store(qspi_select_control, force_none);
  c.spend(12);
  c.leave();
}

void BootRom::enter_command_xip(Context& c) {
  c.store(ssi_enable, 0);
  c.store(ssi_ctrlr0, 31u << 16 | 3u << 8);                      // 32 bits, command out and data in
  c.store(ssi_spi_ctrlr0, read_data << 24 | 2u << 8 | 6u << 2);  // 8 bits of command, 24 of address
  c.store(ssi_ctrlr1, 0);
  c.store(ssi_enable, 1);
  c.spend(12);
  c.leave();
}

// --- start ---

void BootRom::usb_boot(Context& c) {
  // By way of the watchdog, so that everything is reset, and the boot vector (2.8.1.1).
  constexpr std::uint32_t control_enable = 1u << 30, control_pause = 7u << 24;
  constexpr std::uint32_t delay_us = 10'000;  // assumed
  c.store(scratch0, c.reg(0));
  c.store(scratch0 + 4, c.reg(1));
  c.store(psm_wdsel, 0x1'fffc);  // everything but ROSC and XOSC
  c.store(watchdog + clear_alias, control_enable | control_pause);
  const std::uint32_t entry = usb_boot_ | 1u;
  c.store(scratch4, boot_magic);
  c.store(scratch4 + 4, entry ^ (0u - boot_magic));
  c.store(scratch4 + 8, sram_end);
  c.store(scratch4 + 12, entry);
  c.store(watchdog + 4, delay_us);
  c.store(clocks + 0x30, 2);  // clk_ref from the crystal
  c.store(watchdog + 0x2c, 1u << 9 | 12);
  c.store(watchdog + set_alias, control_enable);
  c.spend(60);
  c.leave();
}

void BootRom::boot_start(Context& c) {
  if (c.core_id() != 0) {
    c.set(pc, wait_);
    c.spend(6);
    return;
  }
  state_ = RomState::booting;
  c.store(clocks + 0xa0, 0xffff'ffff);  // WAKE_EN0, WAKE_EN1
  c.store(clocks + 0xa4, 0xffff'ffff);
  // No NMI for either core. The real ROM stores even where SYSCFG is still held in reset: lost, and
  // not the image's doing, so that it is left out here.
  if ((c.load(resets) & reset_syscfg) == 0) {
    c.store(syscfg, 0);
    c.store(syscfg + 4, 0);
  }
  if ((c.load(chip_reset) & rescue_flag) != 0) {
    c.store(chip_reset, rescue_flag);
    state_ = RomState::rescue;
    c.set(pc, dead_);
    return;
  }
  std::array<std::uint32_t, 4> scratch{};
  for (std::uint32_t i = 0; i < 4; ++i) scratch[i] = c.load(scratch4 + 4 * i);
  c.spend(12);
  if (scratch[0] != boot_magic || (scratch[1] ^ scratch[3]) != 0u - boot_magic) {
    c.leave();
    return;
  }
  c.store(scratch4, 0);
  c.set(sp, scratch[2] & ~3u);
  c.set(lr, main_ | 1u);  // whoever returns gets the ordinary start
  c.set(pc, scratch[3] & ~1u);
  state_ = RomState::running;
}

void BootRom::boot_attempt(Context& c) {
  // Each attempt tries the next of the four clock polarities and phases.
  const std::uint32_t attempt = c.reg(8);
  c.store(ssi_enable, 0);
  c.store(ssi_ctrlr0, bytes_both_ways | (attempt & 3u) << 6);
  c.store(ssi_enable, 1);
  c.store(qspi_select_control, force_low);
  for (int shift = 24; shift >= 0; shift -= 8)
    c.store(ssi_data, (read_data << 24) >> shift & 0xffu);
  c.set(5, boot2_size);
  c.set(6, boot2_size + 4);
  c.set(12, 0);
  c.set(7, boot2_address);
  c.leave();
}

void BootRom::boot_read(Context& c) {
  std::uint32_t last = 0;
  if (put_get(c, Send::zeros, 4, true, last)) c.leave();
}

void BootRom::boot_check(Context& c) {
  std::array<std::uint8_t, boot2_size> boot2{};
  const std::uint32_t before = c.result().cycles;
  for (std::uint32_t i = 0; i < boot2_size; ++i)
    boot2[i] = static_cast<std::uint8_t>(c.load(boot2_address + i, Width::byte));
  const std::uint32_t spent = c.result().cycles - before;
  if (spent < timing_.boot2_checksum) c.spend(timing_.boot2_checksum - spent);
  std::uint32_t wanted = 0;
  for (std::uint32_t i = 4; i-- > 0;) wanted = wanted << 8 | boot2[boot2_size - 4 + i];
  if (boot2_crc32(std::span(boot2).first(boot2_size - 4)) == wanted) {
    c.leave();
    return;
  }
  const std::uint32_t attempt = c.reg(8) + 1;
  c.set(8, attempt);
  c.set(pc, attempt < flash_attempts ? attempt_ : usb_boot_);
}

void BootRom::wait_for_vector(Context& c) {
  // The words 0, 0, 1, VTOR, SP, entry come from core 0 and each is answered (2.8.2).
  constexpr std::uint32_t to_wfe = 0, to_sev = 2;
  const std::uint32_t status = c.load(fifo_status);
  const std::uint32_t phase = c.reg(4) & 0xffu;
  c.spend(6);
  const auto answer = [&](std::uint32_t word, std::uint32_t then) {
    c.set(5, word);
    c.set(4, send | then << 8);
  };
  switch (phase) {
    case drain:
      if ((status & fifo_valid) != 0)
        c.load(fifo_read);
      else
        answer(0, receive_1);
      return;
    case send:
      if ((status & fifo_ready) == 0) {
        c.leave(to_wfe);
        return;
      }
      c.store(fifo_write, c.reg(5));
      c.set(4, c.reg(4) >> 8);
      c.leave(to_sev);
      return;
    case launch:
      c.store(scs_scr, 0);
      c.set(lr, dead_ | 1u);
      c.set(pc, c.reg(5) & ~1u);
      return;
    default:
      break;
  }
  if ((status & fifo_valid) == 0) {
    c.leave(to_wfe);
    return;
  }
  const std::uint32_t word = c.load(fifo_read);
  if (word == 0 || (phase == receive_1 && word != 1)) {
    c.set(4, drain);
    return;
  }
  if (phase == receive_vtor) c.store(scs_vtor, word);
  if (phase == receive_sp) c.set(sp, word & ~3u);
  answer(word, phase + 1);
}

}  // namespace lamplock::sim::chip
