// Start of the image in SRAM: vector table and initialisation before main().
#include <cstdint>

#include "firmware/boards/rp2040/base/interrupts.hpp"
#include "firmware/boards/rp2040/base/stack.hpp"
#include "firmware/boards/rp2040/fault.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"

extern "C" {
extern std::uint32_t bss_begin[];
extern std::uint32_t bss_end[];
extern std::uint32_t rings_begin[];
extern std::uint32_t rings_end[];

int main();
[[noreturn]] void start_image();
}

namespace lamplock::rp2040 {
namespace {

using Handler = void (*)();

/// ARMv6-M: initial stack pointer, 15 exceptions, 32 interrupts.
struct VectorTable {
  void* stack;
  Handler reset;
  Handler nmi;
  Handler hard_fault;
  Handler reserved4[7];
  Handler svc;
  Handler reserved12[2];
  Handler pend_sv;
  Handler sys_tick;
  Handler irq[32];
};
static_assert(sizeof(VectorTable) == 48 * 4);

constexpr VectorTable make_table() {
  VectorTable table{};
  table.stack = stack_top;
  table.reset = start_image;
  table.nmi = table.hard_fault = table.svc = table.pend_sv = table.sys_tick = fault_entry;
  for (Handler& handler : table.reserved4) handler = fault_entry;
  for (Handler& handler : table.reserved12) handler = fault_entry;
  for (Handler& handler : table.irq) handler = fault_entry;
  for (const InterruptEntry& entry : interrupt_entries)
    table.irq[static_cast<unsigned>(entry.irq)] = entry.handler;
  return table;
}

extern "C" [[gnu::section(".vectors"), gnu::used]] constexpr VectorTable image_vectors =
    make_table();

}  // namespace
}  // namespace lamplock::rp2040

void start_image() {
  using namespace lamplock::rp2040;
  scb().vtor = reinterpret_cast<std::uintptr_t>(&image_vectors);
  for (std::uint32_t* word = bss_begin; word != bss_end; ++word) *word = 0;
  for (std::uint32_t* word = rings_begin; word != rings_end; ++word) *word = 0;
  paint_stacks();
  main();
  __builtin_unreachable();
}
