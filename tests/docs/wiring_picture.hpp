// The picture of a board's wiring (docs/boards/NAME.svg), drawn from its row.
//
// In:  a row of shared/boards. Out: the text of an SVG file: inputs on the left, outputs on the
// right, each with its pad, its name and what is on its wire. Who: wiring_test.cpp, which compares
// it with the file.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "shared/boards/board_row.hpp"

namespace lamplock::test {

class WiringPicture {
 public:
  explicit WiringPicture(const boards::BoardRow& row) : row_(row), pins_(row.maps[0].pins) {}

  std::string text() {
    const auto inputs = std::count_if(pins_.begin(), pins_.end(), [](const boards::PinUse& use) {
      return use.direction == boards::Direction::input;
    });
    const auto lines = std::max<long>(inputs, static_cast<long>(pins_.size()) - inputs);
    const long height = top + lines * pitch + 56;
    put("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1140 {}\" width=\"1140\" "
        "font-family=\"sans-serif\" font-size=\"13\">",
        height);
    put("<rect width=\"1140\" height=\"{}\" fill=\"#fff\"/>", height);
    put("<rect x=\"{}\" y=\"34\" width=\"{}\" height=\"{}\" rx=\"8\" fill=\"#eef3ee\" "
        "stroke=\"#264\"/>",
        left, right - left, lines * pitch + 16);
    std::string title(row_.name);
    if (row_.maps.size() > 1) title += fmt::format(", map {}", row_.maps[0].name);
    label((left + right) / 2, 24, "middle", "#000", title);
    long input_y = top, output_y = top;
    for (const boards::PinUse& use : pins_) {
      const bool is_input = use.direction == boards::Direction::input;
      long& y = is_input ? input_y : output_y;
      is_input ? draw_input(use, y) : draw_output(use, y);
      y += pitch;
    }
    label((left + right) / 2, height - 26, "middle", "#555",
          "red: can release energy, off while the board does not drive it; switches are shown at "
          "rest");
    label((left + right) / 2, height - 9, "middle", "#555", "numbers: GPIO of the RP2040");
    put("</svg>");
    return text_;
  }

 private:
  static constexpr long top = 56, pitch = 24, left = 450, right = 750, reach = 80;

  template <class... Parts>
  void put(fmt::format_string<Parts...> format, Parts&&... parts) {
    text_ += fmt::format(format, std::forward<Parts>(parts)...) + "\n";
  }
  void label(long x, long y, std::string_view anchor, std::string_view colour,
             std::string_view words) {
    put("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" fill=\"{}\">{}</text>", x, y, anchor, colour,
        words);
  }
  void stroke(std::string_view path, std::string_view colour = "#000") {
    put("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>", path, colour);
  }
  /// Ground at the end of a wire.
  void ground(long x, long y) {
    stroke(fmt::format("M{} {}v-5v10M{} {}v6M{} {}v2", x, y, x - 4, y - 3, x - 8, y - 1));
  }
  bool is_in(std::uint32_t pads, const boards::PinUse& use) const {
    return (pads >> use.gpio & 1) != 0;
  }

  void draw_input(const boards::PinUse& use, long y) {
    using boards::Role;
    label(left + 8, y + 4, "start", "#000", fmt::format("{} {}", use.gpio, use.name));
    std::string note;
    const bool is_signal = use.role == Role::lamp_sync || use.role == Role::uart_rx ||
                           use.role == Role::sensor ||
                           (use.role >= Role::photosensor_1 && use.role <= Role::photosensor_4);
    if (is_signal) {
      stroke(fmt::format("M{} {}h{}m-8 -4l8 4l-8 4", left - reach, y, reach));
      note = use.role == Role::lamp_sync ? "flash of the lamp"
             : use.role == Role::sensor  ? "voltage, 0 to 3.3 V"
                                         : "signal, 3.3 V";
    } else {
      const bool is_open = use.role == Role::probe || use.role == Role::aux_in;
      stroke(fmt::format("M{} {}h-28m-24 0h-28M{} {}l-24 {}", left, y, left - 28, y - 2,
                         is_open ? -8 : 0));
      for (const long x : {left - 28, left - 52})
        put("<circle cx=\"{}\" cy=\"{}\" r=\"2.5\"/>", x, y);
      ground(left - reach, y);
      note = is_open ? "contact to ground, open at rest" : "contact to ground, closed at rest";
    }
    if (use.inverted) note += "; inverter on the board";
    if (is_in(row_.driven, use) && !use.inverted) note += "; buffer on the board";
    if (is_in(row_.pulled_up, use)) note += "; pull-up on the board";
    label(left - reach - 14, y + 4, "end", "#000", note);
  }

  void draw_output(const boards::PinUse& use, long y) {
    using boards::Role;
    const std::string_view colour = use.energy ? "#c00" : "#000";
    label(right - 8, y + 4, "end", colour, fmt::format("{} {}", use.name, use.gpio));
    stroke(fmt::format("M{} {}h{}m-8 -4l8 4l-8 4", right, y, reach), colour);
    label(right + reach + 8, y + 4, "start", colour, note_of(use));
  }
  std::string note_of(const boards::PinUse& use) const {
    using boards::Role;
    const bool is_drive = use.role <= Role::dir_a;
    const bool is_enable = boards::is_enable(use.role) || use.role == Role::z_enable;
    if (use.energy) return "pull-down of 4.7 to 10 kOhm, then its gate";
    if (is_enable)
      return is_in(row_.pulled_up, use) ? "low enables; pull-up on the board"
                                        : "low enables; pull-up of 4.7 to 10 kOhm";
    if (is_drive) return row_.drives ? "TMC2209 on the board" : "drive";
    if (use.role == Role::tick_line) return "leave empty";
    return "load, through a buffer or transistor";
  }

  const boards::BoardRow& row_;
  boards::Pins pins_;
  std::string text_;
};

}  // namespace lamplock::test
