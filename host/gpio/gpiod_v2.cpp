// libgpiod 2.0 and later (Debian 13). A test compiles and links it with Debian 13's library
// (tests/gpiod_v2); it has not been run with chips of a kernel.
#include <fmt/format.h>

#include <cerrno>
#include <cstddef>
#include <utility>

#include "host/gpio/gpiod_common.hpp"
#include "host/gpio/host_lines.hpp"

namespace lamplock::gpio {
namespace {

/// Frees an object of the library by its function.
template <auto free>
struct Free {
  template <class Thing>
  void operator()(Thing* thing) const {
    free(thing);
  }
};
template <class Thing, auto free>
using Owned = std::unique_ptr<Thing, Free<free>>;

using ChipData = Owned<gpiod_chip_info, ::gpiod_chip_info_free>;
using LineData = Owned<gpiod_line_info, ::gpiod_line_info_free>;
using Settings = Owned<gpiod_line_settings, ::gpiod_line_settings_free>;
using LineConfig = Owned<gpiod_line_config, ::gpiod_line_config_free>;
using RequestConfig = Owned<gpiod_request_config, ::gpiod_request_config_free>;
using Request = Owned<gpiod_line_request, ::gpiod_line_request_release>;
using EventBuffer = Owned<gpiod_edge_event_buffer, ::gpiod_edge_event_buffer_free>;

/// A line on its chip.
struct Found {
  Chip chip;
  unsigned number = 0;
};

/// A requested line: it no longer needs its chip.
struct Line {
  Request request;
  unsigned number = 0;
};

Found find(const std::string& text) {
  const LineAddress place = parse_line_address(text);
  if (!place.name.empty())
    return find_on_chips(place.name, [&place](Chip chip) -> std::optional<Found> {
      const int number = ::gpiod_chip_get_line_offset_from_name(chip.get(), place.name.c_str());
      if (number < 0) return std::nullopt;
      return Found{std::move(chip), static_cast<unsigned>(number)};
    });
  Chip chip = open_chip(place.chip);
  if (!chip) throw chip_error(place.chip, errno);
  const ChipData data(::gpiod_chip_get_info(chip.get()));
  if (!data) throw chip_error(place.chip, errno);
  if (place.number >= ::gpiod_chip_info_get_num_lines(data.get())) throw no_line_error(text);
  return {std::move(chip), place.number};
}

gpiod_line_bias bias_of(Bias bias) {
  switch (bias) {
    case Bias::as_is:
      return GPIOD_LINE_BIAS_AS_IS;
    case Bias::none:
      return GPIOD_LINE_BIAS_DISABLED;
    case Bias::pull_up:
      return GPIOD_LINE_BIAS_PULL_UP;
    case Bias::pull_down:
      return GPIOD_LINE_BIAS_PULL_DOWN;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

gpiod_line_value value_of(bool active) {
  return active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

Settings input_settings(const LineRequest& wanted, gpiod_line_edge edges) {
  Settings settings(::gpiod_line_settings_new());
  if (!settings) throw request_error(wanted.place, errno);
  ::gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
  ::gpiod_line_settings_set_edge_detection(settings.get(), edges);
  ::gpiod_line_settings_set_bias(settings.get(), bias_of(wanted.bias));
  ::gpiod_line_settings_set_active_low(settings.get(), wanted.active_low);
  return settings;
}

Settings output_settings(const LineRequest& wanted, bool active) {
  Settings settings(::gpiod_line_settings_new());
  if (!settings) throw request_error(wanted.place, errno);
  ::gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  if (wanted.drive == Drive::open_drain)
    ::gpiod_line_settings_set_drive(settings.get(), GPIOD_LINE_DRIVE_OPEN_DRAIN);
  ::gpiod_line_settings_set_active_low(settings.get(), wanted.active_low);
  ::gpiod_line_settings_set_output_value(settings.get(), value_of(active));
  return settings;
}

/// Requests a line that was found. Null, with errno, if that is refused.
Request request(const Found& found, const Settings& settings) {
  const LineConfig lines(::gpiod_line_config_new());
  const RequestConfig who(::gpiod_request_config_new());
  if (!lines || !who ||
      ::gpiod_line_config_add_line_settings(lines.get(), &found.number, 1, settings.get()) != 0)
    return nullptr;
  ::gpiod_request_config_set_consumer(who.get(), consumer);
  return Request(::gpiod_chip_request_lines(found.chip.get(), who.get(), lines.get()));
}

/// An input, with its edges if `has_edges`.
class WatchedInput final : public Input {
 public:
  WatchedInput(Line line, bool has_edges)
      : line_(std::move(line)),
        buffer_(has_edges ? ::gpiod_edge_event_buffer_new(kept_events) : nullptr) {}

  bool moved() override {
    constexpr std::int64_t no_wait_ns = 0;
    if (gone_ || !buffer_ ||
        ::gpiod_line_request_wait_edge_events(line_.request.get(), no_wait_ns) <= 0)
      return false;
    const int count =
        ::gpiod_line_request_read_edge_events(line_.request.get(), buffer_.get(), kept_events);
    // The wait succeeds and the read fails if the chip was unplugged.
    if (count < 0) gone_ = true;
    return count > 0;
  }

  std::optional<bool> active() override {
    if (gone_) return std::nullopt;
    const gpiod_line_value value =
        ::gpiod_line_request_get_value(line_.request.get(), line_.number);
    gone_ = value == GPIOD_LINE_VALUE_ERROR;
    return gone_ ? std::nullopt : std::optional(value == GPIOD_LINE_VALUE_ACTIVE);
  }

 private:
  Line line_;
  EventBuffer buffer_;  ///< none without edges
  bool gone_ = false;
};

class DrivenOutput final : public Output {
 public:
  explicit DrivenOutput(Line line) : line_(std::move(line)) {}
  bool set(bool active) override {
    return ::gpiod_line_request_set_value(line_.request.get(), line_.number, value_of(active)) == 0;
  }

 private:
  Line line_;
};

LineInfo line_info(gpiod_chip* chip, unsigned number) {
  const LineData data(::gpiod_chip_get_line_info(chip, number));
  if (!data) return {number};
  return {
      number, text_of(::gpiod_line_info_get_name(data.get())),
      user_of(::gpiod_line_info_get_consumer(data.get()), ::gpiod_line_info_is_used(data.get())),
      ::gpiod_line_info_get_direction(data.get()) == GPIOD_LINE_DIRECTION_OUTPUT};
}

ChipInfo info_of(const std::string& file) {
  ChipInfo info{.file = file};
  const Chip chip = open_chip(file);
  const ChipData data(chip ? ::gpiod_chip_get_info(chip.get()) : nullptr);
  if (!data) {
    info.problem = chip_problem(file, errno);
    return info;
  }
  info.label = text_of(::gpiod_chip_info_get_label(data.get()));
  const std::size_t count = ::gpiod_chip_info_get_num_lines(data.get());
  info.lines.reserve(count);
  for (unsigned number = 0; number < count; ++number)
    info.lines.push_back(line_info(chip.get(), number));
  return info;
}

class HostLines final : public Lines {
 public:
  std::vector<ChipInfo> chips() override { return all_chips(info_of); }
  std::unique_ptr<Input> input(const LineRequest& wanted) override {
    const Found found = find(wanted.place);
    Request made = request(found, input_settings(wanted, GPIOD_LINE_EDGE_BOTH));
    const bool has_edges = made != nullptr;
    if (!has_edges && has_no_edges(errno))
      made = request(found, input_settings(wanted, GPIOD_LINE_EDGE_NONE));
    if (!made) throw request_error(wanted.place, errno);
    return std::make_unique<WatchedInput>(Line{std::move(made), found.number}, has_edges);
  }
  std::unique_ptr<Output> output(const LineRequest& wanted, bool active) override {
    const Found found = find(wanted.place);
    Request made = request(found, output_settings(wanted, active));
    if (!made) throw request_error(wanted.place, errno);
    return std::make_unique<DrivenOutput>(Line{std::move(made), found.number});
  }
};

}  // namespace

std::unique_ptr<Lines> host_lines() { return std::make_unique<HostLines>(); }

std::string library_version() { return fmt::format("libgpiod {}", ::gpiod_api_version()); }

}  // namespace lamplock::gpio
