// Scripts: parsing, and running on a chip with a tiny program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>

#include "sim/chip/script/parser.hpp"
#include "sim/chip/script/runner.hpp"
#include "tests/chip/tiny_image.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::script::script_test {
namespace {

using testing::HasSubstr;

// --- parser

template <class Kind>
Kind only(const std::string& text) {
  const Script script = parse(text, "t");
  EXPECT_EQ(script.size(), 1u) << text;
  const Kind* kind = script.empty() ? nullptr : std::get_if<Kind>(&script.front().action);
  EXPECT_NE(kind, nullptr) << text;
  return kind == nullptr ? Kind{} : *kind;
}

TEST(ScriptParser, ReadsTimes) {
  EXPECT_EQ(only<At>("at 10ms").time, 10 * ps_per_ms);
  EXPECT_EQ(only<At>("at 2.5s").time, 2'500 * ps_per_ms);
  EXPECT_EQ(only<At>("at 0.5ns").time, 500);
  EXPECT_EQ(only<After>("after 7518ps").span.amount, 7518);
  EXPECT_EQ(only<After>("after 250cycles").span.amount, 250);
  EXPECT_TRUE(only<After>("after 250cycles").span.cycles);
  EXPECT_EQ(parse_time("500us", "t"), 500 * ps_per_us);
}

TEST(ScriptParser, ReadsActions) {
  EXPECT_EQ(only<SetPin>("set gpio8 1").level, External::high);
  EXPECT_EQ(only<SetPin>("set gpio29 low").level, External::low);
  EXPECT_EQ(only<SetPin>("set gpio29 low").gpio, 29u);
  EXPECT_EQ(only<SetPin>("release gpio8").level, External::floating);
  EXPECT_EQ(only<SetVoltage>("set gpio27 1.65V").input, 1u);
  EXPECT_DOUBLE_EQ(only<SetVoltage>("set gpio27 1.65V").volts, 1.65);
  EXPECT_DOUBLE_EQ(only<SetTemperature>("set temperature 35C").celsius, 35);
  const Pulse once = only<Pulse>("pulse gpio8 3us");
  EXPECT_TRUE(once.level);
  EXPECT_EQ(once.times, 1u);
  const Pulse train = only<Pulse>("pulse gpio8 low 3us every 10ms times 20");
  EXPECT_FALSE(train.level);
  EXPECT_EQ(train.period.amount, 10 * ps_per_ms);
  EXPECT_EQ(train.times, 20u);
  EXPECT_EQ(only<Pulse>("pulse gpio8 3us every 10ms").times, 0u);
  EXPECT_EQ(only<Send>(R"(uart0 send "a\r\n\t\"\\\x7fb")").text,
            "a\r\n\t\"\\\x7f"
            "b");
  EXPECT_EQ(only<Send>(R"(usb send "# no comment")").text, "# no comment");
}

TEST(ScriptParser, ReadsExpectations) {
  const ExpectText text = only<ExpectText>(R"(expect usb "ok" within 20ms)");
  EXPECT_EQ(text.text, "ok");
  EXPECT_EQ(text.limit.amount, 20 * ps_per_ms);
  const ExpectReaction reaction =
      only<ExpectReaction>("expect gpio9 rise within 5us..6us of gpio8 fall times 4");
  EXPECT_EQ(reaction.least.amount, 5 * ps_per_us);
  EXPECT_EQ(reaction.most.amount, 6 * ps_per_us);
  EXPECT_EQ(reaction.cause.kind, EdgeKind::fall);
  EXPECT_EQ(reaction.times, 4u);
  EXPECT_EQ(only<ExpectReaction>("expect gpio9 rise within 6us of gpio8 rise").least.amount, 0);
  const ExpectCount count = only<ExpectCount>("expect gpio25 edges 1990..2010 in 1ms");
  EXPECT_EQ(count.least, 1990u);
  EXPECT_EQ(count.most, 2010u);
  EXPECT_EQ(only<ExpectCount>("expect gpio25 rises 3 in 1ms").most, 3u);
  EXPECT_TRUE(only<ExpectNever>("expect gpio9 never high in 10ms").level);
  EXPECT_FALSE(only<ExpectLevel>("expect gpio9 low").level);
  const ExpectFrequency hz = only<ExpectFrequency>("expect gpio1 frequency 1MHz +-0.1% in 1ms");
  EXPECT_DOUBLE_EQ(hz.hz, 1e6);
  EXPECT_DOUBLE_EQ(hz.tolerance, 0.001);
  EXPECT_EQ(only<ExpectEdge>("wait gpio9 rise within 1ms").limit.amount, ps_per_ms);
  EXPECT_EQ(only<ExpectPort>("wait usb within 1s").limit.amount, ps_per_s);
}

TEST(ScriptParser, KeepsLinesAndTexts) {
  const Script script =
      parse("# first\n\n  at 1ms set gpio8 1   # now\r\nmeanwhile expect gpio9 low # x\nend", "t");
  ASSERT_EQ(script.size(), 4u);
  EXPECT_EQ(script[0].line, 3);
  EXPECT_EQ(script[1].line, 3);
  EXPECT_EQ(script[2].line, 4);
  EXPECT_EQ(script[2].text, "gpio9 low");
  EXPECT_TRUE(script[2].meanwhile);
  EXPECT_FALSE(script[1].meanwhile);
}

TEST(ScriptParser, RefusesWithTheValidChoices) {
  const auto refused = [](const std::string& line, const std::string& what) {
    try {
      parse("at 1ms\n" + line, "t");
      ADD_FAILURE() << line << " was taken";
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::MatchesRegex("t:2: [^\n]+; [^\n]+")) << line;
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  refused("toggle gpio8", "statements are at, after, set");
  refused("set gpio30 1", "gpio0 to gpio29");
  refused("set 8 1", "gpio0 to gpio29");
  refused("set gpio8", "the line ends too early; give high or low");
  refused("set gpio8 2", "give high or low");
  refused("set gpio8 1.2V", "gpio26 to gpio29");
  refused("set gpio30 1V", "gpio0 to gpio29");
  refused("set gpio26 1W", "give high or low");
  refused("set temperature 27", "degrees such as 27C");
  refused("set gpio8 1 2", "'2' is not expected here");
  refused("at 5cycles", "since power-up");
  refused("after -5us", "'-5us' is not a time");
  refused("after 5", "'5' is not a time");
  refused("after 1e30s", "is not a time");
  refused("after 9999999999s", "is not a time");
  refused("join gpio8", "pins are gpio0 to gpio29");
  refused("join gpio8 gpio8", "give two pins");
  refused("pulse gpio8 0us", "greater than 0");
  refused("pulse gpio8 3us every 3us", "greater period");
  refused("pulse gpio8 3us every 9cycles", "different units");
  refused("pulse gpio8 3us every 9us times 0", "whole number");
  refused(R"(usb send "abc)", "no closing quote");
  refused(R"(usb send "\q")", "backslash");
  refused(R"(usb send "\x4")", "backslash");
  refused("usb send abc", "double quotes");
  refused("usb \"abc\"", "write 'send' there");
  refused("expect gpio9", "rise, fall, edge, edges");
  refused("expect gpio9 rise", "write 'within' there");
  refused("expect gpio9 rise within 6us..5us of gpio8 rise", "range of times");
  refused("expect gpio9 rise within 5us..6us", "of gpio8 rise");
  refused("expect gpio9 edges 5..4 in 1ms", "1990..2010");
  refused("expect gpio9 frequency 0Hz +-1% in 1ms", "50Hz");
  refused("expect gpio9 frequency 5kHz 1% in 1ms", "+-0.1%");
  refused("expect spi0 \"a\" within 1ms", "expect a pin");
  refused("meanwhile set gpio8 1", "write expect after meanwhile");
}

TEST(ScriptParser, AnyLineIsAcceptedOrRefusedInOneLine) {
  const std::vector<std::string> words{
      "at",     "after", "set",       "gpio8", "gpio99", "1",        "high",      "expect",
      "within", "5us",   "of",        "rise",  "edges",  "3..4",     "in",        "\"a\\n\"",
      "\"",     "usb",   "uart0",     "send",  "wait",   "5us..9us", "meanwhile", "end",
      "#",      "never", "frequency", "1kHz",  "+-1%",   "times",    "gpio26",    "1.5V"};
  std::mt19937_64 random(5);
  for (int i = 0; i < test::scaled(20'000); ++i) {
    std::string line;
    for (auto count = random() % 9; count-- > 0;) line += words[random() % words.size()] + ' ';
    try {
      EXPECT_LE(parse(line, "t").size(), 9u);
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::MatchesRegex("t:1: [^\n]+; [^\n]+")) << line;
    }
  }
}

TEST(ScriptTimes, AreShownWithAllDigits) {
  EXPECT_EQ(time_text(0), "0 s");
  EXPECT_EQ(time_text(1), "1 ps");
  EXPECT_EQ(time_text(7'518), "7.518 ns");
  EXPECT_EQ(time_text(10'007'200'000), "10.0072 ms");
  EXPECT_EQ(time_text(2 * ps_per_s), "2 s");
  EXPECT_EQ(time_text(-5 * ps_per_us), "-5 us");
}

// --- runner

/// The ROM has started the image by then (its check of the boot code takes some 4 ms).
const std::string booted = "at 20ms\n";
constexpr Picoseconds slice = 100 * ps_per_us;

struct Rig {
  Rig(const std::vector<std::uint8_t>& image, const std::string& text)
      : host(chip.wheel(), chip.usb()), ports(chip, host), runner(chip, ports, parse(text, "t")) {
    chip.load(parse_bin(image, "image"), "image");
    chip.power_on();
  }
  void run_until(Picoseconds until) {
    while (!runner.done() && chip.time() < until)
      chip.run_until(chip.wheel().cycle_at(std::min(until, chip.time() + slice)));
  }
  /// "" if it passes; "LINE: seen" if not.
  std::string outcome(Picoseconds limit = 200 * ps_per_ms) {
    run_until(limit);
    if (!runner.done())
      return "not done: line " + std::to_string(runner.not_complete(chip.time()).line);
    if (!runner.failure()) return "";
    return std::to_string(runner.failure()->line) + ": " + runner.failure()->seen;
  }
  Chip chip;
  UsbHost host;
  SerialPorts ports;
  Runner runner;
};

std::string pins(const std::string& text) {
  return Rig(lamplock::test::pin_image(), booted + text).outcome();
}

// gpio9 follows after 2 flip-flops, up to 5 cycles to the next poll, 2 from LDR to STR.
TEST(ScriptRunner, MeasuresAReaction) {
  EXPECT_EQ(pins("set gpio8 1\nexpect gpio9 rise within 3cycles..10cycles of gpio8 rise\n"
                 "set gpio8 0\nexpect gpio9 fall within 450ns..1540ns of gpio8 fall"),
            "");
  EXPECT_THAT(pins("set gpio8 1\nexpect gpio9 rise within 2cycles of gpio8 rise"),
              testing::MatchesRegex("3: gpio9 rise .*s \\([3-9] cycles\\) after gpio8 rise at .*"));
  EXPECT_THAT(pins("set gpio8 1\nexpect gpio9 rise within 20us..30us of gpio8 rise"),
              HasSubstr("gpio9 rise"));
  EXPECT_THAT(pins("set gpio8 1\nexpect gpio9 fall within 20us of gpio8 rise"),
              HasSubstr("none after gpio8 rise at 20"));
}

TEST(ScriptRunner, JudgesEveryPulseOfATrain) {
  EXPECT_EQ(pins("pulse gpio8 3us every 10us times 20\n"
                 "meanwhile expect gpio8 rises 19 in 1ms\n"
                 "expect gpio9 rise within 3cycles..10cycles of gpio8 rise times 20\n"
                 "expect gpio9 never high in 800us\n"),
            "5: high");  // the last pulse is not over yet
  EXPECT_EQ(pins("pulse gpio8 3us every 10us times 20\n"
                 "expect gpio9 fall within 3cycles..10cycles of gpio8 fall times 20\n"
                 "expect gpio9 never high in 800us\n"),
            "");
  EXPECT_EQ(pins("pulse gpio8 3us every 10us times 19\n"
                 "expect gpio9 rise within 3cycles..10cycles of gpio8 rise times 20"),
            "not done: line 3");
}

TEST(ScriptRunner, FindsACauseBeforeTheScriptsTime) {
  EXPECT_EQ(pins("set gpio8 1\nafter 50us\n"
                 "expect gpio9 rise within 3cycles..10cycles of gpio8 rise"),
            "");
}

// 65 cycles of 6.5 MHz (4.5.2.2: a period is TOP + 1 cycles).
TEST(ScriptRunner, CountsToTheCycle) {
  EXPECT_EQ(pins("expect gpio25 rise within 65cycles..65cycles of gpio25 rise times 500"), "");
  EXPECT_EQ(pins("expect gpio25 rise within 10us..10us of gpio25 rise times 500"), "");
  EXPECT_EQ(pins("expect gpio25 fall within 32cycles..32cycles of gpio25 rise times 500"), "");
  EXPECT_THAT(pins("expect gpio25 rise within 66cycles..67cycles of gpio25 rise"),
              HasSubstr("10 us (65 cycles) after"));
  EXPECT_EQ(pins("expect gpio25 edges 200 in 1ms"), "");
  EXPECT_EQ(pins("expect gpio25 rises 101 in 1ms"), "2: 100");
  EXPECT_EQ(pins("expect gpio25 falls 99..100 in 1ms"), "");
  EXPECT_EQ(pins("expect gpio25 frequency 100kHz +-0.001% in 1ms"), "");
  EXPECT_EQ(pins("expect gpio25 frequency 99kHz +-1% in 1ms"), "2: 100000 Hz (+1.010 %)");
  EXPECT_EQ(pins("expect gpio9 frequency 99kHz +-1% in 1ms"), "2: 0 rising edges");
}

// The edge at the beginning is not counted, the one at the end is.
TEST(ScriptRunner, WindowsEndWithTheirLastCycle) {
  const std::string at_a_rise = "wait gpio25 rise within 1ms\n";
  EXPECT_EQ(pins(at_a_rise + "expect gpio25 rises 1 in 65cycles"), "");
  EXPECT_EQ(pins(at_a_rise + "expect gpio25 rises 1 in 10us"), "");
  EXPECT_EQ(pins(at_a_rise + "expect gpio25 rises 0 in 64cycles"), "");
  EXPECT_EQ(pins(at_a_rise + "expect gpio25 rises 2 in 130cycles"), "");
}

TEST(ScriptRunner, WaitsAndCountsFromTheEdge) {
  // A rise follows two periods after any rise.
  EXPECT_EQ(pins("wait gpio25 rise within 1ms\nafter 129cycles\n"
                 "wait gpio25 rise within 1cycles\nafter 20us\nexpect gpio25 high"),
            "");
  EXPECT_THAT(pins("wait gpio25 rise within 1ms\nafter 129cycles\nafter 2cycles\n"
                   "wait gpio25 rise within 63cycles"),
              HasSubstr("5: none, the pin is"));
  EXPECT_THAT(pins("wait gpio9 rise within 1ms"), HasSubstr("2: none, the pin is low"));
}

TEST(ScriptRunner, HoldsLevels) {
  EXPECT_EQ(pins("expect gpio9 low\nset gpio8 1\nafter 5us\nexpect gpio9 high\n"
                 "expect gpio9 never low in 1ms\nset gpio8 0\nafter 5us\nexpect gpio9 low\n"
                 "set gpio8 1\nafter 5us\nrelease gpio8\nafter 5us\n"
                 "expect gpio9 low  # the pad's pull-down (2.19.6.3)"),
            "");
  EXPECT_EQ(pins("expect gpio9 high"), "2: low");
  EXPECT_EQ(pins("meanwhile expect gpio9 never high in 1ms\nafter 500us\nset gpio8 1\n"
                 "after 100ms set gpio8 0"),
            "2: high");
}

TEST(ScriptRunner, ATimeThatHasPassedIsAnError) {
  EXPECT_THAT(pins("after 5ms\nat 22ms"), HasSubstr("3: the script's time is 25 ms already"));
}

TEST(ScriptRunner, SendsToAndReceivesFromUarts) {
  const auto uart = [](const std::string& text) {
    return Rig(lamplock::test::uart_image(), booted + text).outcome();
  };
  EXPECT_EQ(uart("uart0 send \"abc\\r\\n\"\nexpect uart0 \"b\" within 1ms\n"
                 "expect uart0 \"c\\r\\n\" within 1ms"),
            "");
  EXPECT_EQ(uart("uart0 send \"abc\\x01\"\nexpect uart0 \"x\" within 1ms"), R"(3: "abc\x01")");
  // A bit takes 48 cycles, 7.385 us. A byte arrives in the middle of its stop bit, after 9.5 bits,
  // and is sent after 10 bits: 144.0 us. The program polls about every 12 cycles.
  EXPECT_EQ(uart("uart0 send \"a\"\nexpect uart0 \"a\" within 150us"), "");
  EXPECT_THAT(uart("uart0 send \"a\"\nexpect uart0 \"a\" within 143us"),
              testing::AnyOf(HasSubstr("nothing"), HasSubstr("it came")));
  EXPECT_EQ(uart("wait usb within 1ms"), "2: no serial port on the USB");
}

/// A script's result is the same with other observers, and each time.
TEST(ScriptRunner, IsDeterministic) {
  const auto failure = [](bool every_clock) {
    Rig rig(lamplock::test::pin_image(),
            booted +
                "pulse gpio8 3us every 7us times 50\n"
                "expect gpio9 rise within 5cycles..6cycles of gpio8 rise times 50");
    if (every_clock) rig.chip.pio_dma().set_step_every_clock(true);
    return rig.outcome();
  };
  const std::string first = failure(false);
  EXPECT_THAT(first, HasSubstr("cycles) after gpio8 rise"));
  EXPECT_EQ(failure(false), first);
  EXPECT_EQ(failure(true), first);
}

}  // namespace
}  // namespace lamplock::sim::chip::script::script_test
