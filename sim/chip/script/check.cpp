#include "sim/chip/script/check.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace lamplock::sim::chip::script {
namespace {

using State = CheckResult::State;

/// Interval of polls in a window, so that its edges need not all be kept.
constexpr Picoseconds window_interval = ps_per_ms;
/// Maximum number of a port's bytes that are shown.
constexpr std::size_t shown_bytes = 60;

Cycle later(const TimeWheel& wheel, Cycle now, Picoseconds interval) {
  return std::max(now + 1, wheel.cycle_at(wheel.time_of(now) + interval));
}

const char* word(EdgeKind kind) {
  switch (kind) {
    case EdgeKind::rise:
      return " rise";
    case EdgeKind::fall:
      return " fall";
    case EdgeKind::any:
      break;
  }
  return " edge";
}

std::string name(unsigned gpio) { return "gpio" + std::to_string(gpio); }
std::string name(PinEdge edge) { return name(edge.gpio) + word(edge.kind); }
const char* level_word(bool level) { return level ? "high" : "low"; }

std::string printable(std::string_view bytes) {
  std::string text = "\"";
  for (const char each : bytes) {
    const auto byte = static_cast<unsigned char>(each);
    if (each == '\r') {
      text += "\\r";
    } else if (each == '\n') {
      text += "\\n";
    } else if (byte < ' ' || byte > '~') {
      std::array<char, 8> hex{};
      std::snprintf(hex.data(), hex.size(), "\\x%02x", byte);
      text += hex.data();
    } else {
      text += each;
    }
  }
  return text + '"';
}

/// The beginning of what came instead of a text: there it first differs from what was expected.
std::string shown(std::string_view heard) {
  if (heard.empty()) return "nothing";
  const std::string head = printable(heard.substr(0, shown_bytes));
  if (heard.size() <= shown_bytes) return head;
  return head + " and " + std::to_string(heard.size() - shown_bytes) + " more bytes";
}

/// An event must come within a time.
class WithinCheck : public Check {
 public:
  WithinCheck(const Scene& scene, const Moment& start, Span limit)
      : scene_(scene), start_(start), end_(after(scene.wheel(), start, limit)), limit_(limit) {}
  Cycle due(Cycle now) const override {
    const Cycle end = cycle_after(scene_.wheel(), start_, limit_) + settle_cycles;
    return std::max(now + 1, std::min(later(scene_.wheel(), now, poll_interval), end));
  }
  Cycle needs_from() const override { return start_.cycle; }

 protected:
  bool over(Cycle now) const {
    return now >= cycle_after(scene_.wheel(), start_, limit_) + settle_cycles;
  }
  CheckResult nothing(std::string seen) const { return {State::failed, end_, std::move(seen)}; }

  Scene scene_;
  Moment start_, end_;
  Span limit_;
};

class EdgeCheck final : public WithinCheck {
 public:
  EdgeCheck(const ExpectEdge& what, const Scene& scene, const Moment& start)
      : WithinCheck(scene, start, what.limit), edge_(what.edge) {}
  CheckResult poll(Cycle now) override {
    const PadLog& pads = scene_.pads;
    for (std::size_t i = pads.first_after(edge_.gpio, start_.cycle); i < pads.end(edge_.gpio);
         ++i) {
      const PadEdge& edge = pads.edge(edge_.gpio, i);
      if (!edge.is(edge_.kind)) continue;
      if (excess(start_, edge.at, limit_) > 0) break;
      return {State::met, edge.at, {}};
    }
    if (!over(now)) return {};
    const bool level = pads.level_before(edge_.gpio, pads.end(edge_.gpio));
    return nothing(std::string("none, the pin is ") + level_word(level));
  }

 private:
  PinEdge edge_;
};

class PortCheck final : public WithinCheck {
 public:
  using WithinCheck::WithinCheck;
  CheckResult poll(Cycle now) override {
    if (scene_.ports.ready(Port::usb)) {
      const Moment at = moment_of(scene_.wheel(), now);
      return {State::met, at.cycle > start_.cycle ? at : start_, {}};
    }
    return over(now) ? nothing("no serial port on the USB") : CheckResult{};
  }
};

class TextCheck final : public WithinCheck {
 public:
  TextCheck(ExpectText what, const Scene& scene, const Moment& start)
      : WithinCheck(scene, start, what.limit), what_(std::move(what)) {}
  CheckResult poll(Cycle now) override {
    const std::uint64_t count = scene_.ports.count(what_.port);
    if (std::exchange(looked_through_, count) != count) {
      const std::optional<Moment> found = scene_.ports.find(what_.port, what_.text);
      if (found && excess(start_, *found, limit_) <= 0)
        return {State::met, found->cycle > start_.cycle ? *found : start_, {}};
      if (found)
        return nothing("it came " + distance_text(start_, *found) + " after the step began");
    }
    if (!over(now)) return {};
    return nothing(shown(scene_.ports.unused(what_.port)));
  }

