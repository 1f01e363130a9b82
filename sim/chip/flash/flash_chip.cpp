#include "sim/chip/flash/flash_chip.hpp"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// Instructions (W25Q16JV datasheet, 8.1.2 and 8.1.3).
enum Command : std::uint8_t {
  cmd_write_status_1 = 0x01,
  cmd_page_program = 0x02,
  cmd_read = 0x03,
  cmd_write_disable = 0x04,
  cmd_read_status_1 = 0x05,
  cmd_write_enable = 0x06,
  cmd_fast_read = 0x0b,
  cmd_write_status_3 = 0x11,
  cmd_read_status_3 = 0x15,
  cmd_sector_erase = 0x20,
  cmd_write_status_2 = 0x31,
  cmd_read_status_2 = 0x35,
  cmd_fast_read_dual_output = 0x3b,
  cmd_unique_id = 0x4b,
  cmd_block_erase_32k = 0x52,
  cmd_chip_erase_60 = 0x60,
  cmd_enable_reset = 0x66,
  cmd_fast_read_quad_output = 0x6b,
  cmd_manufacturer_id = 0x90,
  cmd_reset = 0x99,
  cmd_jedec_id = 0x9f,
  cmd_release_power_down = 0xab,
  cmd_power_down = 0xb9,
  cmd_fast_read_dual_io = 0xbb,
  cmd_chip_erase_c7 = 0xc7,
  cmd_block_erase_64k = 0xd8,
  cmd_fast_read_quad_io = 0xeb,
  cmd_nothing = 0xff,
};

constexpr std::uint8_t status_busy = 1;           // status 1, bit 0
constexpr std::uint8_t status_write_enabled = 2;  // status 1, bit 1
constexpr std::uint8_t status_protection = 0x1c;  // status 1: BP2..BP0
constexpr std::uint8_t status_quad_enable = 2;    // status 2, bit 1
constexpr std::uint8_t manufacturer = 0xef;       // Winbond
constexpr std::uint8_t memory_type = 0x40;        // W25Q..JV-IQ
constexpr unsigned idle_lines = 0xf;

std::string hex_byte(std::uint8_t value) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "%02Xh", value);
  return text.data();
}

}  // namespace

FlashChip::FlashChip(std::size_t size, FlashTiming timing, NotModelled not_modelled,
                     std::uint64_t seed)
    : timing_(timing), not_modelled_(std::move(not_modelled)), random_(seed) {
  if (!std::has_single_bit(size) || size < 64u * 1024 || size > 16u * 1024 * 1024)
    throw std::invalid_argument("flash chip: " + std::to_string(size) +
                                " bytes; take a power of two from 64 KiB to 16 MiB");
  storage_.assign(size, 0xff);
  for (std::uint8_t& byte : unique_id_) byte = static_cast<std::uint8_t>(random_());
}

void FlashChip::report(const std::string& what) const {
  if (not_modelled_) not_modelled_(what);
}

void FlashChip::set_quad_enable(bool on) {
  status_[1] = static_cast<std::uint8_t>(on ? status_[1] | status_quad_enable
                                            : status_[1] & ~status_quad_enable);
}

// --- the wires ---

void FlashChip::select(Picoseconds) {
  selected_ = true;
  const std::uint8_t continuous = protocol_.continuous;
  protocol_ = {};
  protocol_.continuous = continuous;
  if (continuous == 0)
    begin(Phase::command, 1);
  else
    read_command(continuous == cmd_fast_read_quad_io ? 4 : 2,
                 continuous == cmd_fast_read_quad_io ? 4 : 0,
                 continuous == cmd_fast_read_quad_io ? 4 : 2);
}

void FlashChip::deselect(Picoseconds now) {
  if (!selected_) return;
  selected_ = false;
  if (protocol_.bit_count == 0 && !probing_) finish_write(now);
  protocol_.phase = Phase::ignore;
  protocol_.bit_count = 0;
}

