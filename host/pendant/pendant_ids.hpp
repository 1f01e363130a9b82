// Known pendants, by their USB vendor and product. One table for `lamplock jog`, which opens them,
// and `lamplock devices`, which lists them.
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::pendant {

/// Protocol of a pendant.
enum class Kind : std::uint8_t { hb04, whb04b, shuttle_xpress, shuttle_pro };

/// One model.
struct PendantId {
  std::uint16_t vendor, product;
  Kind kind;
  const char* option;  ///< value of `lamplock jog --pendant`
  const char* name;    ///< for the user
};

/// Numbers of the LinuxCNC drivers xhc-hb04, xhc-whb04b-6 and shuttle.
inline constexpr std::array pendant_ids{
    PendantId{0x10ce, 0xeb70, Kind::hb04, "hb04", "XHC HB04"},
    PendantId{0x10ce, 0xeb93, Kind::whb04b, "whb04b", "XHC WHB04B-4 or WHB04B-6"},
    PendantId{0x0b33, 0x0020, Kind::shuttle_xpress, "shuttlexpress", "Contour ShuttleXpress"},
    PendantId{0x0b33, 0x0030, Kind::shuttle_pro, "shuttlepro", "Contour ShuttlePRO v2"}};

/// The model with these numbers; null if there is none.
constexpr const PendantId* find_pendant(std::uint16_t vendor, std::uint16_t product) {
  for (const PendantId& id : pendant_ids)
    if (id.vendor == vendor && id.product == product) return &id;
  return nullptr;
}

}  // namespace lamplock::pendant
