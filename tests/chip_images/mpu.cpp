// Memory protection unit: a region that forbids writes, one that forbids execution, one that
// permits only privileged code; sub-regions, and which of two regions decides. The fault handler
// raises GPIO 3; the stores and loads under test lie between edges of GPIO 2. Results on UART0.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 2.4.8; ARMv6-M Architecture Reference Manual, B3.5.
constexpr Word mpu_type = ppb_base + 0xed90, mpu_control = ppb_base + 0xed94,
               mpu_number = ppb_base + 0xed98, mpu_base = ppb_base + 0xed9c,
               mpu_attributes = ppb_base + 0xeda0;
constexpr Word on = 1, background = 1u << 2;  // MPU_CTRL
constexpr Word valid = 1u << 4;               // MPU_RBAR
constexpr Word region_on = 1, size_256 = 7u << 1, size_all = 31u << 1, never_execute = 1u << 28;
constexpr Word privileged_only = 1u << 24, all = 3u << 24, read_only = 6u << 24;
constexpr Word without_part(Word part) { return 1u << (8 + part); }  // of eight (SRD)

alignas(256) volatile Word guarded[64];
/// `movs r0, #1`, `bx lr`.
alignas(256) Word code[64] = {0x4770'2001};

// Of the last fault.
volatile Word faults, fault_pc, fault_number, back_to_caller;

Word address(const volatile void* of) {
  return static_cast<Word>(reinterpret_cast<std::uintptr_t>(of));
}

void set_region(Word number, Word base, Word attributes) {
  reg(mpu_number) = number;
  reg(mpu_attributes) = 0;  // the selected region: off while its base changes
  reg(mpu_base) = base | valid | number;
  reg(mpu_attributes) = attributes;
  asm volatile("dsb; isb" ::: "memory");
}

void enable(Word control) {
  reg(mpu_control) = control;
  asm volatile("dsb; isb" ::: "memory");
}

Word load(Word index) {
  Word value = 0;
  asm volatile(
      ".syntax unified\n"
      "str %[pin], [%[sio], #0x14]\n"
      "ldr %[value], [%[from]]\n"
      "str %[pin], [%[sio], #0x18]\n"
      : [value] "=&l"(value)
      : [pin] "l"(1u << 2), [sio] "l"(sio_base), [from] "l"(&guarded[index])
      : "memory");
  return value;
}

Word call_code() {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an address is what there is.
  return reinterpret_cast<Word (*)()>(static_cast<std::uintptr_t>(address(code) | 1))();
}

void pause() {
  const Word begin = now_us();
  while (now_us() - begin < 3) {
  }
}

}  // namespace

extern "C" {

extern const char guarded_store[];

/// A store between two edges of GPIO 2.
[[gnu::naked]] void store_between_edges(volatile Word* /*to*/, Word /*value*/) {
  asm volatile(
      ".syntax unified\n"
      "movs r2, #13\n"
      "lsls r2, r2, #28\n"
      "movs r3, #4\n"
      "str r3, [r2, #0x14]\n"
      "guarded_store: str r1, [r0]\n"
      "str r3, [r2, #0x18]\n"
      "bx lr\n");
}

/// Records the fault's frame on the stack and sets the place to continue.
void note_fault(Word* frame) {
  faults = faults + 1;
  fault_pc = frame[6];
  Word exception = 0;
  asm volatile("mrs %0, ipsr" : "=r"(exception));
  fault_number = exception;
  guarded[63] = faults;  // here the MPU is off (HFNMIENA 0)
  frame[6] = back_to_caller != 0 ? frame[5] & ~1u : frame[6] + 2;
  asm volatile("msr control, %0\nisb" ::"r"(0));  // privileged again
}

/// 1 + 1 + 1 cycles, and the store of 1.
[[gnu::naked]] void hard_fault() {
  asm volatile(
      ".syntax unified\n"
      "movs r0, #13\n"
      "lsls r0, r0, #28\n"
      "movs r1, #8\n"
      "str r1, [r0, #0x14]\n"
      "str r1, [r0, #0x18]\n"
      "mov r0, sp\n"
      "push {r4, lr}\n"
      "bl note_fault\n"
      "pop {r4, pc}\n");
}
}

namespace {

void store(Word index, Word value) { store_between_edges(&guarded[index], value); }

}  // namespace

int main() {
  start();
  start_uart();
  for (const unsigned gpio : {2u, 3u}) make_output(gpio);
  for (Word i = 0; i < 64; ++i) guarded[i] = i;
  print("type");
  print_hex(reg(mpu_type));
  set_region(0, address(guarded), region_on | size_256 | read_only | without_part(1));
  print("\n");
  flush();

  store(0, 0x5a);  // the MPU is off
  pause();
  enable(on | background);
  const Word read_back = load(0);
  pause();
  store(0, 0xa5);
  print("fault");
  print_hex(faults);
  print_hex(fault_pc == address(guarded_store) ? 1 : 0);
  print_hex(fault_number);
  print_hex(read_back);
  print_hex(guarded[0]);
  print_hex(guarded[63]);

  print("\npart");
  store(7, 0x17);  // the last word of the first part of 32 bytes
  store(8, 0x18);  // the first and the last of the second
  store(15, 0x1f);
  store(16, 0x20);
  print_hex(faults);
  for (const Word index : {7u, 8u, 15u, 16u}) print_hex(guarded[index]);

  print("\nhigher");
  set_region(1, address(guarded), region_on | size_256 | all);
  store(0, 0x77);
  print_hex(faults);
  print_hex(guarded[0]);
  set_region(1, 0, 0);

  print("\nfetch");
  set_region(2, address(code), region_on | size_256 | all | never_execute);
  back_to_caller = 1;
  call_code();
  print_hex(faults);
  print_hex(fault_pc == address(code) ? 1 : 0);
  set_region(2, 0, 0);
  print_hex(call_code());
  print_hex(faults);
  back_to_caller = 0;

  print("\nuser");
  set_region(0, 0, region_on | size_all | all);
  set_region(3, address(guarded), region_on | size_256 | privileged_only);
  store(0, 0x88);
  print_hex(faults);
  asm volatile("msr control, %0\nisb" ::"r"(1));  // unprivileged
  store(0, 0x99);
  Word privilege = 1;
  asm volatile("mrs %0, control" : "=r"(privilege));
  print_hex(faults);
  print_hex(guarded[0]);
  print_hex(privilege);
  print("\n");
  for (;;) {
  }
}
