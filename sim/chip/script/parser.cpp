#include "sim/chip/script/parser.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "sim/chip/analog/adc.hpp"
#include "sim/chip/script/script_time.hpp"

namespace lamplock::sim::chip::script {
namespace {

constexpr std::string_view blanks = " \t\r";
/// Longer spans do not fit in 64 bits of picoseconds, and no simulation lasts as long.
constexpr double max_span_ps = 1e6 * 1e12;
constexpr std::uint64_t max_times = 1'000'000'000;
constexpr unsigned first_adc_gpio = 26;  // RP2040 datasheet, 4.9

[[noreturn]] void fail(const std::string& where, const std::string& what,
                       const std::string& possible) {
  throw std::runtime_error(where + ": " + what + "; " + possible);
}

std::string quoted(std::string_view text) { return std::string("'").append(text).append("'"); }

/// A number at the beginning of a word, and what follows it.
struct Number {
  double value = 0;
  std::string_view unit;
};
std::optional<Number> number(std::string_view word) {
  Number read;
  const char* const end = word.data() + word.size();
  const auto [rest, error] =
      std::from_chars(word.data(), end, read.value, std::chars_format::fixed);
  if (error != std::errc{} || !std::isfinite(read.value) || read.value < 0) return std::nullopt;
  read.unit = {rest, static_cast<std::size_t>(end - rest)};
  return read;
}

std::optional<std::uint64_t> whole(std::string_view word) {
  std::uint64_t value = 0;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc{} || rest != end) return std::nullopt;
  return value;
}

std::optional<Span> span(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, Picoseconds>, 5> units{
      {{"ps", 1}, {"ns", ps_per_ns}, {"us", ps_per_us}, {"ms", ps_per_ms}, {"s", ps_per_s}}};
  const std::optional<Number> read = number(word);
  if (!read) return std::nullopt;
  if (read->unit == "cycles") {
    if (read->value != std::floor(read->value) || read->value > max_span_ps) return std::nullopt;
    return Span{static_cast<std::int64_t>(read->value), true};
  }
  for (const auto& [name, ps] : units) {
    if (read->unit != name) continue;
    const double value = read->value * static_cast<double>(ps);
    if (value > max_span_ps) return std::nullopt;
    return Span{std::llround(value), false};
  }
  return std::nullopt;
}

std::optional<double> frequency(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, double>, 3> units{
      {{"Hz", 1}, {"kHz", 1e3}, {"MHz", 1e6}}};
  const std::optional<Number> read = number(word);
  if (!read || read->value <= 0) return std::nullopt;
  for (const auto& [name, hz] : units)
    if (read->unit == name) return read->value * hz;
  return std::nullopt;
}

/// One line, word by word.
class Line {
 public:
  Line(std::string_view text, std::string where) : rest_(text), where_(std::move(where)) {
    skip_blanks();
  }

  bool done() const { return rest_.empty(); }
  std::string_view rest() const { return rest_; }
  /// The text read since `begin`, which was rest() at that time.
  std::string since(std::string_view begin) const { return {begin.data(), read_to_}; }
  [[noreturn]] void refuse(const std::string& what, const std::string& possible) const {
    fail(where_, what, possible);
  }

  /// The next word; `possible` names the valid ones.
  std::string_view word(const std::string& possible) {
    if (done()) refuse("the line ends too early", possible);
    const std::string_view word = next_word();
    if (word.empty()) refuse("a text is not expected here", possible);
    take(word.size());
    return word;
  }
  /// True if the next word is this one; otherwise it is not taken.
  bool accept(std::string_view wanted) {
    if (next_word() != wanted) return false;
    take(wanted.size());
    return true;
  }
  void keyword(std::string_view wanted) {
    if (!accept(wanted))
      refuse(done() ? "the line ends too early" : unexpected(),
             "write '" + std::string(wanted) + "' there");
  }
  std::string unexpected() const {
    return quoted(rest_.substr(0, rest_.find_first_of(blanks))) + " is not expected here";
  }
  void end() const {
    if (!done()) refuse(unexpected(), "the statement is complete before it");
  }

