#include "host/feed_optimiser/jerk_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"

namespace lamplock::feed_optimiser {
namespace {

/// A law that grows so slowly that it is tabulated no further has a constant jerk from there on.
constexpr std::size_t max_table = 100'000;

void require_number(const char* option, double value, double min) {
  if (std::isfinite(value) && value >= min) return;
  throw Error(Exit::bad_input, option,
              fmt::format("{} is not a finite number from {} on", value, min),
              "choose such a number");
}

}  // namespace

double jerk_at(const JerkLaw& law, std::size_t i) {
  const auto steps = static_cast<double>(i);
  return std::pow(law.n + law.step_a * steps, law.k + law.step_b * steps);
}

void require_law(const JerkLaw& law) {
  require_number("n", law.n, 1);
  require_number("k", law.k, 0);
  require_number("step of a", law.step_a, 0);
  require_number("step of b", law.step_b, 0);
  if (!std::isfinite(jerk_at(law, 0)))
    throw Error(Exit::bad_input, "jerk law",
                fmt::format("n^k is too large to compute: {:g}^{:g}", law.n, law.k),
                "choose a smaller n or k");
}

LawTable::LawTable(const JerkLaw& law, double max_jerk, double period_s)
    : law_(law), period_s_(period_s), h_(period_s * period_s * period_s), accel_{0}, accel_sum_{0} {
  for (std::size_t i = 0; i < max_table; ++i) {
    const double jerk = jerk_at(law, i);
    jerk_.push_back(std::min(jerk, max_jerk));
    accel_.push_back(accel_.back() + jerk_.back() * h_);
    accel_sum_.push_back(accel_sum_.back() + accel_.back());
    if (jerk >= max_jerk || (law.step_a == 0 && law.step_b == 0)) break;
  }
}

JerkRamp::JerkRamp(const LawTable& table, double cap)
    : table_(table),
      cap_(std::min(cap, table.jerk_.back())),
      capped_(static_cast<std::size_t>(
          std::lower_bound(table.jerk_.begin(), table.jerk_.end(), cap_) - table.jerk_.begin())) {}

double JerkRamp::jerk(std::size_t i) const { return i < capped_ ? table_.jerk_[i] : cap_; }

double JerkRamp::accel(std::size_t m) const {
  if (m <= capped_) return table_.accel_[m];
  return table_.accel_[capped_] + static_cast<double>(m - capped_) * cap_ * table_.h_;
}

double JerkRamp::accel_sum(std::size_t m) const {
  if (m <= capped_) return table_.accel_sum_[m];
  const auto more = static_cast<double>(m - capped_);
  return table_.accel_sum_[capped_] + more * table_.accel_[capped_] +
         more * (more + 1) / 2 * cap_ * table_.h_;
}

}  // namespace lamplock::feed_optimiser
