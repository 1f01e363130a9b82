// Functions of the boot ROM, found by its tables: bits and memory. Results on UART0.
#include "tests/chip_images/rp2040.hpp"

using namespace image;

namespace {

// RP2040 datasheet, 2.8.3: magic number and version, tables and lookup by half-words.
Word half(Word address) {
  Word value = 0;  // in assembly: the compiler treats such an address as invalid
  asm volatile("ldrh %0, [%1]" : "=l"(value) : "l"(address));
  return value;
}
constexpr Word magic = 0x10, function_table = 0x14, lookup = 0x18;

template <class Function>
Function pointer(Word address) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an address is what there is.
  return reinterpret_cast<Function>(static_cast<std::uintptr_t>(address));
}

Word find(char first, char second) {
  const auto look = pointer<Word (*)(Word, Word)>(half(lookup));
  return look(half(function_table), static_cast<Word>(static_cast<unsigned char>(first)) |
                                        static_cast<Word>(static_cast<unsigned char>(second)) << 8);
}

Word bits(char code, Word value) { return pointer<Word (*)(Word)>(find(code, '3'))(value); }

alignas(4) unsigned char from[16], to[16];

void show(const unsigned char* bytes) {
  for (int i = 0; i < 16; i += 4)
    print_hex(static_cast<Word>(bytes[i]) << 24 | static_cast<Word>(bytes[i + 1]) << 16 |
              static_cast<Word>(bytes[i + 2]) << 8 | bytes[i + 3]);
}

}  // namespace

int main() {
  start();
  start_uart();
  print("magic");
  print_hex(half(magic));
  print_hex(half(magic + 2) & 0xff);
  print("\nbits");
  print_hex(bits('P', 0xf0f0'0001));
  print_hex(bits('R', 0x1234'5678));
  print_hex(bits('L', 0x0000'8000));
  print_hex(bits('L', 0));
  print_hex(bits('T', 0x0001'0000));
  print_hex(bits('T', 0));
  print("\nnone");
  print_hex(find('?', '!'));

  for (unsigned i = 0; i < 16; ++i) from[i] = static_cast<unsigned char>(i + 1);
  print("\nset");
  using Set = unsigned char* (*)(unsigned char*, unsigned char, Word);
  using Copy = unsigned char* (*)(unsigned char*, const unsigned char*, Word);
  print_hex(pointer<Set>(find('M', 'S'))(to + 1, 0xaa, 9) == to + 1 ? 1 : 0);
  show(to);
  pointer<Set>(find('S', '4'))(to, 0x55, 8);
  show(to);
  print("\ncopy");
  print_hex(pointer<Copy>(find('M', 'C'))(to + 3, from, 5) == to + 3 ? 1 : 0);
  show(to);
  pointer<Copy>(find('C', '4'))(to, from, 12);
  show(to);
  print("\n");
  for (;;) {
  }
}