  Span time() {
    static const std::string possible = "give a time such as 5us, 2.5ms or 250cycles";
    const std::string_view text = word(possible);
    const std::optional<Span> value = span(text);
    if (!value) refuse(quoted(text) + " is not a time", possible);
    return *value;
  }
  Picoseconds absolute_time() {
    static const std::string possible = "give a time since power-up such as 10ms";
    const std::string_view text = word(possible);
    const std::optional<Span> value = span(text);
    if (!value || value->cycles) refuse(quoted(text) + " is not a time since power-up", possible);
    return value->amount;
  }
  Span length() {
    const Span value = time();
    if (value.amount == 0) refuse("a time of 0", "give a time greater than 0");
    return value;
  }
  std::optional<unsigned> gpio_of(std::string_view text) const {
    if (!text.starts_with("gpio")) return std::nullopt;
    const std::optional<std::uint64_t> value = whole(text.substr(4));
    if (!value || *value >= gpio_count) refuse(quoted(text) + " is not a pin", pins);
    return static_cast<unsigned>(*value);
  }
  unsigned gpio() {
    const std::string_view text = word(pins);
    const std::optional<unsigned> value = gpio_of(text);
    if (!value) refuse(quoted(text) + " is not a pin", pins);
    return *value;
  }
  bool level() {
    static const std::string possible = "give high or low (or 1, 0)";
    const std::string_view text = word(possible);
    if (text == "high" || text == "1") return true;
    if (text == "low" || text == "0") return false;
    refuse(quoted(text) + " is not a level", possible);
  }
  /// The next word if it is a voltage.
  std::optional<double> accept_volts() {
    const std::string_view text = next_word();
    const std::optional<Number> read = number(text);
    if (!read || read->unit != "V") return std::nullopt;
    take(text.size());
    return read->value;
  }
  double celsius() {
    static const std::string possible = "give degrees such as 27C";
    const std::string_view text = word(possible);
    const std::optional<Number> read = number(text);
    if (!read || read->unit != "C") refuse(quoted(text) + " is not a temperature", possible);
    return read->value;
  }
  PinEdge pin_edge() {
    const unsigned pin = gpio();
    static const std::string possible = "give rise, fall or edge";
    const std::string_view text = word(possible);
    const std::optional<EdgeKind> kind = edge_kind(text);
    if (!kind) refuse(quoted(text) + " is not an edge", possible);
    return {pin, *kind};
  }
  static std::optional<EdgeKind> edge_kind(std::string_view text) {
    if (text == "rise") return EdgeKind::rise;
    if (text == "fall") return EdgeKind::fall;
    if (text == "edge") return EdgeKind::any;
    return std::nullopt;
  }
  std::uint64_t times() {
    static const std::string possible = "give a whole number from 1 to 1000000000";
    const std::string_view text = word(possible);
    const std::optional<std::uint64_t> value = whole(text);
    if (!value || *value == 0 || *value > max_times)
      refuse(quoted(text) + " is not a number of times", possible);
    return *value;
  }
  std::string string() {
    static const std::string possible = R"(give a text in double quotes, with \r \n \t \\ \" \xHH)";
    if (done() || rest_.front() != '"')
      refuse(done() ? "the line ends too early" : unexpected(), possible);
    std::string text;
    std::size_t at = 1;
    for (; at < rest_.size() && rest_[at] != '"'; ++at)
      text += rest_[at] == '\\' ? escape(at, possible) : rest_[at];
    if (at >= rest_.size()) refuse("the text has no closing quote", possible);
    if (text.empty()) refuse("the text is empty", possible);
    take(at + 1);
    return text;
  }

  static constexpr const char* pins = "pins are gpio0 to gpio29";

 private:
  /// The character that the backslash at `at` begins; `at` is its last one afterwards.
  char escape(std::size_t& at, const std::string& possible) const {
    const char kind = ++at < rest_.size() ? rest_[at] : '\0';
    switch (kind) {
      case 'r':
        return '\r';
      case 'n':
        return '\n';
      case 't':
        return '\t';
      case '\\':
      case '"':
        return kind;
      case 'x': {
        const std::string_view digits = rest_.substr(at + 1, 2);
        unsigned value = 0;
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
        if (error != std::errc{} || end != digits.data() + 2) break;
        at += 2;
        return static_cast<char>(value);
      }
      default:
        break;
    }
    refuse("a backslash is followed by an unknown character", possible);
  }
  /// Up to a blank, a comment or a text; empty at one of them.
  std::string_view next_word() const { return rest_.substr(0, rest_.find_first_of(" \t\r#\"")); }
  void take(std::size_t count) {
    rest_.remove_prefix(count);
    read_to_ = rest_.data();
    skip_blanks();
  }
  /// A comment ends the line.
  void skip_blanks() {
    const std::size_t next = rest_.find_first_not_of(blanks);
    rest_ = next == std::string_view::npos ? std::string_view{} : rest_.substr(next);
    if (rest_.starts_with('#')) rest_ = {};
  }

