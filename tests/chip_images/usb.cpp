// A USB serial port with only the controller's registers and DPRAM: enumeration, a bulk pair with
// two buffers each way. Received lines are stored until a short packet ends them, then sent back
// with upper and lower case swapped.
//
// GPIO 2 toggles with each start of frame, GPIO 3 with each received buffer, GPIO 4 with each
// buffer sent. GPIO 5: pulled up; GPIO 6: bus reset; GPIO 7: configured. Register values on UART0.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 4.1.2.5 and 4.1.4.
constexpr Word dpram = 0x5010'0000, usb_base = 0x5011'0000;
constexpr Word address_register = usb_base, main_control = usb_base + 0x40,
               frame_number = usb_base + 0x48, sie_control = usb_base + 0x4c,
               sie_status = usb_base + 0x50, buffer_status = usb_base + 0x58,
               second_buffer = usb_base + 0x5c, stall_arm = usb_base + 0x68,
               muxing = usb_base + 0x74, power = usb_base + 0x78, int_enable = usb_base + 0x90,
               int_status = usb_base + 0x98;
constexpr Word int_buffer = 1u << 4, int_reset = 1u << 12, int_setup = 1u << 16,
               int_frame = 1u << 17;
constexpr Word status_setup = 1u << 17, status_reset = 1u << 19;
constexpr unsigned irq_usb = 5;

// Endpoint and buffer control words (4.1.2.5), by bit in BUFF_STATUS: 2 x number, + 1 for OUT.
enum Pipe : Word { control_in, control_out, bulk_in, bulk_out, notify_in };
constexpr Word available = 1u << 10, stall = 1u << 11, data1 = 1u << 13, full = 1u << 15,
               length_mask = 0x3ff;
constexpr Word packet = 64;
constexpr Word control_buffer = 0x100, out_buffers = 0x180, in_buffers = 0x200,
               notify_buffer = 0x280;
constexpr Word endpoint_on = 1u << 31, two_buffers = 1u << 30, each_buffer = 1u << 29,
               bulk = 2u << 26, interrupt = 3u << 26;

using Byte = unsigned char;

constexpr Byte device_descriptor[] = {18,   1,    0x00, 0x02, 2, 0, 0, packet, 0x8a,
                                      0x2e, 0x0a, 0x00, 0,    1, 0, 0, 0,      1};
// Communications Class 1.2: a control interface with its functional descriptors and an endpoint for
// notifications, a data interface with the bulk pair.
constexpr Byte configuration_descriptor[] = {
    9, 2,    67,   0,    2,      1,  0,  0x80, 50,  // configuration 1
    9, 4,    0,    0,    1,      2,  2,  0,    0,   // interface 0: ACM
    5, 0x24, 0,    0x20, 0x01,                      // header
    5, 0x24, 1,    0,    1,                         // call management
    4, 0x24, 2,    2,                               // ACM: line coding
    5, 0x24, 6,    0,    1,                         // union
    7, 5,    0x82, 3,    8,      0,  16,            // notifications
    9, 4,    1,    0,    2,      10, 0,  0,    0,   // interface 1: data
    7, 5,    0x01, 2,    packet, 0,  0,             // bulk OUT
    7, 5,    0x81, 2,    packet, 0,  0};            // bulk IN
static_assert(sizeof configuration_descriptor == 67);

volatile std::uint16_t& half(Word offset) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an address is what there is.
  return *reinterpret_cast<volatile std::uint16_t*>(static_cast<std::uintptr_t>(dpram + offset));
}
volatile Byte& byte(Word offset) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an address is what there is.
  return *reinterpret_cast<volatile Byte*>(static_cast<std::uintptr_t>(dpram + offset));
}
volatile std::uint16_t& control_of(Pipe pipe, Word buffer = 0) {
  return half(0x80 + 4 * pipe + 2 * buffer);
}

/// AVAILABLE a cycle of clk_usb after its fields (4.1.2.5.1): 12 of clk_sys are more.
void arm(Pipe pipe, Word buffer, Word control) {
  control_of(pipe, buffer) = static_cast<std::uint16_t>(control);
  asm volatile("nop; nop; nop; nop; nop; nop; nop; nop; nop; nop; nop; nop" ::: "memory");
  control_of(pipe, buffer) = static_cast<std::uint16_t>(control | available);
}

