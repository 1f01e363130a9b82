// Both cores: core 1 is started by the protocol of the ROM; both count under a spin lock; both
// claim one in the same cycle, and a cycle apart; the FIFO is filled until it overflows, then
// emptied and counted; core 1 answers by its interrupt. Core 1 toggles GPIO 3 while core 0 sleeps.
// Results on UART0.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// SIO (RP2040 datasheet, 2.3.1.7).
constexpr Word fifo_status = sio_base + 0x50, fifo_write = sio_base + 0x54,
               fifo_read = sio_base + 0x58, locks = sio_base + 0x5c, lock0 = sio_base + 0x100,
               lock1 = sio_base + 0x104, lock2 = sio_base + 0x108;
constexpr Word sram4 = 0x2004'0000, sram5 = 0x2004'1000;
constexpr Word valid = 1, ready = 2;
constexpr Word rounds = 5000;
constexpr unsigned irq_alarm = 0, irq_proc1 = 16;

volatile Word counter;
alignas(8) Word stack1[256];

void wait_event() { asm volatile("wfe" ::: "memory"); }
void send_event() { asm volatile("sev" ::: "memory"); }
void push(Word value) {
  while ((reg(fifo_status) & ready) == 0) {
  }
  reg(fifo_write) = value;
  send_event();
}
Word pop() {
  while ((reg(fifo_status) & valid) == 0) wait_event();
  return reg(fifo_read);
}
void acquire(Word lock) {
  while (reg(lock) == 0) {
  }
}
void release_lock(Word lock) { reg(lock) = 0; }

void count() {
  for (Word i = 0; i < rounds; ++i) {
    acquire(lock0);
    counter = counter + 1;
    release_lock(lock0);
  }
}

/// Sleeps until the alarm, then claims lock 2 after `later` cycles. The code is written to `place`,
/// in its own bank, so that the cores do not wait for each other's fetches.
Word claim_after_alarm(Word place, Word later) {
  constexpr std::uint16_t wfi = 0xbf30, nop = 0xbf00, load = 0x6800 /* ldr r0, [r0] */,
                          leave = 0x4770 /* bx lr */;
  // NOLINTBEGIN(performance-no-int-to-ptr): an address is what there is.
  auto* code = reinterpret_cast<volatile std::uint16_t*>(static_cast<std::uintptr_t>(place));
  const auto run = reinterpret_cast<Word (*)(Word)>(static_cast<std::uintptr_t>(place | 1));
  // NOLINTEND(performance-no-int-to-ptr)
  *code++ = wfi;
  for (Word i = 0; i < later; ++i) *code++ = nop;
  *code++ = load;
  *code++ = leave;
  asm volatile("cpsid i\ndsb\nisb" ::: "memory");
  enable_irq(irq_alarm);
  const Word claimed = run(lock2);
  reg(timer_base + 0x34) = 1;  // INTR
  reg(ppb_base + 0xe180) = 1u << irq_alarm;
  reg(ppb_base + 0xe280) = 1u << irq_alarm;
  asm volatile("cpsie i");
  return claimed;
}

/// Results of core 0 and core 1 when they claim lock 2 this many cycles after the same moment.
void contest(Word later0, Word later1) {
  push(later1);
  reg(timer_base + 0x10) = now_us() + 30;  // ALARM0
  print_hex(claim_after_alarm(sram4, later0));
  print_hex(pop());
  release_lock(lock2);
}

[[noreturn]] void core1() {
  push(reg(sio_base));  // CPUID
  count();
  push(0x1d1e);
  for (int i = 0; i < 3; ++i) push(claim_after_alarm(sram5, pop()));
  acquire(lock1);  // held by core 0 while it fills the FIFO
  Word sum = 0;
  for (int i = 0; i < 8; ++i) sum += pop();
  push(sum);
  release_lock(lock1);
  pop();
  reg(ppb_base + 0xe280) = 1u << irq_proc1;  // ICPR: of the words before
  enable_irq(irq_proc1);
  asm volatile(
      "1: str %1, [%0]\n"
      "b 1b\n" ::"r"(sio_base + 0x1c),
      "r"(1u << 3));
  __builtin_unreachable();
}

/// The ROM's protocol (2.8.2): a word that core 1 does not answer restarts it. Returns the words
/// sent.
Word launch(Word vectors, Word stack, Word entry) {
  const Word words[] = {0, 0, 1, vectors, stack, entry};
  Word sent = 0;
  for (unsigned i = 0; i < 6;) {
    if (words[i] == 0) {
      while ((reg(fifo_status) & valid) != 0) static_cast<void>(read(fifo_read));
      send_event();
    }
    push(words[i]);
    ++sent;
    i = pop() == words[i] ? i + 1 : 0;
  }
  return sent;
}

Word code(void (*function)()) {
  return static_cast<Word>(reinterpret_cast<std::uintptr_t>(function));
}

}  // namespace

extern "C" void irq16() {
  const Word asked = reg(fifo_read);
  push(asked * 2);
}

int main() {
  start();
  start_uart();
  make_output(3);

  acquire(lock1);
  print("cpuid");
  print_hex(reg(sio_base));
  const Word stack = static_cast<Word>(reinterpret_cast<std::uintptr_t>(stack1 + 256));
  const Word sent = launch(reg(ppb_base + 0xed08), stack, code(core1));
  print_hex(pop());
  print("\nsent");
  print_hex(sent);
  count();
  print("\ndone");
  print_hex(pop());
  print_hex(counter);

  print("\nclaims");
  reg(timer_base + 0x38) = 1;  // INTE
  contest(0, 0);
  contest(1, 0);
  contest(0, 1);

  print("\nlocks");
  print_hex(reg(locks));
  print_hex(reg(lock1));
  for (Word i = 1; i <= 8; ++i) push(i);
  print("\nfifo");
  print_hex(reg(fifo_status));
  reg(fifo_write) = 1000;
  print_hex(reg(fifo_status));
  reg(fifo_status) = 0xff;
  print_hex(reg(fifo_status));
  static_cast<void>(read(fifo_read));
  print_hex(reg(fifo_status));
  reg(fifo_status) = 0xff;
  release_lock(lock1);
  print_hex(pop());

  push(0);
  const Word begin = now_us();
  while (now_us() - begin < 20) {
  }
  push(21);
  print("\nirq");
  print_hex(pop());
  print("\n");
  for (;;) asm volatile("wfi");
}
