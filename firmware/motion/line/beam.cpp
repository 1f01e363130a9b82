#include "firmware/motion/line/beam.hpp"

namespace lamplock::motion {
namespace {

using stepper::BeamKind, stepper::CellTicks;

constexpr std::uint32_t half_q24 = std::uint32_t{1} << (stepper::pulse_place_bits - 1);

/// 24 bits of the mantissa above the number of its fraction bits.
std::uint32_t packed_ratio(UFloat ratio) {
  constexpr int dropped = 8;
  constexpr int max_places = 255;
  const int places = -(ratio.exponent() + dropped);
  // A smaller ratio passes no edge; a larger one does not occur.
  if (is_zero(ratio) || places > max_places || places < 0) return 0;
  return (ratio.mantissa() >> dropped) << dropped | static_cast<std::uint32_t>(places);
}

std::uint16_t packed_ticks(UFloat ticks) {
  constexpr int bits = CellTicks::mantissa_bits;
  if (is_zero(ticks)) return 0;
  const int exponent = ticks.exponent() + 31;
  if (exponent < 0) return 0;
  if (exponent > CellTicks::max_exponent) return CellTicks::of(~0u, CellTicks::max_exponent);
  return CellTicks::of(ticks.mantissa() >> (31 - bits), exponent);
}

}  // namespace

void LineBeam::return_to(const Place& place, const Line& line, UFloat length) {
  place_ = place;
  if (!place_.of_line) begin_place(line, length);
}

/// Sets the distance of cells, and the end of the line.
void LineBeam::begin_place(const Line& line, UFloat length) {
  place_.of_line = true;
  if (line.pixels) {
    // The header of the list may be gone after part of the line has been run.
    place_.cells = powers_->cells(line.power);
    place_.per_length = UFloat(place_.cells) / length;
  } else if (line.pulses) {
    place_.per_length = pulses_per_length_;
    if (place_.apart) place_.end_q24 = half_q24;
    place_.apart = false;
    place_.end_q24 +=
        static_cast<std::uint32_t>((length * place_.per_length).fixed(stepper::pulse_place_bits));
  }
}

void LineBeam::begin(const Line& line, UFloat length, const LineWay& way, int longest) {
  ratio_ = 0;
  // The length is 0 if the machine rests at the end of the line.
  if ((!line.pixels && !line.pulses) || is_zero(length)) return;
  if (!place_.of_line) begin_place(line, length);
  axis_ = static_cast<std::uint8_t>(longest);
  const auto parts = static_cast<std::uint32_t>(abs64(way.way.parts[index(longest)]));
  ratio_ = packed_ratio(times_power(place_.per_length * length / UFloat(parts), way.way.bits));
  if (line.pixels && line.laser == LinePower::proportional)
    cell_ticks_ = packed_ticks(UFloat(1u) / (place_.per_length * line.feed.real()));
}

void LineBeam::write(const Line& line, UFloat left, stepper::Segment& segment) {
  segment.beam_begins = false;
  segment.shines = line.pixels || (line.pulses && line.power != 0);
  if (line.pulses && !segment.shines) place_.unseen = true;
  // Otherwise the union contains the shot.
  if (!segment.shines) return;
  const UFloat cells_left = left * place_.per_length;
  if (line.pixels) {
    const auto left_q16 = static_cast<std::uint64_t>(cells_left.fixed(stepper::pixel_place_bits));
    const std::uint64_t all_q16 = std::uint64_t{place_.cells} << stepper::pixel_place_bits;
    segment.beam.place = left_q16 < all_q16 ? static_cast<std::uint32_t>(all_q16 - left_q16) : 0;
    segment.beam.list = line.power;
    segment.beam.cell_ticks = cell_ticks_;
    segment.beam_kind =
        line.laser == LinePower::constant ? BeamKind::pixels : BeamKind::pixels_by_speed;
  } else {
    segment.beam.place =
        place_.end_q24 - static_cast<std::uint32_t>(cells_left.fixed(stepper::pulse_place_bits));
    segment.beam.list = 0;
    segment.beam.power = line.power;
    segment.beam_kind = BeamKind::pulses;
    segment.beam_begins = place_.unseen;
    place_.unseen = false;
  }
  segment.beam.ratio = ratio_;
  segment.beam_axis = axis_ & 3u;
}

void LineBeam::end(const Line& line) {
  place_.of_line = false;
  if (!line.pulses) place_.apart = place_.unseen = true;
}

}  // namespace lamplock::motion
