// libgpiod 1.5 and 1.6 (Debian 12).
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <utility>

#include "host/gpio/gpiod_common.hpp"
#include "host/gpio/host_lines.hpp"

namespace lamplock::gpio {
namespace {

/// A line and its chip, which is closed after the line is released.
struct Line {
  Chip chip;
  gpiod_line* line = nullptr;
};

Line find(const std::string& text) {
  const LineAddress place = parse_line_address(text);
  if (!place.name.empty())
    return find_on_chips(place.name, [&place](Chip chip) -> std::optional<Line> {
      gpiod_line* line = ::gpiod_chip_find_line(chip.get(), place.name.c_str());
      return line == nullptr ? std::nullopt : std::optional(Line{std::move(chip), line});
    });
  Chip chip = open_chip(place.chip);
  if (!chip) throw chip_error(place.chip, errno);
  if (place.number >= ::gpiod_chip_num_lines(chip.get())) throw no_line_error(text);
  gpiod_line* line = ::gpiod_chip_get_line(chip.get(), place.number);
  if (line == nullptr) throw request_error(text, errno);
  return {std::move(chip), line};
}

int bias_flag(Bias bias) {
  switch (bias) {
    case Bias::as_is:
      return 0;
    case Bias::none:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    case Bias::pull_up:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case Bias::pull_down:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
  }
  return 0;
}

/// Requests a line that was found. False, with errno, if that is refused.
bool request(const Line& found, const LineRequest& wanted, int type, bool active) {
  int flags = wanted.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (type == GPIOD_LINE_REQUEST_DIRECTION_OUTPUT) {
    if (wanted.drive == Drive::open_drain) flags |= GPIOD_LINE_REQUEST_FLAG_OPEN_DRAIN;
  } else {
    flags |= bias_flag(wanted.bias);
  }
  const gpiod_line_request_config config{consumer, type, flags};
  return ::gpiod_line_request(found.line, &config, active ? 1 : 0) == 0;
}

/// An input, with its edges if `has_edges`.
class WatchedInput final : public Input {
 public:
  WatchedInput(Line line, bool has_edges) : line_(std::move(line)), has_edges_(has_edges) {}

  bool moved() override {
    constexpr timespec no_wait{};
    if (gone_ || !has_edges_ || ::gpiod_line_event_wait(line_.line, &no_wait) <= 0) return false;
    std::array<gpiod_line_event, kept_events> read;
    const int count = ::gpiod_line_event_read_multiple(line_.line, read.data(), kept_events);
    // The wait succeeds and the read fails if the chip was unplugged.
    if (count < 0) gone_ = true;
    return count > 0;
  }

  std::optional<bool> active() override {
    const int value = gone_ ? -1 : ::gpiod_line_get_value(line_.line);
    if (value < 0) gone_ = true;
    return gone_ ? std::nullopt : std::optional(value != 0);
  }

 private:
  Line line_;
  bool has_edges_;
  bool gone_ = false;
};

class DrivenOutput final : public Output {
 public:
  explicit DrivenOutput(Line line) : line_(std::move(line)) {}
  bool set(bool active) override { return ::gpiod_line_set_value(line_.line, active ? 1 : 0) == 0; }

 private:
  Line line_;
};

ChipInfo info_of(const std::string& file) {
  ChipInfo info{.file = file};
  const Chip chip = open_chip(file);
  if (!chip) {
    info.problem = chip_problem(file, errno);
    return info;
  }
  info.label = text_of(::gpiod_chip_label(chip.get()));
  const unsigned count = ::gpiod_chip_num_lines(chip.get());
  info.lines.reserve(count);
  for (unsigned number = 0; number < count; ++number) {
    gpiod_line* line = ::gpiod_chip_get_line(chip.get(), number);
    if (line == nullptr) continue;
    info.lines.push_back({number, text_of(::gpiod_line_name(line)),
                          user_of(::gpiod_line_consumer(line), ::gpiod_line_is_used(line)),
                          ::gpiod_line_direction(line) == GPIOD_LINE_DIRECTION_OUTPUT});
  }
  return info;
}

class HostLines final : public Lines {
 public:
  std::vector<ChipInfo> chips() override { return all_chips(info_of); }
  std::unique_ptr<Input> input(const LineRequest& wanted) override {
    Line line = find(wanted.place);
    const bool has_edges = request(line, wanted, GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES, false);
    if (!has_edges &&
        !(has_no_edges(errno) && request(line, wanted, GPIOD_LINE_REQUEST_DIRECTION_INPUT, false)))
      throw request_error(wanted.place, errno);
    return std::make_unique<WatchedInput>(std::move(line), has_edges);
  }
  std::unique_ptr<Output> output(const LineRequest& wanted, bool active) override {
    Line line = find(wanted.place);
    if (!request(line, wanted, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, active))
      throw request_error(wanted.place, errno);
    return std::make_unique<DrivenOutput>(std::move(line));
  }
};

}  // namespace

std::unique_ptr<Lines> host_lines() { return std::make_unique<HostLines>(); }

std::string library_version() { return fmt::format("libgpiod {}", ::gpiod_version_string()); }

}  // namespace lamplock::gpio
