// The image of the ROM: vectors, tables, and Thumb frames around the traps.
#include "sim/chip/rom/rom_context.hpp"

#include <array>
#include <vector>

namespace lamplock::sim::chip {

/// Key and address of a function or datum in the tables.
struct BootRom::Entry {
  char first, second;
  std::uint32_t address;
};

/// Writes Thumb code and tables.
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
  void align(std::uint32_t boundary) {
    while (at_ % boundary != 0) half(0);
  }
  void letters(char first, char second) {
    half(static_cast<std::uint8_t>(first) |
         static_cast<std::uint32_t>(static_cast<std::uint8_t>(second)) << 8);
  }
  /// A function of one or more traps, then BX LR.
  std::uint32_t leaf(std::initializer_list<Trap> traps) {
    const std::uint32_t at = at_;
    for (const Trap number : traps) trap(number);
    half(bx_lr);
    return at;
  }
  /// A function that keeps its state in r4..r7.
  std::uint32_t framed(std::initializer_list<Trap> traps) {
    const std::uint32_t at = half(push);
    for (const Trap number : traps) trap(number);
    half(pop);
    return at;
  }
  /// Codes and addresses, in the form that lookup() reads.
  std::uint32_t table(const std::vector<Entry>& entries) {
    const std::uint32_t at = at_;
    for (const Entry& entry : entries) {
      letters(entry.first, entry.second);
      half(entry.address);
    }
    half(0);
    return at;
  }
  static constexpr std::uint32_t bx_lr = 0x4770, push = 0xb5f0, pop = 0xbdf0, wfe = 0xbf20,
                                 wfi = 0xbf30, sev = 0xbf40, cpsid = 0xb672, cpsie = 0xb662,
                                 breakpoint = 0xbe00, blx_r7 = 0x47b8, blx_r9 = 0x47c8,
                                 compare_r0_0 = 0x2800, str_r1_at_r0 = 0x6001;

 private:
  std::span<std::uint8_t> memory_;
  std::uint32_t at_;
};

/// Functions that several parts call.
struct BootRom::Shared {
  std::uint32_t lookup, connect, exit_xip, flush;
};

void BootRom::build() {
  // No other code may run: UDF everywhere.
  for (std::size_t i = 0; i < memory_.size(); i += 2) {
    memory_[i] = static_cast<std::uint8_t>(Trap::bad);
    memory_[i + 1] = 0xde;
  }
  Assembler code(memory_, 0x100);
  std::vector<Entry> functions;
  const Shared shared = build_functions(code, functions);
  build_wait(code, functions);
  build_loader(code, shared);
  const std::uint32_t start = build_start(code, shared);
  const std::vector<Entry> data = build_data(code);
  function_table_ = code.table(functions);
  data_table_ = code.table(data);

  // Vectors and the words at fixed places (2.8.3).
  Assembler vectors(memory_, 0);
  vectors.word(boot2_address);
  vectors.word(start | 1u);
  vectors.word(dead_ | 1u);
  vectors.word(dead_ | 1u);
  vectors.half('M' | 'u' << 8);
  vectors.half(0x01 | version_ << 8);
  vectors.half(function_table_);
  vectors.half(data_table_);
  vectors.half(shared.lookup | 1u);
}

BootRom::Shared BootRom::build_functions(Assembler& code, std::vector<Entry>& table) {
  using A = Assembler;
  const auto listed = [&](const char* letters, std::uint32_t address) {
    table.push_back({letters[0], letters[1], address | 1u});
    return address;
  };
  Shared shared{};
  shared.lookup = code.leaf({Trap::lookup});
  listed("P3", code.leaf({Trap::popcount}));
  listed("R3", code.leaf({Trap::reverse}));
  listed("L3", code.leaf({Trap::leading_zeros}));
  listed("T3", code.leaf({Trap::trailing_zeros}));
  listed("MS", code.leaf({Trap::memset_start, Trap::memset_block}));
  listed("S4", code.leaf({Trap::memset_start, Trap::memset4_block}));
  listed("MC", code.leaf({Trap::memcpy_start, Trap::memcpy_block}));
  listed("C4", code.leaf({Trap::memcpy_start, Trap::memcpy44_block}));
  shared.connect = listed("IF", code.leaf({Trap::connect, Trap::connect_wait}));
  shared.exit_xip = listed("EX", code.framed({Trap::exit_xip_start, Trap::exit_xip}));
  listed("RE", code.framed({Trap::erase_start, Trap::flash_write}));
  listed("RP", code.framed({Trap::program_start, Trap::flash_write}));
  shared.flush = listed("FC", code.leaf({Trap::flush}));
  listed("CX", code.leaf({Trap::enter_xip}));
  listed("UB", code.here());
  code.trap(Trap::reset_usb);
  dead_ = code.half(A::wfi);
  code.branch(dead_);
  // For debuggers: calls the function at r7 and stops (2.8.3.1.4).
  listed("DT", code.half(A::blx_r7));
  listed("DE", code.half(A::breakpoint));
  return shared;
}

