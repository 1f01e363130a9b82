// PIO. Block 0: machine 0 a square wave by side-set (GPIO 2), machine 1 one with a fractional
// divider (GPIO 3), machines 2 and 3 from a pin to a pin (8 to 4; 9 to 5, past the synchroniser).
// Block 1: machines 0 and 1 exchange a flag (GPIO 6, 7), machine 2 reverses the bytes of words
// between two DMA channels (the result on UART0), machine 3 shifts a pattern from DMA to GPIO 10.
// GPIO 11 rises when all run. At the end the program toggles it, and machine 2 of block 1 follows
// it with GPIO 12.
#include "tests/chip_images/dma.hpp"

using namespace image;

namespace {

// Instructions (RP2040 datasheet, 3.4), delay and side-set in bits 12 to 8.
constexpr Word delay(Word clocks) { return clocks << 8; }
constexpr Word jump(Word to) { return to; }
constexpr Word wait_pin(Word level) { return 0x2020 | level << 7; }  // wait LEVEL pin 0
constexpr Word wait_irq(Word number) { return 0x20c0 | number; }     // wait 1 irq NUMBER
constexpr Word in_x(Word bits) { return 0x4020 | bits; }
constexpr Word out_pins(Word bits) { return 0x6000 | bits; }
constexpr Word out_x(Word bits) { return 0x6020 | bits; }
constexpr Word nop = 0xa042;  // mov y, y
constexpr Word irq_wait(Word number) { return 0xc020 | number; }
constexpr Word set_pins(Word value) { return 0xe000 | value; }
constexpr Word set_directions(Word value) { return 0xe080 | value; }

// Fields of PINCTRL, EXECCTRL, SHIFTCTRL (3.7).
constexpr Word out_base(Word gpio) { return gpio | 1 << 20; }
constexpr Word set_base(Word gpio) { return gpio << 5 | 1 << 26; }
constexpr Word side_base(Word gpio) { return gpio << 10 | 1u << 29; }
constexpr Word in_base(Word gpio) { return gpio << 15; }
constexpr Word autopush = 1 << 16, autopull = 1 << 17, out_right = 1 << 19;

/// A state machine that wraps from `last` to `first`.
struct Machine {
  Word block, number;
  Register& at(Word offset) const { return reg(block + 0xc8 + 0x18 * number + offset); }

  void set_up(Word divider, Word first, Word last, Word pins, Word shift = 0) const {
    at(0x00) = divider;
    at(0x04) = last << 12 | first << 7;
    at(0x08) = shift;
    at(0x14) = pins;
    at(0x10) = jump(first);
  }
  /// Makes the pin that the machine sets an output.
  void drive(unsigned gpio, Function function) const {
    const Word pins = at(0x14);
    at(0x14) = set_base(gpio);
    at(0x10) = set_pins(0);
    at(0x10) = set_directions(1);
    at(0x14) = pins;
    select(gpio, function);
  }
};

constexpr Word whole(Word divider) { return divider << 16; }

void load(Word block, std::initializer_list<Word> program) {
  Word address = block + 0x48;
  for (const Word instruction : program) {
    reg(address) = instruction;
    address += 4;
  }
}

Word sent[8], received[8], pattern[1000];

}  // namespace

int main() {
  start();
  release(block::pio0 | block::pio1 | block::dma);
  start_uart();
  make_output(11);

  load(pio0_base, {
                      nop | 1u << 12 | delay(1),  // 0: side 1 [1]
                      nop | delay(2),             //    side 0 [2]
                      set_pins(1),                // 2
                      set_pins(0),                //
                      wait_pin(1),                // 4
                      set_pins(1),                //
                      wait_pin(0),                //
                      set_pins(0),                //
                  });
  const Machine side{pio0_base, 0}, fraction{pio0_base, 1}, copy{pio0_base, 2}, quick{pio0_base, 3};
  side.set_up(whole(1), 0, 1, side_base(2));
  side.drive(2, Function::pio0);
  fraction.set_up(whole(3) | 64u << 8, 2, 3, set_base(3));
  fraction.drive(3, Function::pio0);
  copy.set_up(whole(1), 4, 7, set_base(4) | in_base(8));
  copy.drive(4, Function::pio0);
  quick.set_up(whole(1), 4, 7, set_base(5) | in_base(9));
  quick.drive(5, Function::pio0);
  reg(pio0_base + 0x38) = 1u << 9;  // INPUT_SYNC_BYPASS

  load(pio1_base, {
                      set_pins(1),              // 0
                      irq_wait(0),              //
                      set_pins(0) | delay(19),  //
                      wait_irq(0),              // 3
                      set_pins(1) | delay(3),   //
                      set_pins(0),              //
                      out_x(8),                 // 6
                      in_x(8),                  //
                      out_pins(1) | delay(4),   // 8
                      wait_pin(1),              // 9
                      set_pins(1),              //
                      wait_pin(0),              //
                      set_pins(0),              //
                  });
  const Machine asks{pio1_base, 0}, answers{pio1_base, 1}, turns{pio1_base, 2},
      shifts{pio1_base, 3};
  asks.set_up(whole(1), 0, 2, set_base(6));
  asks.drive(6, Function::pio1);
  answers.set_up(whole(1), 3, 5, set_base(7));
  answers.drive(7, Function::pio1);
  turns.set_up(whole(1), 6, 7, 0, autopush | autopull | out_right);
  shifts.set_up(whole(1), 8, 8, out_base(10), autopull | out_right);
  shifts.drive(10, Function::pio1);

  for (Word i = 0; i < 8; ++i) sent[i] = 0x0123'4567 + i * 0x1111'1111;
  for (Word& each : pattern) each = 0x5555'5555;
  // Requests: PIO1 TX2 10, RX2 14, TX3 11 (2.5.3.1).
  using namespace channel;
  start_dma(0, address(sent), pio1_base + 0x18, 8,
            enable | word | count_read | chain(0) | request(10));
  start_dma(1, pio1_base + 0x28, address(received), 8,
            enable | word | count_write | chain(1) | request(14));
  start_dma(2, address(pattern), pio1_base + 0x1c, 1000,
            enable | word | count_read | chain(2) | request(11));

  reg(pio0_base) = 15;
  reg(pio1_base) = 15;
  gpio_set() = 1u << 11;
  while (dma_busy(1)) {
  }
  print("words");
  for (const Word each : received) print_hex(each);
  print("\n");

  reg(pio1_base) = 11 | 1u << 6;  // machine 2 stops, SM_RESTART (3.7)
  const Machine& follows = turns;
  follows.set_up(whole(1), 9, 12, set_base(12) | in_base(11));
  follows.drive(12, Function::pio1);
  reg(pio1_base) = 15;
  for (;;) {
    const Word begin = now_us();
    while (now_us() - begin < 10) {
    }
    gpio_toggle() = 1u << 11;
  }
}
