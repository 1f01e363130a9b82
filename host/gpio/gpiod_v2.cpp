// libgpiod 2.0 and later (Debian 13). Debian 12, on which lamplock is built and tested, does not
// have it: this file was written after the library's own documentation of its functions, checked
// against their declarations, and has not run.
#include <fmt/format.h>
#include <gpiod.h>

#include <cerrno>
#include <cstddef>
#include <utility>

#include "host/gpio/host_lines.hpp"
#include "host/gpio/place.hpp"

namespace lamplock::gpio {
namespace {

constexpr const char* consumer = "lamplock";
constexpr std::int64_t ns_per_us = 1'000;
/// Changes that the kernel keeps for a line (drivers/gpio/gpiolib-cdev.c).
constexpr std::size_t kept_events = 16;

/// Frees what the library has made, by the function for it.
template <auto free>
struct Free {
  template <class Thing>
  void operator()(Thing* thing) const {
    free(thing);
  }
};
template <class Thing, auto free>
using Owned = std::unique_ptr<Thing, Free<free>>;

using Chip = Owned<gpiod_chip, ::gpiod_chip_close>;
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

/// A line that was asked for: it does not need its chip any more.
struct Line {
  Request request;
  unsigned number = 0;
};

std::string text_of(const char* text) { return text == nullptr ? "" : text; }

Found find_by_name(const std::string& name) {
  std::string closed;
  for (const std::string& file : chip_files()) {
    Chip chip(::gpiod_chip_open(file.c_str()));
    if (!chip) {
      closed = file;
      continue;
    }
    const int number = ::gpiod_chip_get_line_offset_from_name(chip.get(), name.c_str());
    if (number >= 0) return {std::move(chip), static_cast<unsigned>(number)};
  }
  throw no_line_error(name, closed);
}

Found find(const std::string& text) {
  const Place place = parse_place(text);
  if (!place.name.empty()) return find_by_name(place.name);
  Chip chip(::gpiod_chip_open(place.chip.c_str()));
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

Settings input_settings(const LineRequest& wanted) {
  Settings settings(::gpiod_line_settings_new());
  if (!settings) throw request_error(wanted.place, errno);
  ::gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
  ::gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
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

/// Finds a line and asks for it. Throws Error.
Line request(const LineRequest& wanted, const Settings& settings) {
  const Found found = find(wanted.place);
  const LineConfig lines(::gpiod_line_config_new());
  const RequestConfig who(::gpiod_request_config_new());
  if (!lines || !who ||
      ::gpiod_line_config_add_line_settings(lines.get(), &found.number, 1, settings.get()) != 0)
    throw request_error(wanted.place, errno);
  ::gpiod_request_config_set_consumer(who.get(), consumer);
  Request made(::gpiod_chip_request_lines(found.chip.get(), who.get(), lines.get()));
  if (!made) throw request_error(wanted.place, errno);
  return {std::move(made), found.number};
}

class WatchedInput final : public Input {
 public:
  explicit WatchedInput(Line line)
      : line_(std::move(line)), buffer_(::gpiod_edge_event_buffer_new(kept_events)) {}

  std::vector<Event> events(std::chrono::microseconds time) override {
    std::vector<Event> all;
    if (gone_ ||
        ::gpiod_line_request_wait_edge_events(line_.request.get(), time.count() * ns_per_us) <= 0)
      return all;
    const int count =
        ::gpiod_line_request_read_edge_events(line_.request.get(), buffer_.get(), kept_events);
    // What can be waited for and not be read is a chip that was unplugged.
    if (count < 0) gone_ = true;
    for (int i = 0; i < count; ++i) {
      gpiod_edge_event* event =
          ::gpiod_edge_event_buffer_get_event(buffer_.get(), static_cast<unsigned long>(i));
      all.push_back({::gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE,
                     std::chrono::nanoseconds(
                         static_cast<std::int64_t>(::gpiod_edge_event_get_timestamp_ns(event)))});
    }
    return all;
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
  EventBuffer buffer_;
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
  const std::string user = text_of(::gpiod_line_info_get_consumer(data.get()));
  const bool unnamed_user = user.empty() && ::gpiod_line_info_is_used(data.get());
  return {number, text_of(::gpiod_line_info_get_name(data.get())), unnamed_user ? "kernel" : user,
          ::gpiod_line_info_get_direction(data.get()) == GPIOD_LINE_DIRECTION_OUTPUT};
}

ChipInfo info_of(const std::string& file) {
  ChipInfo info{.file = file};
  const Chip chip(::gpiod_chip_open(file.c_str()));
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
  std::vector<ChipInfo> chips() override {
    std::vector<ChipInfo> all;
    for (const std::string& file : chip_files()) all.push_back(info_of(file));
    return all;
  }
  std::unique_ptr<Input> input(const LineRequest& wanted) override {
    return std::make_unique<WatchedInput>(request(wanted, input_settings(wanted)));
  }
  std::unique_ptr<Output> output(const LineRequest& wanted, bool active) override {
    return std::make_unique<DrivenOutput>(request(wanted, output_settings(wanted, active)));
  }
};

}  // namespace

std::unique_ptr<Lines> host_lines() { return std::make_unique<HostLines>(); }

std::string library_version() { return fmt::format("libgpiod {}", ::gpiod_api_version()); }

}  // namespace lamplock::gpio