  std::string_view rest_;
  const char* read_to_ = nullptr;  ///< end of the last word
  std::string where_;
};

constexpr const char* statements =
    "statements are at, after, set, release, join, pulse, usb, uart0, uart1, expect, wait, "
    "meanwhile, allow and end";

std::optional<Port> port(std::string_view word) {
  if (word == "usb") return Port::usb;
  if (word == "uart0") return Port::uart0;
  if (word == "uart1") return Port::uart1;
  return std::nullopt;
}

Pulse pulse(Line& line) {
  Pulse result;
  result.gpio = line.gpio();
  if (line.accept("low")) result.level = false;
  result.width = line.length();
  if (!line.accept("every")) return result;
  result.period = line.length();
  if (result.period.cycles != result.width.cycles)
    line.refuse("width and period have different units", "give both in cycles, or none");
  if (result.period.amount <= result.width.amount)
    line.refuse("the pulse is not shorter than its period", "give a greater period");
  result.times = line.accept("times") ? line.times() : 0;
  return result;
}

/// Two numbers with ".." between them; a single number is returned twice.
std::pair<std::string_view, std::string_view> range(std::string_view word) {
  const std::size_t dots = word.find("..");
  if (dots == std::string_view::npos) return {word, word};
  return {word.substr(0, dots), word.substr(dots + 2)};
}

ExpectCount count(Line& line, PinEdge edge) {
  static const std::string possible = "give a number such as 20, or a range such as 1990..2010";
  const std::string_view word = line.word(possible);
  const auto [low, high] = range(word);
  const std::optional<std::uint64_t> least = whole(low), most = whole(high);
  if (!least || !most || *least > *most)
    line.refuse(quoted(word) + " is not a number of edges", possible);
  line.keyword("in");
  return {edge, *least, *most, line.length()};
}

ExpectFrequency mean_frequency(Line& line, unsigned gpio) {
  static const std::string possible = "give a frequency such as 50Hz, 38.4kHz or 1MHz";
  static const std::string deviations = "write +-0.1% there";
  const std::string_view word = line.word(possible);
  const std::optional<double> hz = frequency(word);
  if (!hz) line.refuse(quoted(word) + " is not a frequency", possible);
  const std::string_view deviation = line.word(deviations);
  const std::optional<Number> percent =
      deviation.starts_with("+-") ? number(deviation.substr(2)) : std::nullopt;
  if (!percent || percent->unit != "%")
    line.refuse(quoted(deviation) + " is not a deviation", deviations);
  line.keyword("in");
  return {gpio, *hz, percent->value / 100, line.length()};
}

/// `rise within 1ms`, or `rise within 5us..6us of gpio8 rise [times 20]`.
Action edge_within(Line& line, PinEdge edge) {
  line.keyword("within");
  static const std::string possible = "give a time such as 1ms, or a range such as 5us..6us";
  const std::string_view word = line.word(possible);
  const bool is_range = word.find("..") != std::string_view::npos;
  const auto [low, high] = range(word);
  const std::optional<Span> from = span(low), to = span(high);
  if (!from || !to || from->cycles != to->cycles || from->amount > to->amount)
    line.refuse(quoted(word) + " is not a time, nor a range of times", possible);
  if (line.done()) {
    if (is_range) line.refuse("a range of times needs a cause", "write 'of gpio8 rise' after it");
    return ExpectEdge{edge, *to};
  }
  line.keyword("of");
  const Span least = is_range ? *from : Span{0, to->cycles};
  ExpectReaction result{edge, least, *to, line.pin_edge(), 1};
  if (line.accept("times")) result.times = line.times();
  return result;
}

Action expectation_of_pin(Line& line, unsigned gpio) {
  static const std::string possible =
      "after a pin: rise, fall, edge, edges, rises, falls, never, frequency, high or low";
  const std::string_view what = line.word(possible);
  if (const std::optional<EdgeKind> kind = Line::edge_kind(what))
    return edge_within(line, {gpio, *kind});
  if (what == "edges") return count(line, {gpio, EdgeKind::any});
  if (what == "rises") return count(line, {gpio, EdgeKind::rise});
  if (what == "falls") return count(line, {gpio, EdgeKind::fall});
  if (what == "frequency") return mean_frequency(line, gpio);
  if (what == "never") {
    const bool level = line.level();
    line.keyword("in");
    return ExpectNever{gpio, level, line.length()};
  }
  if (what == "high" || what == "low") return ExpectLevel{gpio, what == "high"};
  line.refuse(quoted(what) + " cannot be expected of a pin", possible);
}

Action expectation(Line& line) {
  static const std::string possible = "expect a pin (gpio9 ...), usb, uart0 or uart1";
  const std::string_view what = line.word(possible);
  if (const std::optional<unsigned> gpio = line.gpio_of(what))
    return expectation_of_pin(line, *gpio);
  const std::optional<Port> from = port(what);
  if (!from) line.refuse(quoted(what) + " cannot be expected", possible);
  std::string text = line.string();
  line.keyword("within");
  return ExpectText{*from, std::move(text), line.length()};
}

Action waiting(Line& line) {
  if (line.accept("usb")) {
    line.keyword("within");
    return ExpectPort{line.length()};
  }
  const PinEdge edge = line.pin_edge();
  line.keyword("within");
  return ExpectEdge{edge, line.length()};
}

Allow allowance(Line& line) {
  static const std::string possible = "give hardfault, lockup, bootblock or watchdog";
  const std::string_view text = line.word(possible);
  const std::optional<FaultKind> kind = fault_kind(text);
  if (!kind) line.refuse(quoted(text) + " is not a fault", possible);
  return {*kind};
}

Action sending(Line& line, Port to) {
  line.keyword("send");
  return Send{to, line.string()};
}

Action setting(Line& line) {
  if (line.accept("temperature")) return SetTemperature{line.celsius()};
  const unsigned gpio = line.gpio();
  if (const std::optional<double> volts = line.accept_volts()) {
    if (gpio < first_adc_gpio || gpio >= first_adc_gpio + Adc::pin_inputs)
      line.refuse("gpio" + std::to_string(gpio) + " is not an input of the ADC",
                  "give a voltage to one of gpio26 to gpio29");
    return SetVoltage{gpio - first_adc_gpio, *volts};
  }
  return SetPin{gpio, line.level() ? External::high : External::low};
}

Join wire(Line& line) {
  const unsigned one = line.gpio(), other = line.gpio();
  if (one == other) line.refuse("a pin is joined to itself", "give two pins");
  return {one, other};
}

/// All statements except at and after.
Action statement(Line& line, std::string_view word) {
  if (word == "set") return setting(line);
  if (word == "release") return SetPin{line.gpio(), External::floating};
  if (word == "join") return wire(line);
  if (word == "pulse") return pulse(line);
  if (word == "expect") return expectation(line);
  if (word == "wait") return waiting(line);
  if (word == "allow") return allowance(line);
  if (word == "end") return End{};
  if (const std::optional<Port> to = port(word)) return sending(line, *to);
  line.refuse(quoted(word) + " is not a statement", statements);
}

void parse_line(Line line, int number, Script& script) {
  while (!line.done()) {
    std::string_view word = line.word(statements);
    if (word == "at") {
      const Picoseconds time = line.absolute_time();
      script.push_back({number, "at " + time_text(time), false, At{time}});
      continue;
    }
    if (word == "after") {
      script.push_back({number, "after", false, After{line.time()}});
      continue;
    }
    const bool meanwhile = word == "meanwhile";
    if (meanwhile) {
      static const std::string possible = "write expect after meanwhile";
      word = line.word(possible);
      if (word != "expect") line.refuse("only an expectation can follow meanwhile", possible);
    }
    const std::string_view begin = line.rest();
    Action action = statement(line, word);
    line.end();
    std::string text = begin.empty() ? std::string() : line.since(begin);
    script.push_back({number, std::move(text), meanwhile, std::move(action)});
  }
}

}  // namespace

Script parse(std::string_view text, const std::string& where) {
  Script script;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    parse_line(Line(text.substr(0, end), where + ':' + std::to_string(number)), number, script);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return script;
}

Picoseconds parse_time(std::string_view text, const std::string& where) {
  const std::optional<Span> value = span(text);
  if (!value || value->cycles)
    fail(where, quoted(text) + " is not a time", "give a time such as 2.5s, 10ms or 500us");
  return value->amount;
}

}  // namespace lamplock::sim::chip::script
