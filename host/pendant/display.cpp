#include "host/pendant/display.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::pendant {
namespace {

constexpr std::uint8_t report_id = 6;
constexpr long max_word = 0xffff;
constexpr double decimals = 10'000;

}  // namespace

void XhcFrame::word(long value) {
  const auto cut = static_cast<unsigned>(std::clamp(value, 0l, max_word));
  byte(static_cast<std::uint8_t>(cut & 0xff));
  byte(static_cast<std::uint8_t>(cut >> 8));
}

void XhcFrame::number(double value) {
  constexpr double most = static_cast<double>(max_word) + 0.9999;
  constexpr long minus = 0x8000;
  const double size = std::isfinite(value) ? std::min(std::fabs(value), most) : most;
  const auto parts = std::lround(size * decimals);
  const auto per_unit = static_cast<long>(decimals);
  word(parts / per_unit);
  word(parts % per_unit + (value < 0 && parts != 0 ? minus : 0));
}

std::vector<FeatureReport> XhcFrame::reports() const {
  constexpr std::size_t payload = std::tuple_size_v<FeatureReport> - 1;
  std::vector<FeatureReport> result;
  for (std::size_t at = 0; at < bytes_.size(); at += payload) {
    FeatureReport report{report_id};
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at),
                std::min(payload, bytes_.size() - at), report.begin() + 1);
    result.push_back(report);
  }
  return result;
}

}  // namespace lamplock::pendant