// Endpoint 0.
const Byte* answer;
Word answer_left;
bool answer_data1;
enum class Stage { idle, answers, takes, status_in, status_out } stage;
Word new_address;
Byte line_coding[7] = {0x00, 0xc2, 0x01, 0, 0, 0, 8};

void answer_more() {
  const Word count = answer_left < packet ? answer_left : packet;
  for (Word i = 0; i < count; ++i) byte(control_buffer + i) = answer[i];
  answer += count;
  answer_left -= count;
  arm(control_in, 0, full | count | (answer_data1 ? data1 : 0));
  answer_data1 = !answer_data1;
}

void give(const Byte* bytes, Word size, Word wanted) {
  answer = bytes;
  answer_left = size < wanted ? size : wanted;
  answer_data1 = true;
  stage = Stage::answers;
  answer_more();
}

void acknowledge() {
  stage = Stage::status_in;
  arm(control_in, 0, full | data1);
}

void refuse() {
  stage = Stage::idle;
  reg(stall_arm) = 3;
  control_of(control_in) = stall;
  control_of(control_out) = stall;
}

void configure() {
  constexpr Word bulk_pipe = endpoint_on | two_buffers | each_buffer | bulk;
  reg(dpram + 0x08) = bulk_pipe | in_buffers;
  reg(dpram + 0x0c) = bulk_pipe | out_buffers;
  reg(dpram + 0x10) = endpoint_on | each_buffer | interrupt | notify_buffer;
  arm(bulk_out, 0, packet);
  arm(bulk_out, 1, packet | data1);
  gpio_set() = 1u << 7;
}

void take_setup() {
  reg(sie_status) = status_setup;
  const Word request = byte(0) | static_cast<Word>(byte(1)) << 8, value = half(2), length = half(6);
  switch (request) {
    case 0x0680:  // GET_DESCRIPTOR
      if (value == 0x0100) return give(device_descriptor, sizeof device_descriptor, length);
      if (value == 0x0200)
        return give(configuration_descriptor, sizeof configuration_descriptor, length);
      return refuse();
    case 0x0500:  // SET_ADDRESS
      new_address = value;
      return acknowledge();
    case 0x0900:  // SET_CONFIGURATION
      configure();
      return acknowledge();
    case 0x2021:  // SET_LINE_CODING
      stage = Stage::takes;
      return arm(control_out, 0, packet | data1);
    case 0x21a1:  // GET_LINE_CODING
      return give(line_coding, sizeof line_coding, length);
    case 0x2221:  // SET_CONTROL_LINE_STATE
    case 0x2220:  // the same to the device: rp2040js requests it so
      return acknowledge();
    default:
      return refuse();
  }
}

void control_sent() {
  if (stage == Stage::answers) {
    if (answer_left != 0) return answer_more();
    stage = Stage::status_out;
    return arm(control_out, 0, packet | data1);
  }
  stage = Stage::idle;
  if (new_address == 0) return;
  reg(address_register) = new_address;
  new_address = 0;
}

void control_taken() {
  if (stage != Stage::takes) {
    stage = Stage::idle;
    return;
  }
  for (Word i = 0; i < sizeof line_coding; ++i) line_coding[i] = byte(control_buffer + i);
  acknowledge();
}

// The bulk pair.
Byte text[512];
volatile Word come, gone, ready;  // bytes; `ready` of them are to be sent back
Word next_in;
struct Seen {
  volatile Word order, count;
  volatile std::uint16_t controls[8];
} seen_out, seen_in;

void note(Seen& seen, Word buffer, std::uint16_t control) {
  seen.order = seen.order << 1 | buffer;
  if (seen.count < 8) seen.controls[seen.count] = control;
  seen.count = seen.count + 1;
}

/// Fills the next buffer.
void send_more() {
  if (gone == ready) return;
  const Word count = ready - gone < packet ? ready - gone : packet;
  for (Word i = 0; i < count; ++i) byte(in_buffers + packet * next_in + i) = text[gone + i] ^ 0x20;
  gone = gone + count;
  arm(bulk_in, next_in, full | count | (next_in != 0 ? data1 : 0));
  next_in ^= 1;
}

