// A bad cable between a sender and a machine, in simulated time: bytes are lost, flipped, doubled,
// delayed, invented, and the cable is cut and plugged in again.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <random>
#include <span>
#include <vector>

#include "host/link/transport.hpp"

namespace lamplock::test {

/// Faults, each as a probability per byte.
struct Faults {
  double drop = 0;
  double flip = 0;
  double duplicate = 0;
  double replay = 0;          ///< per piece written: the whole piece arrives twice
  double stray_realtime = 0;  ///< towards the machine only
  bool resets = true;         ///< 0x18 may result, which ends a job of rows
  int cuts = 0;               ///< over the first `cut_span`
  std::chrono::microseconds cut_span{1'000'000};
  std::chrono::microseconds delay{300};
};

/// Transport with faults; a derived class is the machine at the other end.
class BadCable : public link::Transport {
 public:
  using Time = std::chrono::microseconds;

  BadCable(Faults faults, std::uint64_t seed) : faults_(faults), random_(seed) {
    std::uniform_int_distribution<Time::rep> when(0, faults.cut_span.count());
    for (int i = 0; i < faults.cuts; ++i) cuts_.emplace_back(when(random_));
    std::sort(cuts_.begin(), cuts_.end());
  }

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (!connected_) return 0;
    const std::size_t room = silent ? bytes.size() : std::min<std::size_t>(bytes.size(), 700);
    if (silent) return room;
    for (int times = chance(faults_.replay) ? 2 : 1; times > 0; --times)
      for (const std::uint8_t byte : bytes.first(room)) damage(byte, to_machine_, true);
    return room;
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    std::size_t count = 0;
    while (count < bytes.size() && !to_host_.empty() && to_host_.front().at <= now_) {
      bytes[count++] = to_host_.front().byte;
      to_host_.pop_front();
    }
    return count;
  }
  void wait(Time time) override {
    const Time until = now_ + time;
    while (now_ < until && (to_host_.empty() || to_host_.front().at > now_)) advance();
  }
  Time now() const override { return now_; }
  bool connected() const override { return connected_; }
  bool reconnect() override {
    to_machine_.clear();
    to_host_.clear();
    // Every third attempt finds the cable plugged in again.
    connected_ = !unplugged && ++attempts_ % 3 == 0;
    if (connected_) machine_reconnected();
    return connected_;
  }

  bool silent = false;     ///< nothing arrives at the machine
  bool unplugged = false;  ///< the cable stays unplugged
  int cuts_made() const { return cuts_made_; }
  int faults_made() const { return faults_made_ + cuts_made_; }

 protected:
  /// Accepts bytes that have arrived.
  virtual void machine_receive(std::span<const std::uint8_t> bytes) = 0;
  /// Called when the connection is a new one.
  virtual void machine_reconnected() = 0;
  /// Runs the machine until now().
  virtual void machine_run() = 0;
  /// Writes the machine's output; returns the number of bytes.
  virtual std::size_t machine_transmit(std::span<std::uint8_t> bytes) = 0;

 private:
  struct Byte {
    std::uint8_t byte;
    Time at;
  };

  static constexpr std::uint8_t reset = 0x18;

  bool chance(double p) {
    const bool happens = p > 0 && std::uniform_real_distribution<>(0, 1)(random_) < p;
    faults_made_ += happens ? 1 : 0;
    return happens;
  }

  void damage(std::uint8_t byte, std::deque<Byte>& line, bool towards_machine) {
    const Time at = now_ + faults_.delay;
    if (chance(faults_.drop)) return;
    if (chance(faults_.flip)) {
      const int bit = std::uniform_int_distribution<>(0, 7)(random_);
      byte = static_cast<std::uint8_t>(byte ^ (1u << bit));
      if (towards_machine && byte == reset && !faults_.resets) return;
    }
    line.push_back({byte, at});
    if (chance(faults_.duplicate)) line.push_back({byte, at});
    if (towards_machine && chance(faults_.stray_realtime)) {
      constexpr std::array<std::uint8_t, 5> strays{'!', '?', '~', 0x90, reset};
      const std::size_t last = faults_.resets ? 4 : 3;
      line.push_back({strays[std::uniform_int_distribution<std::size_t>(0, last)(random_)], at});
    }
  }

  /// One step of time: bytes arrive, the machine works, answers leave.
  void advance() {
    constexpr Time step{250};
    now_ += step;
    if (!cuts_.empty() && now_ >= cuts_.front()) {
      cuts_.erase(cuts_.begin());
      cut();
    }
    std::array<std::uint8_t, 64> piece{};
    std::size_t count = 0;
    while (count < piece.size() && !to_machine_.empty() && to_machine_.front().at <= now_) {
      piece[count++] = to_machine_.front().byte;
      to_machine_.pop_front();
    }
    if (count > 0) machine_receive(std::span<const std::uint8_t>(piece).first(count));
    machine_run();
    const std::size_t sent = machine_transmit(piece);
    if (connected_)
      for (std::size_t i = 0; i < sent; ++i) damage(piece[i], to_host_, false);
  }

  void cut() {
    ++cuts_made_;
    connected_ = false;
    to_machine_.clear();
    to_host_.clear();
  }

  Faults faults_;
  std::mt19937_64 random_;
  std::deque<Byte> to_machine_;
  std::deque<Byte> to_host_;
  std::vector<Time> cuts_;
  Time now_{0};
  bool connected_ = true;
  int attempts_ = 0;
  int cuts_made_ = 0;
  int faults_made_ = 0;
};

}  // namespace lamplock::test
