#include "sim/chip/sio/sio.hpp"

#include <utility>

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t all_pins = (1u << gpio_count) - 1;
constexpr std::uint32_t qspi_pins = 0x3f;

// Offsets (2.3.1.7).
constexpr std::uint32_t offset_cpuid = 0x00;
constexpr std::uint32_t offset_gpio_in = 0x04;
constexpr std::uint32_t offset_gpio_hi_in = 0x08;
constexpr std::uint32_t offset_gpio_out = 0x10;  // then SET, CLR, XOR
constexpr std::uint32_t offset_gpio_oe = 0x20;
constexpr std::uint32_t offset_gpio_hi_out = 0x30;
constexpr std::uint32_t offset_gpio_hi_oe = 0x40;
constexpr std::uint32_t offset_fifo_st = 0x50;
constexpr std::uint32_t offset_fifo_wr = 0x54;
constexpr std::uint32_t offset_fifo_rd = 0x58;
constexpr std::uint32_t offset_spinlock_st = 0x5c;
constexpr std::uint32_t offset_div = 0x60;
constexpr std::uint32_t offset_div_quotient = 0x70;
constexpr std::uint32_t offset_div_remainder = 0x74;
constexpr std::uint32_t offset_div_csr = 0x78;
constexpr std::uint32_t offset_interp0 = 0x80;
constexpr std::uint32_t offset_interp1 = 0xc0;
constexpr std::uint32_t offset_spinlock0 = 0x100;
constexpr std::uint32_t end = 0x180;

// FIFO_ST: VLD 0, RDY 1, WOF 2, ROE 3; the last two are cleared by a write.
constexpr std::uint32_t fifo_valid = 1u << 0;
constexpr std::uint32_t fifo_ready = 1u << 1;
constexpr std::uint32_t fifo_wof = 1u << 2;
constexpr std::uint32_t fifo_roe = 1u << 3;

/// A group of four registers: value, set, clear, toggle.
void modify(std::uint32_t& word, std::uint32_t offset, std::uint32_t value, std::uint32_t mask) {
  switch (offset & 0xcu) {
    case 0x0:
      word = value;
      break;
    case 0x4:
      word |= value;
      break;
    case 0x8:
      word &= ~value;
      break;
    default:
      word ^= value;
      break;
  }
  word &= mask;
}

}  // namespace

Sio::Sio(TimeWheel& wheel, Gpio& gpio, IrqLines& irqs, QspiInputs qspi_inputs,
         NotModelled not_modelled)
    : wheel_(wheel),
      gpio_(gpio),
      irqs_(irqs),
      qspi_inputs_(std::move(qspi_inputs)),
      not_modelled_(std::move(not_modelled)) {}

void Sio::reset() {
  own_ = {};
  out_ = enable_ = qspi_out_ = qspi_enable_ = locks_ = 0;
  gpio_.drive(PinFunction::sio, 0, 0, wheel_.now());
  update_irqs();
}

std::uint32_t Sio::gpio_in() const {
  const Cycle now = wheel_.now();
  const std::uint32_t late = gpio_.inputs_at(now < pin_synchroniser ? 0 : now - pin_synchroniser);
  return (late & ~synchroniser_bypass_) | (gpio_.inputs() & synchroniser_bypass_);
}

std::uint32_t Sio::fifo_status(std::size_t core) const {
  const Own& own = own_[core];
  return (own.inbox.empty() ? 0u : fifo_valid) |
         (own_[1 - core].inbox.size() < fifo_depth ? fifo_ready : 0u) |
         (own.write_on_full ? fifo_wof : 0u) | (own.read_on_empty ? fifo_roe : 0u);
}

void Sio::update_irqs() {
  constexpr std::uint32_t causes = fifo_valid | fifo_wof | fifo_roe;
  irqs_.set(Irq::sio_proc0, (fifo_status(0) & causes) != 0);
  irqs_.set(Irq::sio_proc1, (fifo_status(1) & causes) != 0);
}

std::uint32_t Sio::peek(std::size_t core, std::uint32_t offset) const {
  const Own& own = own_[core];
  if (offset >= offset_spinlock0 && offset < end)
    return locks_ & 1u << ((offset - offset_spinlock0) / 4);
  if (offset >= offset_interp1 && offset < offset_spinlock0)
    return own.interpolator1.peek(offset - offset_interp1);
  if (offset >= offset_interp0 && offset < offset_interp1)
    return own.interpolator0.peek(offset - offset_interp0);
  switch (offset) {
    case offset_cpuid:
      return static_cast<std::uint32_t>(core);
    case offset_gpio_in:
      gpio_.catch_up(wheel_.now());
      return gpio_in();
    case offset_gpio_hi_in:
      return qspi_inputs_() & qspi_pins;
    case offset_gpio_out:
      return out_;
    case offset_gpio_oe:
      return enable_;
    case offset_gpio_hi_out:
      return qspi_out_;
    case offset_gpio_hi_oe:
      return qspi_enable_;
    case offset_fifo_st:
      return fifo_status(core);
    case offset_fifo_rd:
      return own.inbox.empty() ? 0 : own.inbox.front();
    case offset_spinlock_st:
      return locks_;
    case offset_div:
    case offset_div + 8:
      return own.divider.dividend();
    case offset_div + 4:
    case offset_div + 12:
      return own.divider.divisor();
    case offset_div_quotient:
      return own.divider.quotient();
    case offset_div_remainder:
      return own.divider.remainder();
    case offset_div_csr:
      return (own.divider.dirty() ? 2u : 0u) | (own.divider.ready(time_of(core)) ? 1u : 0u);
    default:
      return 0;  // the set, clear and toggle registers and FIFO_WR are write only
  }
}

