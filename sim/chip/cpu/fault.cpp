#include "sim/chip/cpu/fault.hpp"

#include <array>

#include "sim/chip/fabric/hex.hpp"

namespace lamplock::sim::chip {
namespace {

struct Name {
  std::string_view title, word;
};
/// In the order of FaultKind.
constexpr std::array<Name, 4> names{{{"HardFault", "hardfault"},
                                     {"lock-up", "lockup"},
                                     {"bad boot block", "bootblock"},
                                     {"watchdog reset", "watchdog"}}};

struct Words {
  std::string_view before;
  std::string_view after{};  ///< of the address
  bool has_address = false;
};
/// In the order of FaultCause.
constexpr std::array<Words, 18> causes{
    {{"undefined instruction"},
     {"unpredictable instruction"},
     {"BKPT without a debugger"},
     {"SVC at a priority that does not permit it"},
     {"branch to an even address (Thumb bit clear)"},
     {"unaligned access to ", "", true},
     {"read from ", " failed", true},
     {"write to ", " failed", true},
     {"fetch from ", " failed", true},
     {"the MPU refuses the access to ", "", true},
     {"the exception frame cannot be written to ", "", true},
     {"the exception frame at ", " cannot be read or is not valid", true},
     {"the vector at ", " cannot be read", true},
     {"invalid EXC_RETURN ", "", true},
     {"an access of a boot ROM function failed"},
     {"the checksum of the first 256 bytes of the flash is wrong"},
     {"its time ran out"},
     {"forced by TRIGGER"}}};

const Name& name_of(FaultKind kind) { return names[static_cast<std::size_t>(kind)]; }

}  // namespace

std::string_view title_of(FaultKind kind) { return name_of(kind).title; }

std::string_view word_of(FaultKind kind) { return name_of(kind).word; }

std::optional<FaultKind> fault_kind(std::string_view word) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].word == word) return static_cast<FaultKind>(i);
  return std::nullopt;
}

std::string cause_text(const Fault& fault) {
  const Words& words = causes[static_cast<std::size_t>(fault.cause)];
  std::string text(words.before);
  if (words.has_address) text.append(hex(fault.address)).append(words.after);
  return text;
}

}  // namespace lamplock::sim::chip