void FlashChip::begin(Phase phase, unsigned lanes) {
  protocol_.phase = phase;
  protocol_.lanes = static_cast<std::uint8_t>(lanes);
  protocol_.bits = 0;
  protocol_.bit_count = 0;
}

std::uint8_t FlashChip::transfer(std::uint8_t out, Picoseconds now) {
  unsigned in = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    const unsigned level = (static_cast<unsigned>(out) >> (7 - bit)) & 1u;
    in = in << 1 | ((clock(level | 0xeu, now) >> 1) & 1u);
  }
  return static_cast<std::uint8_t>(in);
}

unsigned FlashChip::clock(unsigned lines, Picoseconds now) {
  Protocol& p = protocol_;
  if (!selected_ && !probing_) return idle_lines;
  switch (p.phase) {
    case Phase::ignore:
    case Phase::done:
      // Clocks after a complete command invalidate it: chip select must rise after its last bit.
      if (p.phase == Phase::done) p.phase = Phase::ignore;
      return idle_lines;
    case Phase::dummy:
      if (--p.dummy_clocks == 0) begin(p.after_dummy, p.output_lanes);
      return idle_lines;
    case Phase::output: {
      if (p.bit_count == 0) {
        p.bits = output_byte(now);
        ++p.position;
      }
      const unsigned shift = 8u - p.bit_count - p.lanes;
      const unsigned value = (p.bits >> shift) & ((1u << p.lanes) - 1u);
      p.bit_count = static_cast<std::uint8_t>((p.bit_count + p.lanes) & 7u);
      if (p.lanes == 1) return value << 1 | 0xdu;
      return (p.lanes == 2 ? 0xcu : 0u) | value;
    }
    default:
      break;
  }
  p.bits = p.bits << p.lanes | (lines & ((1u << p.lanes) - 1u));
  p.bit_count = static_cast<std::uint8_t>(p.bit_count + p.lanes);
  if (p.phase == Phase::address) {
    if (p.bit_count == 24) after_address();
  } else if (p.bit_count == 8) {
    const auto byte = static_cast<std::uint8_t>(p.bits);
    p.bits = 0;
    p.bit_count = 0;
    if (p.phase == Phase::command)
      start_command(byte, now);
    else if (p.phase == Phase::mode) {
      p.mode = byte;
      after_mode();
    } else
      take_byte(byte);
  }
  return idle_lines;
}

void FlashChip::read_command(unsigned address_lanes, unsigned dummies, unsigned data_lanes) {
  protocol_.source = Source::memory;
  protocol_.output_lanes = static_cast<std::uint8_t>(data_lanes);
  protocol_.dummy_clocks = dummies;
  protocol_.after_dummy = Phase::output;
  begin(Phase::address, address_lanes);
}

void FlashChip::after_address() {
  Protocol& p = protocol_;
  p.address = p.bits & 0xff'ffffu;
  switch (p.command) {
    case cmd_page_program:
      page_loaded_.fill(false);
      page_bytes_ = 0;
      begin(Phase::input, 1);
      return;
    case cmd_sector_erase:
    case cmd_block_erase_32k:
    case cmd_block_erase_64k:
      begin(Phase::done, 1);
      return;
    default:
      break;
  }
  if (p.lanes != 1)
    begin(Phase::mode, p.lanes);
  else if (p.dummy_clocks != 0)
    begin(Phase::dummy, 1);
  else
    begin(Phase::output, p.output_lanes);
}

void FlashChip::after_mode() {
  Protocol& p = protocol_;
  // Continuous read while M5-4 = 10 (8.2.9, 8.2.10).
  const std::uint8_t read = p.lanes == 4 ? cmd_fast_read_quad_io : cmd_fast_read_dual_io;
  p.continuous = (p.mode & 0x30u) == 0x20u ? read : 0;
  if (p.dummy_clocks != 0)
    begin(Phase::dummy, p.lanes);
  else
    begin(Phase::output, p.output_lanes);
}

