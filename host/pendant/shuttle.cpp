#include "host/pendant/shuttle.hpp"

#include <cstdlib>

namespace lamplock::pendant {
namespace {

constexpr std::size_t report_size = 5;
constexpr int farthest = 7;

/// Button that belongs to a bit: the five of the Xpress are bits 4 to 8.
Key button_of(Shuttle::Model model, int bit) {
  const int number = model == Shuttle::Model::pro ? bit + 1 : bit - 3;
  const int most = model == Shuttle::Model::pro ? 15 : 5;
  return number >= 1 && number <= most ? key_of_row(Key::button_1, number) : Key::none;
}

}  // namespace

Events Shuttle::take(std::span<const std::uint8_t> report) {
  Events events;
  if (report.size() != report_size) return events;
  const auto spring = static_cast<std::int8_t>(report[0]);
  // The ring cannot reach this position: the value counts as released.
  const int place = std::abs(int{spring}) > farthest ? 0 : spring;
  const auto buttons = static_cast<std::uint16_t>(report[3] | report[4] << 8);
  for (int bit = 0; bit < 16; ++bit) {
    const Key key = button_of(model_, bit);
    const bool down = (buttons >> bit & 1) != 0, was_down = (buttons_ >> bit & 1) != 0;
    if (key == Key::none || down == was_down) continue;
    events.push_back(key_event(down ? Event::Kind::key_down : Event::Kind::key_up, key));
  }
  buttons_ = buttons;
  if (place != spring_) events.push_back(count_event(Event::Kind::spring, place));
  spring_ = place;
  // The shorter direction of the wrapping counter.
  const int clicks = dial_ ? static_cast<std::int8_t>(report[1] - *dial_) : 0;
  dial_ = report[1];
  if (clicks != 0) events.push_back(count_event(Event::Kind::wheel, clicks));
  return events;
}

}  // namespace lamplock::pendant
