// I2C0 as the master and I2C1 as a slave on one bus, which the script wires (GPIO 4 to 6, 5 to 7).
// The slave is a memory of eight bytes, served by its interrupt: the first byte written is the
// address. It takes 50 us for each byte read (GPIO 8). Results on UART0.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

constexpr unsigned irq_i2c1 = 24;
constexpr Word our_address = 0x42, slow_us = 50;

// Registers (4.3.17).
constexpr Word con = 0x00, tar = 0x04, sar = 0x08, data = 0x10, high_count = 0x1c, low_count = 0x20,
               pending = 0x2c, mask = 0x30, clear_read_request = 0x50, clear_abort = 0x54,
               clear_done = 0x58, clear_general_call = 0x68, enable = 0x6c, state = 0x70,
               received = 0x78, abort_source = 0x80, spike = 0xa0;
constexpr Word do_read = 1u << 8, do_stop = 1u << 9, do_restart = 1u << 10, first_byte = 1u << 11;
constexpr Word receive_full = 1u << 2, read_request = 1u << 5, done = 1u << 7,
               general_call = 1u << 11;
constexpr Word sending_done = 1u << 2, master_active = 1u << 5;

volatile Word memory[8];
volatile Word place, reads_done, calls;

Register& master(Word offset) { return reg(i2c0_base + offset); }
Register& slave(Word offset) { return reg(i2c1_base + offset); }

/// 125 cycles high (HCNT + SPKLEN + 7), 187 low (LCNT + 1) (4.3.14.1).
void start_i2c(Word base, Word control) {
  reg(base + enable) = 0;
  reg(base + con) = control;
  reg(base + tar) = our_address;
  reg(base + sar) = our_address;
  reg(base + high_count) = 111;
  reg(base + low_count) = 186;
  reg(base + spike) = 7;
  reg(base + mask) = 0;
  reg(base + enable) = 1;
}

void to(Word target) {
  master(enable) = 0;
  master(tar) = target;
  master(enable) = 1;
}

/// Waits for the STOP.
void finish() {
  while ((master(state) & sending_done) == 0 || (master(state) & master_active) != 0) {
  }
}

void answer_slowly() {
  static_cast<void>(read(i2c1_base + clear_read_request));
  gpio_set() = 1u << 8;
  for (const Word from = now_us(); now_us() - from < slow_us;) {
  }
  const Word byte = memory[place & 7];
  place = place + 1;
  gpio_clear() = 1u << 8;
  slave(data) = byte;
}

}  // namespace

extern "C" void irq24() {
  const Word what = slave(pending);
  while (slave(received) != 0) {
    const Word word = slave(data);
    if ((word & first_byte) != 0) {
      place = word & 0xff;
    } else {
      memory[place & 7] = word;
      place = place + 1;
    }
  }
  if ((what & general_call) != 0) {
    static_cast<void>(read(i2c1_base + clear_general_call));
    calls = calls + 1;
  }
  if ((what & read_request) != 0) answer_slowly();
  if ((what & done) != 0) {
    static_cast<void>(read(i2c1_base + clear_done));
    reads_done = reads_done + 1;
  }
}

int main() {
  start();
  start_uart();
  release(block::i2c0 | block::i2c1);
  make_output(8);
  for (const unsigned gpio : {4u, 5u, 6u, 7u}) {
    reg(pads_bank0_base + 4 + 4 * gpio) = 1u << 6 | 1u << 3 | 1u << 1;  // pulled up
    select(gpio, Function::i2c);
  }
  start_i2c(i2c0_base, 1u << 6 | 1u << 5 | 2u << 1 | 1);  // master, fast
  start_i2c(i2c1_base, 1u << 5 | 2u << 1);                // slave
  slave(mask) = receive_full | read_request | done | general_call;
  enable_irq(irq_i2c1);

  for (const Word byte : {Word{2}, Word{0x11}, Word{0x22}, 0x33 | do_stop}) master(data) = byte;
  finish();
  print("written");
  for (const unsigned n : {2u, 3u, 4u}) print_hex(memory[n]);
  print("\n");
  flush();

  for (const Word word : {Word{3}, do_read | do_restart, do_read | do_stop}) master(data) = word;
  finish();
  print("read");
  for (int n = 0; n < 2; ++n) print_hex(master(data) & 0xff);
  print_hex(reads_done);
  print("\n");

  to(our_address + 1);
  master(data) = 0x55 | do_stop;
  finish();
  print("other");
  print_hex(master(abort_source) & 0xffff);
  static_cast<void>(read(i2c0_base + clear_abort));
  to(1u << 11);  // SPECIAL: general call
  master(data) = 6 | do_stop;
  finish();
  print("\ncalled");
  print_hex(master(abort_source) & 0xffff);
  print_hex(calls);
  print_hex(place);
  print("\n");
  for (;;) {
  }
}
