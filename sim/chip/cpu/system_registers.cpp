// The private peripheral bus: NVIC, System Control Block, SysTick (ARMv6-M Architecture Reference
// Manual, B3; RP2040 datasheet, 2.4.8).
#include "sim/chip/cpu/core.hpp"
#include "sim/chip/fabric/hex.hpp"

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t scs_base = 0xe000'e000;
constexpr std::uint32_t scs_size = 0x1000;
constexpr std::uint32_t ppb_end = 0xe010'0000;

constexpr std::uint32_t actlr = 0x008;
constexpr std::uint32_t syst_csr = 0x010, syst_rvr = 0x014, syst_cvr = 0x018, syst_calib = 0x01c;
constexpr std::uint32_t nvic_iser = 0x100, nvic_icer = 0x180, nvic_ispr = 0x200, nvic_icpr = 0x280;
constexpr std::uint32_t nvic_ipr = 0x400, nvic_ipr_end = 0x420;
constexpr std::uint32_t cpuid = 0xd00, icsr = 0xd04, vector_table = 0xd08, aircr = 0xd0c,
                        scr = 0xd10, ccr = 0xd14, shpr2 = 0xd1c, shpr3 = 0xd20, shcsr = 0xd24;
constexpr std::uint32_t mpu_type = 0xd90, mpu_ctrl = 0xd94, mpu_end = 0xda4;

constexpr std::uint32_t cpuid_value = 0x410c'c601;          // Cortex-M0+ r0p1
constexpr std::uint32_t ccr_value = (1u << 9) | (1u << 3);  // STKALIGN, UNALIGN_TRP
constexpr std::uint32_t mpu_type_value = 8u << 8;           // eight regions
constexpr std::uint32_t aircr_key = 0x05fa'0000, aircr_read = 0xfa05'0000;
constexpr std::uint32_t aircr_reset_request = 1u << 2;
constexpr std::uint32_t shcsr_svcall_pended = 1u << 15;

constexpr unsigned svcall = number_of(Exception::svcall), pendsv = number_of(Exception::pendsv),
                   tick = number_of(Exception::systick), nmi = number_of(Exception::nmi);

// Priorities sit in the top two bits of their byte.
std::uint32_t priority_byte(int priority, unsigned byte) {
  return static_cast<std::uint32_t>(priority) << (8 * byte + 6);
}
unsigned priority_of(std::uint32_t value, unsigned byte) { return (value >> (8 * byte + 6)) & 3; }

}  // namespace

void Core::report(std::uint32_t address) {
  if (not_modelled_) not_modelled_("PPB register at " + hex(address));
}

// False: a fault (no register, or not accessible to unprivileged code).
bool Core::read_system(std::uint32_t address, std::uint32_t& value) {
  if (!privileged() || address >= ppb_end) return false;
  run_events(cycle_);
  const std::uint32_t offset = address - scs_base;
  const std::optional<std::uint32_t> there =
      offset == syst_csr ? systick_.read_control(cycle_) : system_register(offset, cycle_);
  if (!there) report(address);
  value = there.value_or(0);
  return true;
}

std::optional<std::uint32_t> Core::peek_system(std::uint32_t address) {
  if (address - scs_base >= scs_size) return std::nullopt;
  return system_register(address - scs_base, wheel_.now()).value_or(0);
}

// A register's value at `at`; empty if there is none.
std::optional<std::uint32_t> Core::system_register(std::uint32_t offset, Cycle at) {
  if (offset >= nvic_ipr && offset < nvic_ipr_end) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4; ++i)
      value |= priority_byte(nvic_.priority(16 + offset - nvic_ipr + i), i);
    return value;
  }
  switch (offset) {
    case actlr:
    case syst_calib:
      return 0;
    case syst_csr:
      return systick_.peek_control();
    case syst_rvr:
      return systick_.reload();
    case syst_cvr:
      return systick_.read_current(at);
    case nvic_iser:
    case nvic_icer:
      return nvic_.enabled_lines();
    case nvic_ispr:
    case nvic_icpr:
      return nvic_.pending_lines();
    case cpuid:
      return cpuid_value;
    case icsr:
      return read_icsr();
    case vector_table:
      return vtor_;
    case aircr:
      return aircr_read;
    case scr:
      return scr_;
    case ccr:
      return ccr_value;
    case shpr2:
      return priority_byte(nvic_.priority(svcall), 3);
    case shpr3:
      return priority_byte(nvic_.priority(pendsv), 2) | priority_byte(nvic_.priority(tick), 3);
    case shcsr:
      return nvic_.pending(svcall) ? shcsr_svcall_pended : 0;
    case mpu_type:
      return mpu_type_value;
    default:
      break;
  }
  if (offset >= mpu_ctrl && offset < mpu_end) return mpu_.read(offset - mpu_ctrl);
  return std::nullopt;
}

