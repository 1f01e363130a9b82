#include "sim/chip/script/script_time.hpp"

#include <array>
#include <utility>

namespace lamplock::sim::chip::script {

std::string time_text(Picoseconds time) {
  struct Unit {
    Picoseconds size;
    std::size_t digits;
    const char* name;
  };
  constexpr std::array<Unit, 5> units{{{ps_per_s, 12, " s"},
                                       {ps_per_ms, 9, " ms"},
                                       {ps_per_us, 6, " us"},
                                       {ps_per_ns, 3, " ns"},
                                       {1, 0, " ps"}}};
  if (time == 0) return "0 s";
  const Picoseconds size = time < 0 ? -time : time;
  const Unit& unit = *std::find_if(units.begin(), units.end(),
                                   [size](const Unit& each) { return size >= each.size; });
  std::string text = time < 0 ? "-" : "";
  text += std::to_string(size / unit.size);
  std::string fraction = std::to_string(size % unit.size);
  fraction.insert(0, unit.digits - std::min(unit.digits, fraction.size()), '0');
  fraction.erase(fraction.find_last_not_of('0') + 1);
  if (!fraction.empty()) text.append(1, '.').append(fraction);
  return text + unit.name;
}

std::string distance_text(const Moment& from, const Moment& to) {
  const auto cycles = static_cast<std::int64_t>(to.cycle - from.cycle);
  return time_text(to.time - from.time) + " (" + std::to_string(cycles) +
         (cycles == 1 ? " cycle)" : " cycles)");
}

}  // namespace lamplock::sim::chip::script
