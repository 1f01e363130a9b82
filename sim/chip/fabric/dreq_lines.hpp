// Data requests of the blocks to the DMA (RP2040 datasheet, 2.5.3).
//
// In:  from blocks with a FIFO, the transfers that it can take or give now; from the PWM, one pulse
//      for each wrap that a channel waits for.
// Out: to the DMA, which gives one credit a clock for transfers that no credit covers yet; to the
//      PWM, the wraps that a channel waits for.
// The PIO FIFOs (0..15) are not here: the DMA reads them itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lamplock::sim::chip {

/// Numbers of the DREQs, as in TREQ_SEL (2.5.3.1).
enum class Dreq : std::uint8_t {
  pio0_tx0 = 0,
  pio0_rx0 = 4,
  pio1_tx0 = 8,
  pio1_rx0 = 12,
  spi0_tx = 16,
  spi0_rx,
  spi1_tx,
  spi1_rx,
  uart0_tx,
  uart0_rx,
  uart1_tx,
  uart1_rx,
  pwm_wrap0 = 24,
  i2c0_tx = 32,
  i2c0_rx,
  i2c1_tx,
  i2c1_rx,
  adc,
  xip_stream,
  xip_ssitx,
  xip_ssirx
};
inline constexpr unsigned dreq_count = 40;

/// The DMA's side.
class DreqListener {
 public:
  virtual ~DreqListener() = default;
  virtual void dreq_pulsed(unsigned dreq) = 0;
  virtual void dreq_level_changed() = 0;
};

/// A block whose requests have no FIFO: it needs to compute them only while the DMA waits.
class DreqPulser {
 public:
  virtual ~DreqPulser() = default;
  /// Bit n: a channel waits for the wrap of slice n.
  virtual void wraps_awaited(std::uint32_t slices) = 0;
};

/// The other blocks' side. Calls are made at the present time of the wheel.
class DreqLines {
 public:
  explicit DreqLines(DreqListener& listener) : listener_(listener) {}
  /// A FIFO has room for, or holds, this many transfers.
  void set_level(Dreq dreq, unsigned transfers) {
    unsigned& level = levels_[static_cast<std::size_t>(dreq)];
    if (level == transfers) return;
    level = transfers;
    listener_.dreq_level_changed();
  }
  /// One request, for blocks that have no FIFO: PWM slice `slice` has wrapped.
  void pwm_wrap(unsigned slice) {
    listener_.dreq_pulsed(static_cast<unsigned>(Dreq::pwm_wrap0) + slice);
  }
  void connect(DreqPulser& pulser) { pulser_ = &pulser; }
  /// The DMA's channels wait for the wraps of these slices.
  void await_wraps(std::uint32_t slices) {
    if (slices == awaited_) return;
    awaited_ = slices;
    if (pulser_ != nullptr) pulser_->wraps_awaited(slices);
  }
  unsigned level(unsigned dreq) const { return dreq < dreq_count ? levels_[dreq] : 0; }

 private:
  DreqListener& listener_;
  DreqPulser* pulser_ = nullptr;
  std::uint32_t awaited_ = 0;
  std::array<unsigned, dreq_count> levels_{};
};

}  // namespace lamplock::sim::chip
