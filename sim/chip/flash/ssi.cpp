#include "sim/chip/flash/ssi.hpp"

#include <algorithm>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// Offsets (4.10.13).
enum Offset : std::uint32_t {
  ctrlr0 = 0x00,
  ctrlr1 = 0x04,
  ssienr = 0x08,
  mwcr = 0x0c,
  ser = 0x10,
  baudr = 0x14,
  txftlr = 0x18,
  rxftlr = 0x1c,
  txflr = 0x20,
  rxflr = 0x24,
  sr = 0x28,
  imr = 0x2c,
  isr = 0x30,
  risr = 0x34,
  txoicr = 0x38,
  rxoicr = 0x3c,
  rxuicr = 0x40,
  msticr = 0x44,
  icr = 0x48,
  dmacr = 0x4c,
  dmatdlr = 0x50,
  dmardlr = 0x54,
  idr = 0x58,
  version = 0x5c,
  dr0 = 0x60,
  dr_end = 0xf0,
  rx_sample_dly = 0xf0,
  spi_ctrlr0 = 0xf4,
  txd_drive_edge = 0xf8,
};
constexpr std::uint32_t control_mask = 0x017f'ffff;
constexpr std::uint32_t spi_control_reset = 0x0300'0000;
constexpr std::uint32_t identification = 0x5153'5049;
constexpr std::uint32_t component_version = 0x3430'312a;

// RISR: transmit FIFO empty and overflow, receive FIFO underflow and overflow.
constexpr std::uint32_t raw_tx_empty = 1, raw_tx_overflow = 2, raw_rx_underflow = 4,
                        raw_rx_overflow = 8;

constexpr std::uint32_t dma_receive = 1, dma_transmit = 2;  // DMACR

// CTRLR0.TMOD
constexpr unsigned both = 0, transmit_only = 1, receive_only = 2, eeprom_read = 3;

std::uint32_t low_bits(std::uint32_t value, unsigned bits) {
  return bits >= 32 ? value : value & ((1u << bits) - 1u);
}

}  // namespace

Ssi::Ssi(TimeWheel& wheel, FlashChip& flash, QspiPins& pins, NotModelled not_modelled,
         std::function<void(bool)> mapped)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      flash_(flash),
      pins_(pins),
      not_modelled_(std::move(not_modelled)),
      mapped_changed_(std::move(mapped)),
      spi_control_(spi_control_reset) {
  pins_.on_change([this] { catch_up(); },
                  [this] {
                    update_select(wheel_.now());
                    update_mapping();
                  });
}

unsigned Ssi::instruction_bits() const {
  return std::array<unsigned, 4>{0, 4, 8, 16}[(spi_control_ >> 8) & 3u];
}

// --- time ---

void Ssi::run(Cycle) { settle(); }

void Ssi::settle() {
  catch_up();
  update_mapping();
  plan();
  report_levels();
}

void Ssi::plan() {
  wheel_.set(slot_, in_frame_ && dma_control_ != 0 ? std::min(end_, look_again_) : look_again_);
}

// DMACR, DMATDLR and DMARDLR (4.10.13): a request while the transmit FIFO holds at most as many
// entries as its level, the receive FIFO more. It is assumed that a request is worth as many
// transfers as the FIFO can take or give. The DMA may access the FIFOs within this call.
void Ssi::report_levels() {
  if (dreqs_ == nullptr) return;
  const bool sends = (dma_control_ & dma_transmit) != 0 && enabled_ && tx_.size() <= dma_tx_level_;
  const bool receives = (dma_control_ & dma_receive) != 0 && rx_.size() > dma_rx_level_;
  dreqs_->set_level(Dreq::xip_ssitx, sends ? static_cast<unsigned>(fifo_depth - tx_.size()) : 0);
  dreqs_->set_level(Dreq::xip_ssirx, receives ? static_cast<unsigned>(rx_.size()) : 0);
}

void Ssi::clock_changed() { catch_up(); }

void Ssi::catch_up() {
  const Cycle now = wheel_.now();
  for (;;) {
    if (in_frame_) {
      if (end_ > now) return;
      finish_frame();
      continue;
    }
    // Frames of one transfer follow each other without a gap; the first begins with the access
    // that made it possible.
    if (!enabled() || !start_frame(stage_ == Stage::idle ? now : end_)) return;
  }
}

