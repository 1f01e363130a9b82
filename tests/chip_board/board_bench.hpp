// An image of one board on the wiring of the same or another board.
#pragma once

#include <algorithm>
#include <map>
#include <string>

#include "shared/boards/all_boards.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {

using boards::BoardRow;
using boards::Role;

/// The image of a board, read once.
inline const sim::chip::Image& image_of(const BoardRow& row) {
  static std::map<std::string_view, sim::chip::Image> images;
  auto found = images.find(row.name);
  if (found == images.end())
    found =
        images.emplace(row.name, sim::chip::load_image(in_build(std::string(row.image) + ".elf")))
            .first;
  return found->second;
}

/// Points on a lamp, or programs with a continuous laser.
inline job::Profile profile_of(const BoardRow& row, bool cuts) {
  job::Profile profile = chip_profile();
  profile.settings.set_milli(Id::pin_map, static_cast<int>(row.first_map) * 1000);
  if (!cuts) return profile;
  profile.settings.set_milli(Id::lamp_mode, 0);
  profile.settings.set_milli(Id::laser_mode, 1000);
  return profile;
}

/// Buffers, resistors and inverters of a board.
inline sim::ChipBoardOptions wired_as(const BoardRow& row) {
  sim::ChipBoardOptions options = quick_host();
  options.wiring = row.first_map;
  return options;
}

/// An image of one board on the wiring of another, with the settings that the image begins with.
struct Bench {
  Bench(const BoardRow& of_image, const BoardRow& of_wiring,
        ChipRig::Power power = ChipRig::Power::on, bool cuts = false)
      : Bench(profile_of(of_image, cuts), of_image, of_wiring, power) {}
  Bench(const job::Profile& machine, const BoardRow& of_image, const BoardRow& of_wiring,
        ChipRig::Power power)
      : profile(machine),
        rig(machine.settings, world_for(machine), power, image_of(of_image), wired_as(of_wiring)) {
    rig.is_broken = &of_image != &of_wiring;
  }
  job::Profile profile;
  ChipRig rig;
};

/// Watches all pads that can release energy on a board, at each of their changes, whatever drives
/// them.
class EnergyWatch final : public sim::chip::PadListener {
 public:
  EnergyWatch(sim::chip::Chip& chip, const BoardRow& row) : chip_(chip) {
    for (const boards::MapRow& map : row.maps)
      for (const boards::PinUse& use : map.pins)
        if (use.energy) pins_ |= 1u << use.gpio;
    chip.gpio().listen(*this);
  }
  EnergyWatch(const EnergyWatch&) = delete;
  EnergyWatch& operator=(const EnergyWatch&) = delete;
  void pad_changed(unsigned gpio, bool level, sim::chip::Cycle /*at*/) override {
    if (level && (pins_ >> gpio & 1) != 0) ++rises;
  }
  std::uint32_t levels() const { return chip_.gpio().pad_levels() & pins_; }

  std::size_t rises = 0;

 private:
  sim::chip::Chip& chip_;
  std::uint32_t pins_ = 0;
};

/// Tests of each board; new rows are found by themselves.
class EachBoard : public testing::TestWithParam<const BoardRow*> {
 protected:
  const BoardRow& row() const { return *GetParam(); }
};

/// Name of a board in the name of a test.
inline std::string board_test_name(const testing::TestParamInfo<const BoardRow*>& info) {
  std::string name(info.param->name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace lamplock::test