void FlashChip::take_byte(std::uint8_t byte) {
  const std::uint32_t at = protocol_.command == cmd_page_program
                               ? (protocol_.address + page_bytes_) % page_size
                               : page_bytes_ % page_size;
  page_[at] = byte;
  page_loaded_[at] = true;
  ++page_bytes_;
}

std::uint8_t FlashChip::memory_byte(std::uint32_t address) const {
  if (probing_) return pattern_byte(address & 0xff'ffffu);
  return storage_[address & (storage_.size() - 1)];
}

std::uint8_t FlashChip::pattern_byte(std::uint32_t address) {
  return static_cast<std::uint8_t>((address * 0x9e37'79b1u) >> 21);
}

std::uint64_t FlashChip::pattern_word(std::uint32_t address) {
  std::uint64_t word = 0;
  for (std::uint32_t i = 0; i < 8; ++i) word = word << 8 | pattern_byte(address + i);
  return word;
}

std::uint8_t FlashChip::output_byte(Picoseconds now) {
  const std::uint32_t position = protocol_.position;
  const auto capacity = static_cast<std::uint8_t>(std::countr_zero(storage_.size()));
  switch (protocol_.source) {
    case Source::memory:
      return memory_byte(protocol_.address + position);
    case Source::status1:
      return static_cast<std::uint8_t>((status_[0] & 0xfcu) | (busy(now) ? status_busy : 0u) |
                                       (write_enabled_ ? status_write_enabled : 0u));
    case Source::status2:
      return status_[1];
    case Source::status3:
      return status_[2];
    case Source::jedec:
      return std::array<std::uint8_t, 3>{manufacturer, memory_type, capacity}[position % 3];
    case Source::unique:
      return unique_id_[position % unique_id_.size()];
    case Source::device:
      return static_cast<std::uint8_t>(capacity - 1);
    case Source::ids:
      return (protocol_.address + position) % 2 == 0 ? manufacturer
                                                     : static_cast<std::uint8_t>(capacity - 1);
  }
  return 0xff;
}

bool FlashChip::start_read(std::uint8_t command) {
  const bool quad = (status_[1] & status_quad_enable) != 0;
  switch (command) {
    case cmd_read:
      read_command(1, 0, 1);
      return true;
    case cmd_fast_read:
      read_command(1, 8, 1);
      return true;
    case cmd_fast_read_dual_output:
      read_command(1, 8, 2);
      return true;
    case cmd_fast_read_dual_io:
      read_command(2, 0, 2);
      return true;
    case cmd_fast_read_quad_output:
      if (quad)
        read_command(1, 8, 4);
      else
        protocol_.phase = Phase::ignore;
      return true;
    case cmd_fast_read_quad_io:
      if (quad)
        read_command(4, 4, 4);
      else
        protocol_.phase = Phase::ignore;
      return true;
    case cmd_manufacturer_id:
      read_command(1, 0, 1);
      protocol_.source = Source::ids;
      return true;
    default:
      return false;
  }
}

bool FlashChip::start_answer(std::uint8_t command) {
  const auto output = [&](Source source, unsigned dummies) {
    Protocol& p = protocol_;
    p.source = source;
    p.output_lanes = 1;
    p.after_dummy = Phase::output;
    p.dummy_clocks = dummies;
    begin(dummies != 0 ? Phase::dummy : Phase::output, 1);
    return true;
  };
  switch (command) {
    case cmd_read_status_1:
      return output(Source::status1, 0);
    case cmd_read_status_2:
      return output(Source::status2, 0);
    case cmd_read_status_3:
      return output(Source::status3, 0);
    case cmd_jedec_id:
      return output(Source::jedec, 0);
    case cmd_unique_id:
      return output(Source::unique, 32);
    case cmd_release_power_down:
      return output(Source::device, 24);
    default:
      return false;
  }
}

void FlashChip::start_command(std::uint8_t command, Picoseconds now) {
  Protocol& p = protocol_;
  p.command = command;
  p.position = 0;
  if (command != cmd_reset && command != cmd_enable_reset) reset_enabled_ = false;
  const bool while_busy = command == cmd_read_status_1 || command == cmd_read_status_2 ||
                          command == cmd_read_status_3 || command == cmd_enable_reset;
  if ((busy(now) && !while_busy) || (power_down_ && command != cmd_release_power_down)) {
    if (command == cmd_reset && reset_enabled_)
      report("FLASH reset (99h) while busy: the operation continues here");
    p.phase = Phase::ignore;
    ++counts_.ignored;
    return;
  }
  if (start_read(command) || start_answer(command)) return;
  switch (command) {
    case cmd_page_program:
    case cmd_sector_erase:
    case cmd_block_erase_32k:
    case cmd_block_erase_64k:
      begin(Phase::address, 1);
      return;
    case cmd_write_status_1:
    case cmd_write_status_2:
    case cmd_write_status_3:
      page_bytes_ = 0;
      begin(Phase::input, 1);
      return;
    case cmd_write_enable:
    case cmd_write_disable:
    case cmd_chip_erase_60:
    case cmd_chip_erase_c7:
    case cmd_power_down:
    case cmd_enable_reset:
    case cmd_reset:
      begin(Phase::done, 1);
      return;
    case cmd_nothing:
      p.phase = Phase::ignore;
      return;
    default:
      p.phase = Phase::ignore;
      report("FLASH command " + hex_byte(command));
      return;
  }
}

// --- operations that the rise of chip select starts ---

bool FlashChip::protected_now() {
  if ((status_[0] & status_protection) == 0) return false;
  report("FLASH block protection: taken as protecting everything");
  return true;
}

bool FlashChip::write_permitted(Picoseconds now) {
  if (write_enabled_ && !busy(now)) return true;
  ++counts_.ignored;
  return false;
}

void FlashChip::finish_write(Picoseconds now) {
  const Protocol& p = protocol_;
  const std::uint8_t command = p.command;
  if (command == cmd_release_power_down && power_down_ && p.phase != Phase::ignore) {
    power_down_ = false;
    start_work(Work::none, 0, 0, timing_.release_power_down, now);
    return;
  }
  if (p.phase == Phase::input && page_bytes_ != 0) {
    if (!write_permitted(now)) return;
    if (command == cmd_page_program)
      program(now);
    else
      write_status(now);
    return;
  }
  if (p.phase != Phase::done) return;
  const std::size_t at = p.address & (storage_.size() - 1);
  switch (command) {
    case cmd_write_enable:
      write_enabled_ = true;
      return;
    case cmd_write_disable:
      write_enabled_ = false;
      return;
    case cmd_power_down:
      power_down_ = true;
      return;
    case cmd_enable_reset:
      reset_enabled_ = true;
      return;
    case cmd_reset:
      if (!reset_enabled_) return;
      reset_enabled_ = false;
      write_enabled_ = false;
      start_work(Work::none, 0, 0, timing_.reset, now);
      return;
    default:
      break;
  }
  if (!write_permitted(now)) return;
  switch (command) {
    case cmd_sector_erase:
      erase(at & ~(sector_size - 1), sector_size, timing_.sector_erase, now);
      return;
    case cmd_block_erase_32k:
      erase(at & ~std::size_t{0x7fff}, 0x8000, timing_.block_erase_32k, now);
      return;
    case cmd_block_erase_64k:
      erase(at & ~std::size_t{0xffff}, 0x1'0000, timing_.block_erase_64k, now);
      return;
    default:
      erase(0, storage_.size(), timing_.chip_erase, now);
      return;
  }
}

void FlashChip::start_work(Work work, std::size_t from, std::size_t size, Picoseconds duration,
                           Picoseconds now) {
  work_ = work;
  work_from_ = from;
  before_.assign(storage_.begin() + static_cast<std::ptrdiff_t>(from),
                 storage_.begin() + static_cast<std::ptrdiff_t>(from + size));
  status_before_ = status_;
  busy_since_ = now;
  busy_until_ = now + duration;
  if (work != Work::none) write_enabled_ = false;
}

void FlashChip::program(Picoseconds now) {
  if (protected_now()) return;
  const std::size_t page = protocol_.address & (storage_.size() - 1) & ~(page_size - 1);
  start_work(Work::program, page, page_size, timing_.page_program, now);
  for (std::size_t i = 0; i < page_size; ++i)
    if (page_loaded_[i]) storage_[page + i] &= page_[i];
  ++counts_.pages_programmed;
}

void FlashChip::erase(std::size_t from, std::size_t size, Picoseconds duration, Picoseconds now) {
  if (protected_now()) return;
  start_work(Work::erase, from, size, duration, now);
  std::fill_n(storage_.begin() + static_cast<std::ptrdiff_t>(from), size, std::uint8_t{0xff});
  counts_.sectors_erased += size / sector_size;
}

void FlashChip::write_status(Picoseconds now) {
  start_work(Work::status, 0, 0, timing_.write_status, now);
  switch (protocol_.command) {
    case cmd_write_status_1:
      status_[0] = page_[0] & 0xfcu;
      if (page_bytes_ > 1) status_[1] = page_[1] & 0x7fu;
      break;
    case cmd_write_status_2:
      status_[1] = page_[0] & 0x7fu;
      break;
    default:
      status_[2] = page_[0];
      break;
  }
}

// --- power ---

void FlashChip::power_cut(Picoseconds now) {
  if (work_ != Work::none && now < busy_until_) {
    const double done =
        static_cast<double>(now - busy_since_) / static_cast<double>(busy_until_ - busy_since_);
    if (work_ == Work::program) cut_program(done);
    if (work_ == Work::erase) cut_erase(done);
    if (work_ == Work::status && random_() % 2 == 0) status_ = status_before_;
  }
  work_ = Work::none;
  busy_until_ = now;
  selected_ = false;
  write_enabled_ = false;
  power_down_ = false;
  reset_enabled_ = false;
  protocol_ = {};
}

void FlashChip::cut_program(double done) {
  // Either the bytes were done one after the other, or all bits at once and some were faster.
  const bool in_order = random_() % 2 == 0;
  const auto prefix = static_cast<std::size_t>(done * static_cast<double>(before_.size()));
  std::bernoulli_distribution bit_done(std::clamp(done, 0.0, 1.0));
  for (std::size_t i = 0; i < before_.size(); ++i) {
    if (in_order && i < prefix) continue;
    std::uint8_t& byte = storage_[work_from_ + i];
    if (in_order && i > prefix) {
      byte = before_[i];
      continue;
    }
    unsigned undone = 0;
    for (unsigned bit = 0; bit < 8; ++bit)
      if (!bit_done(random_)) undone |= 1u << bit;
    byte = static_cast<std::uint8_t>(byte | (before_[i] & undone));
  }
}

void FlashChip::cut_erase(double done) {
  // An erase clears all bits before it sets them, so that a cut may leave anything: the old bits
  // partly cleared, noise, or nearly everything set.
  const double set = std::clamp(done * 1.5 - 0.4, 0.0, 1.0);
  const double cleared = std::clamp(done * 4.0, 0.0, 1.0);
  const bool noise = random_() % 3 == 0;
  std::bernoulli_distribution bit_set(set);
  std::bernoulli_distribution bit_cleared(cleared);
  for (std::size_t i = 0; i < before_.size(); ++i) {
    std::uint8_t& byte = storage_[work_from_ + i];
    if (noise) {
      byte = static_cast<std::uint8_t>(random_());
      continue;
    }
    unsigned value = before_[i];
    for (unsigned bit = 0; bit < 8; ++bit) {
      if (bit_cleared(random_)) value &= ~(1u << bit);
      if (bit_set(random_)) value |= 1u << bit;
    }
    byte = static_cast<std::uint8_t>(value);
  }
}

}  // namespace lamplock::sim::chip