bool Ssi::start_frame(Cycle at) {
  const unsigned mode = transfer_mode();
  if (stage_ == Stage::receive) {
    start(Stage::receive, frame_bits(), lanes(), at);
    return true;
  }
  if (stage_ == Stage::wait) {
    if (wait_cycles() == 0) {
      stage_ = Stage::receive;
      return true;
    }
    start(Stage::wait, wait_cycles(), 1, at);
    return true;
  }
  if (tx_.empty()) {
    if (stage_ == Stage::transmit) {
      // Nothing more to send: an EEPROM read continues with its data, any other mode ends.
      if (mode == eeprom_read) {
        stage_ = Stage::receive;
        return true;
      }
      end_transfer();
    }
    return false;
  }
  if (lanes() == 1) {
    if (mode == receive_only && stage_ == Stage::idle) {
      tx_.pop_front();
      left_ = (frames_ & 0xffffu) + 1;
      stage_ = Stage::receive;
      selects_ = true;
      end_ = at;
      update_select(at);
      return true;
    }
    if (stage_ == Stage::idle) left_ = (frames_ & 0xffffu) + 1;
    start(Stage::transmit, frame_bits(), 1, at);
  } else if (stage_ == Stage::idle && instruction_bits() != 0) {
    // Instruction and address must both be there: the chip select would rise between them.
    if (tx_.size() < (address_bits() != 0 ? 2u : 1u)) return false;
    left_ = (frames_ & 0xffffu) + 1;
    start(Stage::instruction, instruction_bits(), instruction_lanes(), at);
  } else if (stage_ == Stage::idle || stage_ == Stage::instruction) {
    left_ = (frames_ & 0xffffu) + 1;
    start(Stage::address, address_bits(), address_lanes(), at);
  } else {
    start(Stage::transmit, frame_bits(), lanes(), at);
  }
  return true;
}

void Ssi::start(Stage stage, unsigned bits, unsigned lanes, Cycle at) {
  if (!selects_) {
    selects_ = true;
    update_select(at);
  }
  stage_ = stage;
  out_ = 0;
  if (stage != Stage::receive && stage != Stage::wait) {
    out_ = tx_.front();
    tx_.pop_front();
  }
  out_bits_ = bits;
  out_lanes_ = lanes;
  end_ = at + static_cast<Cycle>((bits + lanes - 1) / lanes) * divider();
  in_frame_ = true;
}

void Ssi::finish_frame() {
  in_frame_ = false;
  const unsigned mode = transfer_mode();
  const bool receiving = stage_ == Stage::receive || stage_ == Stage::wait;
  const std::uint32_t in = shift(out_, out_bits_, out_lanes_, !receiving || lanes() == 1);
  const bool keep =
      stage_ == Stage::receive || (stage_ == Stage::transmit && mode == both && lanes() == 1);
  if (keep) {
    if (rx_.size() < fifo_depth)
      rx_.push_back(in);
    else
      raw_interrupts_ |= raw_rx_overflow;
  }
  switch (stage_) {
    case Stage::instruction:
      if (address_bits() == 0) stage_ = mode == transmit_only ? Stage::transmit : Stage::wait;
      break;
    case Stage::address:
      stage_ = mode == transmit_only ? Stage::transmit : Stage::wait;
      break;
    case Stage::wait:
      stage_ = Stage::receive;
      break;
    case Stage::receive:
      if (--left_ == 0) end_transfer();
      break;
    default:
      break;
  }
}

void Ssi::end_transfer() {
  stage_ = Stage::idle;
  selects_ = false;
  update_select(end_);
}

// --- the wires ---

std::uint32_t Ssi::shift(std::uint32_t out, unsigned bits, unsigned lanes, bool drive) {
  const Picoseconds now = wheel_.time_of(end_);
  const unsigned driven = !drive ? 0u : lanes == 1 ? 1u : (1u << lanes) - 1u;
  std::uint32_t in = 0;
  for (unsigned done = 0; done < bits; done += lanes) {
    const unsigned shift = bits - done >= lanes ? bits - done - lanes : 0;
    const unsigned levels = low_bits(shift < 32 ? out >> shift : 0, lanes);
    const unsigned answer =
        selected_ ? flash_.clock(pins_.lines(driven, levels), now) : pins_.lines(0, 0);
    const unsigned sampled = lanes == 1 ? (answer >> 1) & 1u : low_bits(answer, lanes);
    in = in << lanes | sampled;
  }
  return low_bits(in, bits);
}