void buffer_taken(Word buffer) {
  const std::uint16_t control = control_of(bulk_out, buffer);
  const Word length = control & length_mask;
  note(seen_out, buffer, control);
  for (Word i = 0; i < length && come < sizeof text; ++i) {
    text[come] = byte(out_buffers + packet * buffer + i);
    come = come + 1;
  }
  arm(bulk_out, buffer, packet | (buffer != 0 ? data1 : 0));
  if (length == packet || come == ready) return;
  ready = come;
  send_more();
  send_more();
}

void buffer_sent(Word buffer) {
  note(seen_in, buffer, control_of(bulk_in, buffer));
  send_more();
}

/// Returns one done buffer of a pipe: its bit is set again if the other one is done too.
bool take_done(Pipe pipe, Word& buffer) {
  const Word bit = 1u << pipe;
  if ((reg(buffer_status) & bit) == 0) return false;
  buffer = (reg(second_buffer) & bit) != 0 ? 1 : 0;
  reg(buffer_status) = bit;
  return true;
}

// Starts of frame.
volatile Word frames, first_frame, first_us, last_frame, last_us;

void start_of_frame() {
  gpio_toggle() = 1u << 2;
  const Word number = reg(frame_number);
  if (frames == 0) {
    first_frame = number;
    first_us = now_us();
  } else if (frames == 10) {
    last_frame = number;
    last_us = now_us();
  }
  frames = frames + 1;
}

void bus_reset() {
  gpio_set() = 1u << 6;
  reg(sie_status) = status_reset;
  reg(address_register) = 0;
  stage = Stage::idle;
}

void start_usb() {
  release(block::usbctrl);
  for (Word i = 0; i < 0x1000; i += 4) reg(dpram + i) = 0;
  reg(muxing) = 1u << 0 | 1u << 3;  // TO_PHY, SOFTCON
  reg(power) = 1u << 2 | 1u << 3;   // VBUS_DETECT and its override enable
  reg(main_control) = 1;            // CONTROLLER_EN
  reg(int_enable) = int_buffer | int_reset | int_setup | int_frame;
  enable_irq(irq_usb);
  gpio_set() = 1u << 5;
  reg(sie_control) = 1u << 29 | 1u << 16;  // EP0_INT_1BUF, PULLUP_EN
}

void show(const char* name, const Seen& seen) {
  print(name);
  print_hex(seen.count);
  print_hex(seen.order);
  for (Word i = 0; i < seen.count && i < 8; ++i) print_hex(seen.controls[i]);
  print("\n");
}

}  // namespace

extern "C" void irq5() {
  const Word why = reg(int_status);
  if ((why & int_frame) != 0) start_of_frame();
  if ((why & int_reset) != 0) bus_reset();
  Word buffer = 0;
  if ((why & int_buffer) != 0) {
    while (take_done(bulk_out, buffer)) {
      gpio_toggle() = 1u << 3;
      buffer_taken(buffer);
    }
    while (take_done(bulk_in, buffer)) {
      gpio_toggle() = 1u << 4;
      buffer_sent(buffer);
    }
    if (take_done(control_in, buffer)) control_sent();
    if (take_done(control_out, buffer)) control_taken();
  }
  if ((why & int_setup) != 0) take_setup();
}

int main() {
  start();
  start_uart();
  for (unsigned gpio = 2; gpio <= 7; ++gpio) make_output(gpio);
  start_usb();
  while (frames < 11) asm volatile("wfi");
  print("frames");
  print_hex((last_frame - first_frame) & 0x7ff);
  print_hex(last_us - first_us);
  print("\n");
  while (ready == 0 || gone != ready) asm volatile("wfi");
  const Word sent = frames;
  while (frames - sent < 2) asm volatile("wfi");
  print("status");
  print_hex(reg(sie_status) & 0x000f'001f);
  print("\n");
  show("out", seen_out);
  show("in", seen_in);
  for (;;) asm volatile("wfi");
}
