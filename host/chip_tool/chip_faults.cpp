#include "host/chip_tool/chip_faults.hpp"

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <string_view>

#include "host/chip_tool/chip_run.hpp"
#include "sim/chip/fabric/hex.hpp"
#include "sim/chip/script/script_time.hpp"

namespace lamplock::chip_tool {
namespace {

namespace chip = sim::chip;

/// "die + 0x4": the function at an address and the offset in it; empty if there is none.
std::string symbol_at(const ChipRun& run, std::uint32_t address) {
  if (address == 0) return {};
  // Return addresses have the Thumb bit.
  const std::uint32_t place = address & ~1u;
  if (place < chip::Bus::rom_size) return "boot ROM";
  const chip::FunctionTable& functions = run.functions();
  const std::size_t index = functions.find(place);
  if (index == functions.size()) return {};
  const chip::ImageSymbol& symbol = functions[index];
  // A function without a size reaches to the next one, but not into another memory.
  if ((symbol.address ^ place) >> 24 != 0) return {};
  return fmt::format("{} + {:#x}", symbol.name, place - symbol.address);
}

std::string place_text(const ChipRun& run, std::uint32_t address) {
  const std::string symbol = symbol_at(run, address);
  const std::string text = chip::hex(address);
  return symbol.empty() ? text : text + " (" + symbol + ')';
}

bool has_address(const chip::Fault& fault) {
  using enum chip::FaultCause;
  return fault.cause >= unaligned_access && fault.cause <= exception_return;
}

cli::Json fault_json(const ChipRun& run, const chip::Fault& fault) {
  cli::Json json;
  json["kind"] = chip::word_of(fault.kind);
  json["core"] = fault.core;
  json["cause"] = chip::cause_text(fault);
  if (has_address(fault)) json["address"] = chip::hex(fault.address);
  json["pc"] = chip::hex(fault.pc);
  json["symbol"] = symbol_at(run, fault.pc);
  json["lr"] = chip::hex(fault.lr);
  json["lr_symbol"] = symbol_at(run, fault.lr);
  json["cycle"] = fault.cycle;
  json["at_ps"] = fault.at;
  json["allowed"] = run.allows(fault);
  return json;
}

}  // namespace

std::string fault_text(const ChipRun& run, const chip::Fault& fault) {
  return fmt::format("{} on core {}, {}, pc {}, lr {}, cycle {}, at {}", chip::title_of(fault.kind),
                     fault.core, chip::cause_text(fault), place_text(run, fault.pc),
                     place_text(run, fault.lr), fault.cycle, chip::script::time_text(fault.at));
}

cli::Json faults_json(const ChipRun& run) {
  cli::Json json = cli::Json::array();
  for (const chip::Fault& fault : run.chip().faults()) json.push_back(fault_json(run, fault));
  return json;
}

}  // namespace lamplock::chip_tool