void Ssi::update_select(Cycle at) {
  const OutOver over = pins_.select_override();
  const bool now_selected = over == OutOver::normal   ? selects_
                            : over == OutOver::invert ? !selects_
                                                      : over == OutOver::low;
  if (now_selected == selected_) return;
  selected_ = now_selected;
  const Picoseconds now = wheel_.time_of(at);
  if (selected_)
    flash_.select(now);
  else
    flash_.deselect(now);
}

std::uint64_t Ssi::xip_read(std::uint32_t address) {
  const Picoseconds now = wheel_.time();
  const std::uint32_t command = spi_control_ >> 24;
  const unsigned width = lanes();
  const auto send = [&](std::uint64_t value, unsigned bits, unsigned on) {
    const unsigned driven = on == 1 ? 1u : (1u << on) - 1u;
    for (unsigned done = 0; done < bits; done += on)
      flash_.clock(
          pins_.lines(driven,
                      low_bits(static_cast<std::uint32_t>(value >> (bits - done - on)), on)),
          now);
  };
  flash_.select(now);
  // XIP_CMD goes before the address, or after it when there is no instruction (4.10.13,
  // SPI_CTRLR0).
  if (instruction_bits() != 0) {
    send(command, instruction_bits(), instruction_lanes());
    send(address, address_bits(), address_lanes());
  } else {
    send(std::uint64_t{address} << 8 | command, address_bits(), address_lanes());
  }
  for (unsigned i = 0; i < wait_cycles(); ++i) flash_.clock(pins_.lines(0, 0), now);
  std::uint64_t in = 0;
  for (unsigned done = 0; done < 64; done += width) {
    const unsigned answer = flash_.clock(pins_.lines(0, 0), now);
    in = in << width | (width == 1 ? (answer >> 1) & 1u : low_bits(answer, width));
  }
  flash_.deselect(now);
  return in;
}

void Ssi::update_mapping() {
  const unsigned mode = transfer_mode();
  const bool reads = mode == eeprom_read || (lanes() != 1 && mode == receive_only);
  bool works = enabled() && reads && lanes() <= 4 && frame_bits() == 32 && address_bits() >= 24 &&
               stage_ == Stage::idle && tx_.empty() && pins_.select_override() == OutOver::normal;
  if (works) {
    const Picoseconds now = wheel_.time();
    works = flash_.would_read([this](std::uint32_t address) { return xip_read(address); }, now);
    // Checks again when the flash is no longer busy.
    look_again_ = !works && flash_.busy(now) ? wheel_.cycle_at(flash_.busy_until()) : never_cycle;
    plan();
  }
  if (works == mapped_) return;
  mapped_ = works;
  mapped_changed_(works);
}

std::uint32_t Ssi::transfer_cycles(unsigned data_bits) const {
  const unsigned width = std::max(1u, lanes());
  const std::uint32_t clocks = instruction_bits() / instruction_lanes() +
                               address_bits() / address_lanes() + wait_cycles() + data_bits / width;
  return clocks * divider();
}

// --- registers ---

std::uint32_t Ssi::status() const {
  std::uint32_t value = 0;
  if (in_frame_ || stage_ != Stage::idle) value |= 1u;  // BUSY
  if (tx_.size() < fifo_depth) value |= 1u << 1;        // TFNF
  if (tx_.empty()) value |= 1u << 2;                    // TFE
  if (!rx_.empty()) value |= 1u << 3;                   // RFNE
  if (rx_.size() == fifo_depth) value |= 1u << 4;       // RFF
  return value;
}

std::uint32_t Ssi::peek(std::uint32_t offset) const {
  switch (offset) {
    case ctrlr0:
      return control_;
    case ctrlr1:
      return frames_;
    case ssienr:
      return enabled_ ? 1 : 0;
    case ser:
      return slaves_;
    case baudr:
      return baud_;
    case txftlr:
      return tx_threshold_;
    case rxftlr:
      return rx_threshold_;
    case txflr:
      return static_cast<std::uint32_t>(tx_.size());
    case rxflr:
      return static_cast<std::uint32_t>(rx_.size());
    case sr:
      return status();
    case risr:
      return raw_interrupts_ | (tx_.size() <= tx_threshold_ ? raw_tx_empty : 0u);
    case dmacr:
      return dma_control_;
    case dmatdlr:
      return dma_tx_level_;
    case dmardlr:
      return dma_rx_level_;
    case idr:
      return identification;
    case version:
      return component_version;
    case rx_sample_dly:
      return rx_delay_;
    case spi_ctrlr0:
      return spi_control_;
    case txd_drive_edge:
      return drive_edge_;
    default:
      return 0;
  }
}