void Core::set_scr(std::uint32_t value) {
  scr_ = value & (scr_sleep_on_exit | scr_sleep_deep | scr_sev_on_pend);
}

bool Core::write_system(std::uint32_t address, std::uint32_t value) {
  if (!privileged() || address >= ppb_end) return false;
  run_events(cycle_);
  const std::uint32_t offset = address - scs_base;
  if (offset < scs_size && write_nvic(offset, value)) {
    refresh(never_cycle);
    return true;
  }
  switch (offset) {
    case syst_csr:
      systick_.write_control(value, cycle_);
      if ((value & 1) != 0 && systick_.uses_reference() && !systick_.reference_runs() &&
          not_modelled_)
        not_modelled_("SysTick on its reference clock, which has stopped");
      break;
    case syst_rvr:
      systick_.write_reload(value, cycle_);
      break;
    case syst_cvr:
      systick_.clear_current(cycle_);
      break;
    case actlr:
    case cpuid:
    case ccr:
    case mpu_type:
    case syst_calib:
      break;  // read-only
    case icsr:
      write_icsr(value);
      break;
    case vector_table:
      set_vtor(value);
      break;
    case aircr:
      if ((value & 0xffff'0000) == aircr_key && (value & aircr_reset_request) != 0 &&
          on_reset_request)
        on_reset_request();
      break;
    case scr:
      set_scr(value);
      break;
    case shpr2:
      nvic_.set_priority(svcall, priority_of(value, 3));
      break;
    case shpr3:
      nvic_.set_priority(pendsv, priority_of(value, 2));
      nvic_.set_priority(tick, priority_of(value, 3));
      break;
    case shcsr:
      (value & shcsr_svcall_pended) != 0 ? nvic_.pend(svcall) : nvic_.unpend(svcall);
      break;
    default:
      if (offset >= mpu_ctrl && offset < mpu_end)
        write_mpu(offset - mpu_ctrl, value);
      else
        report(address);
      break;
  }
  refresh(never_cycle);
  return true;
}

// With the MPU on every access is checked.
void Core::write_mpu(std::uint32_t offset, std::uint32_t value) {
  mpu_.write(offset, value);
  unchecked_end_ = mpu_.enabled() ? 0 : ppb_base;
  forget_code();
}

bool Core::write_nvic(std::uint32_t offset, std::uint32_t value) {
  if (offset >= nvic_ipr && offset < nvic_ipr_end) {
    for (unsigned i = 0; i < 4; ++i)
      nvic_.set_priority(16 + (offset - nvic_ipr) + i, priority_of(value, i));
    return true;
  }
  switch (offset) {
    case nvic_iser:
      nvic_.enable_lines(value);
      return true;
    case nvic_icer:
      nvic_.disable_lines(value);
      return true;
    case nvic_ispr:
      nvic_.pend_lines(value);
      if (value != 0 && (scr_ & scr_sev_on_pend) != 0) event_ = true;
      return true;
    case nvic_icpr:
      nvic_.unpend_lines(value);
      return true;
    default:
      return false;
  }
}

std::uint32_t Core::read_icsr() const {
  const auto flag = [](bool set, unsigned bit) { return set ? 1u << bit : 0u; };
  return flag(nvic_.pending(nmi), 31) | flag(nvic_.pending(pendsv), 28) |
         flag(nvic_.pending(tick), 26) | flag(nvic_.any_line_pending(), 22) | (nvic_.best() << 12) |
         ipsr_;
}

void Core::write_icsr(std::uint32_t value) {
  if ((value & (1u << 31)) != 0) nvic_.pend(nmi);
  if ((value & (1u << 28)) != 0) nvic_.pend(pendsv);
  if ((value & (1u << 27)) != 0) nvic_.unpend(pendsv);
  if ((value & (1u << 26)) != 0) nvic_.pend(tick);
  if ((value & (1u << 25)) != 0) nvic_.unpend(tick);
}

}  // namespace lamplock::sim::chip