void BootRom::build_wait(Assembler& code, std::vector<Entry>& table) {
  using A = Assembler;
  wait_ = code.trap(Trap::wait_start);
  table.push_back({'W', 'V', wait_ | 1u});
  const std::uint32_t wait = code.trap(Trap::wait);
  code.half(A::wfe);
  code.branch(wait);
  code.half(A::sev);
  code.branch(wait);
}

std::uint32_t BootRom::build_start(Assembler& code, const Shared& shared) {
  const std::uint32_t start = code.trap(Trap::boot_start);
  main_ = code.trap(Trap::boot_main);
  code.call(shared.connect);
  code.call(shared.exit_xip);
  code.half(0x2000);  // MOVS r0, #0
  code.half(0x4680);  // MOV r8, r0: attempts
  attempt_ = code.trap(Trap::boot_attempt);
  code.trap(Trap::boot_read);
  code.trap(Trap::boot_check);
  code.call(shared.flush);
  code.trap(Trap::boot_enter);
  return start;
}

std::vector<BootRom::Entry> BootRom::build_data(Assembler& code) {
  const std::uint32_t float_table = build_float(code, soft_float::Precision::float32);
  const std::uint32_t double_table =
      version_ == 1 ? 0 : build_float(code, soft_float::Precision::float64);
  code.align(4);
  const std::uint32_t revision = code.here();
  code.word(0x1a30'0001);  // of this model, not of a real ROM
  const std::uint32_t copyright = code.here();
  constexpr char text[] = "lamplock model of the RP2040 boot ROM";
  static_assert(sizeof text % 2 == 0);
  for (std::size_t i = 0; i < sizeof text; i += 2) code.letters(text[i], text[i + 1]);
  std::vector<Entry> data = {{'G', 'R', revision}, {'C', 'R', copyright}, {'S', 'F', float_table}};
  if (double_table != 0) data.push_back({'S', 'D', double_table});
  return data;
}

std::uint32_t BootRom::build_float(Assembler& code, soft_float::Precision precision) {
  using A = Assembler;
  using soft_float::Function;
  const unsigned count = version_ == 1 ? soft_float::version1_functions : soft_float::functions;
  std::vector<std::uint32_t> entries;
  for (unsigned i = 0; i < count; ++i) {
    const auto function = static_cast<Function>(i);
    if (function == Function::sine_cosine && version_ < 3) {
      entries.push_back(fault_address | 1u);
      continue;
    }
    code.half(i | static_cast<std::uint32_t>(precision) << 8);
    entries.push_back(code.trap(Trap::float_start) | 1u);
    code.trap(Trap::float_wait);
    code.trap(Trap::float_finish);
    if (function == Function::compare_fast_flags) code.half(A::compare_r0_0);
    code.half(A::bx_lr);
  }
  // The byte two before the table is its size in words: pico-sdk reads it.
  code.align(4);
  code.half(0);
  code.half(count);
  const std::uint32_t table = code.here();
  for (const std::uint32_t entry : entries) code.word(entry);
  return table;
}

void BootRom::build_loader(Assembler& code, const Shared& shared) {
  using A = Assembler;
  loader_functions_ = {
      code.framed({Trap::flush, Trap::enter_xip, Trap::give_zero}),
      code.framed({Trap::exit_xip_start, Trap::exit_xip, Trap::give_zero}),
      code.framed({Trap::sector_arguments, Trap::erase_start, Trap::flash_write, Trap::give_zero}),
      code.framed({Trap::range_arguments, Trap::erase_start, Trap::flash_write, Trap::give_zero}),
      code.framed({Trap::page_arguments, Trap::program_start, Trap::flash_write, Trap::give_zero}),
      code.framed({Trap::page_read_start, Trap::page_read, Trap::give_zero}),
  };
  for (std::uint32_t& function : loader_functions_) function |= 1u;
  loader_.set_functions(loader_functions_);

  const std::uint32_t handler = code.trap(Trap::loader_interrupt);
  code.half(A::bx_lr);
  constexpr std::uint32_t vector_alignment = 256, vector_count = 48, usb_vector = 16 + 5;
  code.align(vector_alignment);
  loader_vectors_ = code.here();
  for (std::uint32_t i = 0; i < vector_count; ++i)
    code.word((i == usb_vector ? handler : dead_) | 1u);

  usb_reset_ = code.trap(Trap::loader_scratch);
  usb_boot_ = code.trap(Trap::usb_boot);
  code.trap(Trap::loader_crystal);
  code.trap(Trap::loader_pll);
  code.trap(Trap::loader_blocks);
  code.call(shared.connect);
  code.call(shared.exit_xip);
  code.trap(Trap::loader_ready);
  code.half(A::str_r1_at_r0);
  const std::uint32_t loop = code.half(A::cpsid);
  code.trap(Trap::loader_task);
  code.half(A::wfi);
  code.half(A::cpsie);
  code.branch(loop);
  code.half(A::cpsie);
  code.half(A::blx_r9);
  code.trap(Trap::loader_done);
  code.branch(loop);
}

}  // namespace lamplock::sim::chip
