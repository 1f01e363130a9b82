#include "sim/trace/vcd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <sstream>
#include <string>

#include "sim/world/pin_names.hpp"
#include "tests/scale.hpp"
#include "tests/world/recorder.hpp"

namespace lamplock::sim {
namespace {

/// The file as parsed by a reader of the format; anything it does not understand is an error.
struct Dump {
  std::string timescale;
  std::map<std::string, std::string> name_of_code;
  std::map<std::string, std::vector<std::pair<Picoseconds, bool>>> changes;  ///< by name
  std::map<std::string, bool> initial;
  Picoseconds end = -1;
};

std::vector<std::string> until_end(std::istream& in) {
  std::vector<std::string> words;
  for (std::string word; in >> word && word != "$end";) words.push_back(word);
  return words;
}

Dump parse(const std::string& text) {
  Dump dump;
  std::istringstream in(text);
  bool in_header = true, in_dumpvars = false;
  for (std::string word; in >> word;) {
    if (in_header) {
      const auto words = until_end(in);
      if (word == "$timescale")
        dump.timescale = words.at(0) + " " + words.at(1);
      else if (word == "$var")
        dump.name_of_code[words.at(2)] = words.at(3);
      else if (word == "$enddefinitions")
        in_header = false;
      else if (word != "$scope" && word != "$upscope" && word != "$version")
        ADD_FAILURE() << "header: " << word;
    } else if (word[0] == '#') {
      const Picoseconds at = std::stoll(word.substr(1));
      EXPECT_GT(at, dump.end) << "time must increase";
      dump.end = at;
    } else if (word == "$dumpvars") {
      in_dumpvars = true;
    } else if (word == "$end" && in_dumpvars) {
      in_dumpvars = false;
    } else {
      const bool valid = (word[0] == '0' || word[0] == '1') &&
                         dump.name_of_code.count(word.substr(1)) == 1 && dump.end >= 0;
      EXPECT_TRUE(valid) << word;
      if (!valid) break;
      const std::string name = dump.name_of_code[word.substr(1)];
      if (in_dumpvars)
        dump.initial[name] = word[0] == '1';
      else
        dump.changes[name].push_back({dump.end, word[0] == '1'});
    }
  }
  return dump;
}

TEST(Vcd, HeaderNamesEveryWireOnceWithItsLevel) {
  PinBus bus;
  bus.set(Pin::door, true, 0);
  std::ostringstream out;
  { VcdWriter writer(out, bus); }
  const Dump dump = parse(out.str());
  EXPECT_EQ(dump.timescale, "1 ps");
  ASSERT_EQ(dump.name_of_code.size(), pin_count);
  ASSERT_EQ(dump.initial.size(), pin_count);
  for (std::string_view name : pin_names)
    EXPECT_EQ(dump.initial.at(std::string(name)), name == "door") << name;
}

/// Drives random pins in slices, one pin after the other inside a slice; returns the changes.
std::map<std::string, std::vector<std::pair<Picoseconds, bool>>> drive(PinBus& bus, int slices,
                                                                       std::uint64_t seed) {
  std::map<std::string, std::vector<std::pair<Picoseconds, bool>>> done;
  std::mt19937_64 random(seed);
  constexpr Picoseconds slice = ps_per_ms;
  for (int n = 0; n < slices; ++n)
    for (std::size_t pin = 0; pin < pin_count; ++pin) {
      Picoseconds at = n * slice;
      while (random() % 4 != 0) {
        at += 1 + static_cast<Picoseconds>(random() % (slice / 8));
        if (at >= (n + 1) * slice) break;
        const bool level = !bus.level(static_cast<Pin>(pin));
        bus.set(static_cast<Pin>(pin), level, at);
        done[std::string(pin_names[pin])].push_back({at, level});
      }
    }
  return done;
}

TEST(Vcd, ReadsBackExactlyWhatWasDriven) {
  for (int seed = 0; seed < lamplock::test::scaled(5); ++seed) {
    PinBus bus;
    std::ostringstream out;
    VcdWriter writer(out, bus);
    // Enough changes that the writer flushes automatically.
    const auto done = drive(bus, 3000, static_cast<std::uint64_t>(seed));
    writer.finish(10 * ps_per_s);
    const Dump dump = parse(out.str());
    EXPECT_EQ(dump.changes, done);
    EXPECT_EQ(dump.end, 10 * ps_per_s);
    EXPECT_EQ(writer.late_changes(), 0u);
  }
}

TEST(Vcd, FlushWritesCompleteTimesAndKeepsTheRest) {
  PinBus bus;
  std::ostringstream out;
  VcdWriter writer(out, bus);
  bus.set(Pin::step_x, true, 2000);
  bus.set(Pin::step_y, true, 1000);
  writer.flush(2000);
  EXPECT_EQ(parse(out.str()).changes.count("step_x"), 0u);
  EXPECT_EQ(parse(out.str()).changes.at("step_y").at(0).first, 1000);
  bus.set(Pin::step_z, true, 1500);
  writer.finish();
  const Dump dump = parse(out.str());
  EXPECT_EQ(dump.changes.at("step_z").at(0).first, 1500);
  EXPECT_EQ(dump.changes.at("step_x").at(0).first, 2000);
}

TEST(Vcd, ChangesAfterTheirTimeWasWrittenAreCountedAndKeepTheFileValid) {
  PinBus bus;
  std::ostringstream out;
  VcdWriter writer(out, bus);
  bus.set(Pin::step_x, true, 5000);
  writer.flush(6000);
  bus.set(Pin::step_y, true, 4000);
  writer.finish();
  EXPECT_EQ(writer.late_changes(), 1u);
  EXPECT_EQ(parse(out.str()).changes.at("step_y").at(0).first, 5000);
}

}  // namespace
}  // namespace lamplock::sim