std::uint32_t Sio::read(std::size_t core, std::uint32_t offset) {
  Own& own = own_[core];
  if (offset >= offset_div && offset < offset_interp0) return read_divider(core, offset);
  if (offset >= offset_interp1 && offset < offset_spinlock0)
    return own.interpolator1.read(offset - offset_interp1);
  if (offset >= offset_interp0 && offset < offset_interp1)
    return own.interpolator0.read(offset - offset_interp0);
  if (offset >= offset_spinlock0 && offset < end) {  // claims a free lock
    const std::uint32_t lock = 1u << ((offset - offset_spinlock0) / 4);
    const std::uint32_t claimed = ~locks_ & lock;
    locks_ |= lock;
    return claimed;
  }
  if (offset >= end) not_modelled_("SIO: no register at this offset");
  const std::uint32_t value = peek(core, offset);
  if (offset == offset_fifo_rd) {
    if (own.inbox.empty())
      own.read_on_empty = true;
    else
      own.inbox.pop_front();
    update_irqs();
  }
  return value;
}

std::uint32_t Sio::read_divider(std::size_t core, std::uint32_t offset) {
  Divider& divider = own_[core].divider;
  const bool is_result = offset == offset_div_quotient || offset == offset_div_remainder;
  if (is_result && !divider.ready(time_of(core)))
    not_modelled_("SIO DIV: a result was read before READY; it is undefined in the chip");
  if (offset == offset_div_quotient) divider.clear_dirty();
  return peek(core, offset);
}

void Sio::write_divider(Own& own, std::uint32_t offset, std::uint32_t value, Cycle at) {
  switch (offset) {
    case offset_div:
      own.divider.write_dividend(value, false, at);
      break;
    case offset_div + 4:
      own.divider.write_divisor(value, false, at);
      break;
    case offset_div + 8:
      own.divider.write_dividend(value, true, at);
      break;
    case offset_div + 12:
      own.divider.write_divisor(value, true, at);
      break;
    case offset_div_quotient:
      own.divider.write_quotient(value, at);
      break;
    case offset_div_remainder:
      own.divider.write_remainder(value, at);
      break;
    default:
      break;  // CSR is read only
  }
}

void Sio::write_fifo(std::size_t core, std::uint32_t offset, std::uint32_t value) {
  Own& own = own_[core];
  Own& other = own_[1 - core];
  if (offset == offset_fifo_st) {
    own.write_on_full = own.write_on_full && (value & fifo_wof) == 0;
    own.read_on_empty = own.read_on_empty && (value & fifo_roe) == 0;
  } else if (offset == offset_fifo_wr) {
    if (other.inbox.size() < fifo_depth)
      other.inbox.push_back(value);
    else
      own.write_on_full = true;
  }
  update_irqs();
}

void Sio::write(std::size_t core, std::uint32_t offset, std::uint32_t value) {
  const Cycle now = wheel_.now();
  Own& own = own_[core];
  if (offset >= end) {
    not_modelled_("SIO: no register at this offset");
  } else if (offset >= offset_spinlock0) {
    locks_ &= ~(1u << ((offset - offset_spinlock0) / 4));
  } else if (offset >= offset_interp1) {
    own.interpolator1.write(offset - offset_interp1, value);
  } else if (offset >= offset_interp0) {
    own.interpolator0.write(offset - offset_interp0, value);
  } else if (offset >= offset_div) {
    write_divider(own, offset, value, time_of(core));
  } else if (offset >= offset_fifo_st) {
    write_fifo(core, offset, value);
  } else if (offset >= offset_gpio_hi_oe) {
    modify(qspi_enable_, offset, value, qspi_pins);
    if (qspi_enable_ != 0) not_modelled_("SIO GPIO_HI_OE: QSPI pins driven by software");
  } else if (offset >= offset_gpio_hi_out) {
    modify(qspi_out_, offset, value, qspi_pins);
  } else if (offset >= offset_gpio_out) {
    modify(offset >= offset_gpio_oe ? enable_ : out_, offset, value, all_pins);
    gpio_.drive(PinFunction::sio, out_, enable_, now);
  }
}

}  // namespace lamplock::sim::chip