 private:
  ExpectText what_;
  std::uint64_t looked_through_ = static_cast<std::uint64_t>(-1);
};

class ReactionCheck final : public Check {
 public:
  ReactionCheck(const ExpectReaction& what, const Scene& scene, const Moment& start)
      : what_(what), scene_(scene), from_(start.cycle) {
    if (const auto last = scene.pads.last(what.cause, start.cycle)) found_cause(*last);
    next_ = scene.pads.first_after(what.cause.gpio, start.cycle);
  }
  CheckResult poll(Cycle now) override {
    const unsigned gpio = what_.cause.gpio;
    if (next_ < scene_.pads.begin(gpio))
      return {State::failed, moment_of(scene_.wheel(), now),
              "too many edges of " + name(gpio) + " to remember"};
    for (;;) {
      if (!cause_ && !find_cause()) {
        from_ = now;
        return {};
      }
      CheckResult result = judge(now);
      if (result.state != State::met) return result;
      if (--what_.times == 0) return result;
      from_ = cause_->cycle;
      cause_.reset();
    }
  }
  Cycle due(Cycle now) const override { return later(scene_.wheel(), now, poll_interval); }
  Cycle needs_from() const override { return cause_ ? cause_->cycle : from_; }

 private:
  void found_cause(const PadEdge& edge) { cause_ = edge.at; }
  bool find_cause() {
    const PadLog& pads = scene_.pads;
    for (; next_ < pads.end(what_.cause.gpio); ++next_) {
      const PadEdge& edge = pads.edge(what_.cause.gpio, next_);
      if (!edge.is(what_.cause.kind)) continue;
      found_cause(edge);
      ++next_;
      return true;
    }
    return false;
  }
  /// The first edge after the cause, if it has come or is too late.
  CheckResult judge(Cycle now) const {
    const PadLog& pads = scene_.pads;
    const unsigned gpio = what_.edge.gpio;
    const std::string after_cause =
        " after " + name(what_.cause) + " at " + time_text(cause_->time);
    if (pads.forgotten_after(gpio, cause_->cycle))
      return {State::failed, *cause_,
              "too many edges of " + name(gpio) + " to remember" + after_cause};
    std::size_t i = pads.first_after(gpio, cause_->cycle);
    while (i < pads.end(gpio) && !pads.edge(gpio, i).is(what_.edge.kind)) ++i;
    if (i < pads.end(gpio)) {
      const Moment at = pads.edge(gpio, i).at;
      if (excess(*cause_, at, what_.least) >= 0 && excess(*cause_, at, what_.most) <= 0)
        return {State::met, at, {}};
      return {State::failed, at, name(what_.edge) + ' ' + distance_text(*cause_, at) + after_cause};
    }
    if (now < cycle_after(scene_.wheel(), *cause_, what_.most) + settle_cycles) return {};
    return {State::failed, after(scene_.wheel(), *cause_, what_.most), "none" + after_cause};
  }

  ExpectReaction what_;
  Scene scene_;
  Cycle from_;
  std::size_t next_ = 0;         ///< edge of the cause's pin
  std::optional<Moment> cause_;  ///< the cause being judged
};

/// Events are counted over a time.
class WindowCheck : public Check {
 public:
  WindowCheck(unsigned gpio, const Scene& scene, const Moment& start, Span window)
      : scene_(scene),
        gpio_(gpio),
        start_(start),
        window_(window),
        next_(scene.pads.first_after(gpio, start.cycle)) {}

  CheckResult poll(Cycle now) override {
    const PadLog& pads = scene_.pads;
    for (; next_ < pads.end(gpio_); ++next_) {
      const PadEdge& edge = pads.edge(gpio_, next_);
      if (excess(start_, edge.at, window_) > 0) break;
      count(edge);
    }
    needs_ = next_ < pads.end(gpio_) ? pads.edge(gpio_, next_).at.cycle : now;
    CheckResult result = early();
    if (result.state == State::open && now >= last_look())
      result = judge(after(scene_.wheel(), start_, window_));
    return result;
  }
  Cycle due(Cycle now) const override {
    return std::max(now + 1, std::min(later(scene_.wheel(), now, window_interval), last_look()));
  }
  Cycle needs_from() const override { return std::max(start_.cycle, needs_); }

 protected:
  virtual void count(const PadEdge& edge) = 0;
  virtual CheckResult early() const { return {}; }
  virtual CheckResult judge(const Moment& end) const = 0;

  Scene scene_;
  unsigned gpio_;
  Moment start_;

 private:
  Cycle last_look() const { return cycle_after(scene_.wheel(), start_, window_) + settle_cycles; }
  Span window_;
  std::size_t next_;
  Cycle needs_ = 0;
};

class CountCheck final : public WindowCheck {
 public:
  CountCheck(const ExpectCount& what, const Scene& scene, const Moment& start)
      : WindowCheck(what.edge.gpio, scene, start, what.window), what_(what) {}