std::uint32_t Ssi::read(std::uint32_t offset) {
  catch_up();
  if (offset >= dr0 && offset < dr_end) {
    if (rx_.empty()) {
      raw_interrupts_ |= raw_rx_underflow;
      return 0;
    }
    const std::uint32_t value = rx_.front();
    rx_.pop_front();
    report_levels();
    return value;
  }
  if (offset >= txoicr && offset <= icr) {
    const std::uint32_t clears = offset == txoicr   ? raw_tx_overflow
                                 : offset == rxoicr ? raw_rx_overflow
                                 : offset == rxuicr ? raw_rx_underflow
                                 : offset == icr    ? ~0u
                                                    : 0u;
    const bool any = (raw_interrupts_ & clears) != 0;
    raw_interrupts_ &= ~clears;
    return any ? 1 : 0;
  }
  const bool modelled =
      offset != mwcr && offset != imr && offset != isr && offset <= txd_drive_edge;
  if (!modelled && not_modelled_) not_modelled_("XIP_SSI register that reads as 0");
  return peek(offset);
}

void Ssi::write_data(std::uint32_t value) {
  if (!enabled_) return;  // the FIFOs are held empty
  if (tx_.size() < fifo_depth)
    tx_.push_back(low_bits(value, lanes() == 1 ? frame_bits() : 32));
  else
    raw_interrupts_ |= raw_tx_overflow;
  settle();
}

void Ssi::write(std::uint32_t offset, std::uint32_t value) {
  catch_up();
  if (offset >= dr0 && offset < dr_end) {
    write_data(value);
    return;
  }
  const auto set = [&](std::uint32_t& field, std::uint32_t mask) {
    // Control registers cannot be written while the SSI is enabled (4.10.13).
    if (enabled_ && not_modelled_) not_modelled_("XIP_SSI setting written while enabled: ignored");
    if (!enabled_) field = value & mask;
  };
  switch (offset) {
    case ctrlr0:
      set(control_, control_mask);
      if ((value >> 21 & 3u) == 3 && not_modelled_) not_modelled_("XIP_SSI SPI_FRF 3");
      break;
    case ctrlr1:
      set(frames_, 0xffff);
      break;
    case ssienr:
      if ((value & 1u) == 0) clear();
      enabled_ = (value & 1u) != 0;
      break;
    case ser:
      slaves_ = value & 1u;
      break;
    case baudr:
      set(baud_, 0xffff);
      break;
    case txftlr:
      tx_threshold_ = value & 0xffu;
      break;
    case rxftlr:
      rx_threshold_ = value & 0xffu;
      break;
    case rx_sample_dly:
      set(rx_delay_, 0xff);
      break;
    case spi_ctrlr0:
      set(spi_control_, 0xff07'fb3f);
      if ((value & 0x0007'0000u) != 0 && not_modelled_) not_modelled_("XIP_SSI double data rate");
      break;
    case txd_drive_edge:
      drive_edge_ = value & 0xffu;
      break;
    case imr:
      if (value != 0 && not_modelled_) not_modelled_("XIP_SSI interrupts");
      break;
    case dmacr:
      dma_control_ = value & (dma_receive | dma_transmit);
      break;
    case dmatdlr:
      dma_tx_level_ = value & 0xffu;
      break;
    case dmardlr:
      dma_rx_level_ = value & 0xffu;
      break;
    case mwcr:
      if (value != 0 && not_modelled_) not_modelled_("XIP_SSI MWCR");
      break;
    default:
      break;
  }
  settle();
}

void Ssi::clear() {
  // Disabling stops the present transfer and empties the FIFOs.
  tx_.clear();
  rx_.clear();
  in_frame_ = false;
  end_ = wheel_.now();
  if (stage_ != Stage::idle || selects_) end_transfer();
}

void Ssi::reset() {
  catch_up();
  clear();
  enabled_ = false;
  control_ = frames_ = slaves_ = baud_ = 0;
  spi_control_ = spi_control_reset;
  tx_threshold_ = rx_threshold_ = rx_delay_ = drive_edge_ = raw_interrupts_ = 0;
  dma_control_ = dma_tx_level_ = dma_rx_level_ = 0;
  settle();
}

void Ssi::power_cut() {
  catch_up();
  flash_.power_cut(wheel_.time());
  selected_ = false;
  selects_ = false;
  stage_ = Stage::idle;
  in_frame_ = false;
  reset();
}

}  // namespace lamplock::sim::chip
