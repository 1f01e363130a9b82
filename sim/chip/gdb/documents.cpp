#include "sim/chip/gdb/documents.hpp"

#include <array>
#include <string_view>

namespace lamplock::sim::chip::gdb {

namespace {

std::string reg(std::string_view name, unsigned number, std::string_view type = "int") {
  return "<reg name=\"" + std::string(name) + "\" bitsize=\"32\" regnum=\"" +
         std::to_string(number) + "\" type=\"" + std::string(type) + "\"/>\n";
}

std::string region(std::string_view kind, std::uint32_t start, std::uint32_t length) {
  return "<memory type=\"" + std::string(kind) + "\" start=\"" + std::to_string(start) +
         "\" length=\"" + std::to_string(length) + "\"";
}

struct Region {
  std::string_view kind;
  std::uint32_t start, length;
};
// RP2040 datasheet, 2.2. Registers count as RAM: debuggers have no other word for them.
constexpr std::array regions{
    Region{"rom", 0x0000'0000, 0x4000},       // ROM
    Region{"ram", 0x1400'0000, 0x0500'0000},  // XIP: control, cache as SRAM, SSI
    Region{"ram", 0x2000'0000, 0x4'2000},     // SRAM
    Region{"ram", 0x2100'0000, 0x4'0000},     // its banks one by one
    Region{"ram", 0x4000'0000, 0x0100'0000},  // APB
    Region{"ram", 0x5000'0000, 0x0100'0000},  // AHB-Lite
    Region{"ram", 0xd000'0000, 0x1000},       // SIO
    Region{"ram", 0xe000'0000, 0x10'0000},    // inside the core
};
constexpr std::uint32_t flash_window = 0x1000'0000, flash_alias = 0x0100'0000;
constexpr unsigned flash_aliases = 4;

}  // namespace

std::string target_description() {
  std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE target SYSTEM \"gdb-target.dtd\">\n"
      "<target version=\"1.0\">\n<architecture>arm</architecture>\n"
      "<feature name=\"org.gnu.gdb.arm.m-profile\">\n";
  for (unsigned i = 0; i <= 12; ++i) text += reg(std::string("r") + std::to_string(i), i);
  text += reg("sp", 13, "data_ptr") + reg("lr", 14) + reg("pc", 15, "code_ptr") + reg("xpsr", 16);
  text += "</feature>\n<feature name=\"org.gnu.gdb.arm.m-system\">\n";
  text += reg("msp", 17, "data_ptr") + reg("psp", 18, "data_ptr") + reg("primask", 19) +
          reg("control", 20);
  return text + "</feature>\n</target>\n";
}

std::string memory_map(std::uint32_t flash_size) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE memory-map PUBLIC \"+//IDN gnu.org//DTD GDB Memory Map "
      "V1.0//EN\" \"http://sourceware.org/gdb/gdb-memory-map.dtd\">\n<memory-map>\n";
  // Erased by sectors of 4 KiB (W25Q16JV datasheet).
  text += region("flash", flash_window, flash_size) +
          "><property name=\"blocksize\">4096</property></memory>\n";
  for (unsigned i = 1; i < flash_aliases; ++i)
    text += region("rom", flash_window + i * flash_alias, flash_size) + "/>\n";
  for (const Region& each : regions) text += region(each.kind, each.start, each.length) + "/>\n";
  return text + "</memory-map>\n";
}

}  // namespace lamplock::sim::chip::gdb