 private:
  void count(const PadEdge& edge) override {
    if (edge.is(what_.edge.kind)) ++seen_;
  }
  CheckResult judge(const Moment& end) const override {
    if (seen_ >= what_.least && seen_ <= what_.most) return {State::met, end, {}};
    return {State::failed, end, std::to_string(seen_)};
  }
  ExpectCount what_;
  std::uint64_t seen_ = 0;
};

class NeverCheck final : public WindowCheck {
 public:
  NeverCheck(const ExpectNever& what, const Scene& scene, const Moment& start)
      : WindowCheck(what.gpio, scene, start, what.window), level_(what.level) {
    const PadLog& pads = scene.pads;
    if (pads.level_before(gpio_, pads.first_after(gpio_, start.cycle)) == level_) broken_ = start;
  }

 private:
  void count(const PadEdge& edge) override {
    if (edge.level == level_ && !broken_) broken_ = edge.at;
  }
  CheckResult early() const override {
    if (!broken_) return {};
    return {State::failed, *broken_, level_word(level_)};
  }
  CheckResult judge(const Moment& end) const override { return {State::met, end, {}}; }
  bool level_;
  std::optional<Moment> broken_;
};

class FrequencyCheck final : public WindowCheck {
 public:
  FrequencyCheck(const ExpectFrequency& what, const Scene& scene, const Moment& start)
      : WindowCheck(what.gpio, scene, start, what.window), what_(what) {}

 private:
  void count(const PadEdge& edge) override {
    if (!edge.level) return;
    if (rises_++ == 0) first_ = edge.at;
    last_ = edge.at;
  }
  CheckResult judge(const Moment& end) const override {
    if (rises_ < 2) return {State::failed, end, std::to_string(rises_) + " rising edges"};
    const double hz = static_cast<double>(rises_ - 1) / seconds(last_.time - first_.time);
    if (std::abs(hz - what_.hz) <= what_.tolerance * what_.hz) return {State::met, end, {}};
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.6g Hz (%+.3f %%)", hz,
                  100 * (hz - what_.hz) / what_.hz);
    return {State::failed, end, text.data()};
  }
  ExpectFrequency what_;
  std::uint64_t rises_ = 0;
  Moment first_{}, last_{};
};

class LevelCheck final : public Check {
 public:
  LevelCheck(const ExpectLevel& what, const Scene& scene, const Moment& start)
      : what_(what), scene_(scene), start_(start) {}
  CheckResult poll(Cycle now) override {
    if (now < due(0)) return {};
    const PadLog& pads = scene_.pads;
    const bool level = pads.level_before(what_.gpio, pads.first_after(what_.gpio, start_.cycle));
    if (level == what_.level) return {State::met, start_, {}};
    return {State::failed, start_, level_word(level)};
  }
  Cycle due(Cycle /*now*/) const override { return start_.cycle + settle_cycles; }
  Cycle needs_from() const override { return start_.cycle; }

 private:
  ExpectLevel what_;
  Scene scene_;
  Moment start_;
};

struct Maker {
  const Scene& scene;
  const Moment& start;
  using Result = std::unique_ptr<Check>;
  Result operator()(const ExpectPort& what) const {
    return std::make_unique<PortCheck>(scene, start, what.limit);
  }
  Result operator()(const ExpectText& what) const {
    return std::make_unique<TextCheck>(what, scene, start);
  }
  Result operator()(const ExpectEdge& what) const {
    return std::make_unique<EdgeCheck>(what, scene, start);
  }
  Result operator()(const ExpectReaction& what) const {
    return std::make_unique<ReactionCheck>(what, scene, start);
  }
  Result operator()(const ExpectCount& what) const {
    return std::make_unique<CountCheck>(what, scene, start);
  }
  Result operator()(const ExpectNever& what) const {
    return std::make_unique<NeverCheck>(what, scene, start);
  }
  Result operator()(const ExpectLevel& what) const {
    return std::make_unique<LevelCheck>(what, scene, start);
  }
  Result operator()(const ExpectFrequency& what) const {
    return std::make_unique<FrequencyCheck>(what, scene, start);
  }
  template <class Other>
  Result operator()(const Other& /*what*/) const {
    return nullptr;
  }
};

struct Pins {
  static constexpr std::uint32_t bit(unsigned gpio) { return 1u << gpio; }
  std::uint32_t operator()(const ExpectEdge& what) const { return bit(what.edge.gpio); }
  std::uint32_t operator()(const ExpectReaction& what) const {
    return bit(what.edge.gpio) | bit(what.cause.gpio);
  }
  std::uint32_t operator()(const ExpectCount& what) const { return bit(what.edge.gpio); }
  std::uint32_t operator()(const ExpectNever& what) const { return bit(what.gpio); }
  std::uint32_t operator()(const ExpectLevel& what) const { return bit(what.gpio); }
  std::uint32_t operator()(const ExpectFrequency& what) const { return bit(what.gpio); }
  template <class Other>
  std::uint32_t operator()(const Other& /*what*/) const {
    return 0;
  }
};

}  // namespace

std::unique_ptr<Check> make_check(const Action& action, const Scene& scene, const Moment& start) {
  return std::visit(Maker{scene, start}, action);
}

std::uint32_t pins_of(const Action& action) { return std::visit(Pins{}, action); }

}  // namespace lamplock::sim::chip::script
