#include "host/pendant/pendant.hpp"

#include <array>
#include <utility>

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;

constexpr Time display_interval = 100ms;
/// More than a pendant sends in a round; endless reports must not block the loop.
constexpr int max_reports = 16;

}  // namespace

Events Pendant::poll() {
  Events events;
  std::array<std::uint8_t, max_report_size> report{};
  for (int i = 0; i < max_reports; ++i) {
    const std::size_t size = device_->read(report, 0ms);
    if (size == 0) break;
    const Events more = decoder_->take(std::span(report).first(size));
    events.insert(events.end(), more.begin(), more.end());
  }
  return events;
}

void Pendant::show(const Display& display, Time now) {
  if (shown_ == display || (shown_ && now - shown_at_ < display_interval) || !writer_.idle())
    return;
  shown_ = display;
  shown_at_ = now;
  writer_.write(decoder_->display(display));
}

std::vector<HidInfo> find_pendants(const std::string& option) {
  std::vector<HidInfo> found = list_pendants();
  if (option != "auto")
    std::erase_if(found, [&option](const HidInfo& info) { return option != info.id->option; });
  return found;
}

}  // namespace lamplock::pendant
