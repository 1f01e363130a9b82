// What libgpiod 1.x and 2.x have in common: how a chip is opened, and what we call things.
//
// In:  files of chips, names of lines. Out: open chips; texts. Who: gpiod_v1.cpp and gpiod_v2.cpp,
//      of which a build has one.
#pragma once

#include <gpiod.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/gpio/lines.hpp"
#include "host/gpio/place.hpp"

namespace lamplock::gpio {

/// Whom others see that a line is used by.
inline constexpr const char* consumer = "lamplock";
/// Changes that the kernel keeps for a line (drivers/gpio/gpiolib-cdev.c).
inline constexpr unsigned kept_events = 16;

struct CloseChip {
  void operator()(gpiod_chip* chip) const { ::gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

/// Nothing if it may not be opened: errno says why.
inline Chip open_chip(const std::string& file) { return Chip(::gpiod_chip_open(file.c_str())); }

/// What `find` gives of the first chip on which it gives something. Throws no_line_error().
template <class Find>
auto find_on_chips(const std::string& name, const Find& find) {
  std::string closed;
  for (const std::string& file : chip_files()) {
    Chip chip = open_chip(file);
    if (!chip) {
      closed = file;
    } else if (auto found = find(std::move(chip))) {
      return std::move(*found);
    }
  }
  throw no_line_error(name, closed);
}

inline std::string text_of(const char* text) { return text == nullptr ? "" : text; }

/// Who has a line. Drivers of the kernel may have no name.
inline std::string user_of(const char* name, bool used) {
  const std::string user = text_of(name);
  return used && user.empty() ? "kernel" : user;
}

/// All chips, as `info_of` tells of one by its file.
template <class InfoOf>
std::vector<ChipInfo> all_chips(const InfoOf& info_of) {
  std::vector<ChipInfo> all;
  for (const std::string& file : chip_files()) all.push_back(info_of(file));
  return all;
}

}  // namespace lamplock::gpio
