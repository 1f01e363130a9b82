// The stored state of a program, encoded to bytes and decoded.
#include "firmware/machine/console/persistent_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/machine/random_persistent_state.hpp"
#include "tests/scale.hpp"

namespace lamplock::machine {
namespace {

using program::max_position_e7;
using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937_64;

Bytes packed(const PersistentState& kept) {
  Bytes bytes(PersistentStateRecord::format.most, 0xff);
  const std::uint32_t size = PersistentStateRecord::put(kept, bytes);
  EXPECT_LE(size, PersistentStateRecord::max_bytes);
  bytes.resize(size);
  return bytes;
}

struct Unpacked {
  PersistentState kept;
  std::uint32_t unknown = 0;
};
Unpacked unpacked(const Bytes& bytes) {
  Unpacked result;
  result.unknown = PersistentStateRecord::take(result.kept, bytes);
  return result;
}

/// The format described in the header, implemented independently.
Bytes places(std::uint8_t kind, const std::vector<std::int64_t>& values) {
  Bytes bytes{kind, static_cast<std::uint8_t>(values.size() * 8)};
  for (const std::int64_t value : values)
    for (int i = 0; i < 64; i += 8)
      bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> i));
  return bytes;
}
Bytes piece(std::uint8_t kind, const std::string& text) {
  Bytes bytes{kind, static_cast<std::uint8_t>(text.size())};
  for (const char c : text) bytes.push_back(static_cast<std::uint8_t>(c));
  return bytes;
}
Bytes record(std::initializer_list<Bytes> pieces, std::uint8_t version = 1) {
  Bytes bytes{version};
  for (const Bytes& one : pieces) bytes.insert(bytes.end(), one.begin(), one.end());
  return bytes;
}

PersistentState some_program() {
  PersistentState kept;
  kept.parameters.systems_e7[0] = {1, -2, 3, -max_position_e7};
  kept.parameters.systems_e7[8] = {0, 0, 2 * max_position_e7, 0};
  kept.parameters.home_g28_e7 = {5, 6, 7, 8};
  kept.parameters.home_g30_e7 = {-1, 0, 0, 0};
  EXPECT_TRUE(kept.start_up[0].set("G21"));
  EXPECT_TRUE(kept.start_up[1].set("G54 G90"));
  EXPECT_TRUE(kept.build_text.set("the left one"));
  return kept;
}
const Bytes some_bytes =
    record({places(0, {1, -2, 3, -max_position_e7}), places(8, {0, 0, 2 * max_position_e7, 0}),
            places(9, {5, 6, 7, 8}), places(10, {-1, 0, 0, 0}), piece(32, "G21"),
            piece(33, "G54 G90"), piece(48, "the left one")});

TEST(PersistentState, HasTheDocumentedBytes) {
  EXPECT_EQ(packed(PersistentState{}), Bytes{1});
  EXPECT_EQ(packed(some_program()), some_bytes);
  const Unpacked back = unpacked(some_bytes);
  EXPECT_EQ(back.kept, some_program());
  EXPECT_EQ(back.unknown, 0u);
}

TEST(PersistentState, IsDecodedUnchanged) {
  Random random(6100);
  std::size_t longest = 0;
  for (int i = 0; i < test::scaled(20'000); ++i) {
    const PersistentState kept = test::random_persistent_state(random);
    const Bytes bytes = packed(kept);
    longest = std::max(longest, bytes.size());
    const Unpacked back = unpacked(bytes);
    ASSERT_EQ(back.kept, kept);
    ASSERT_EQ(back.unknown, 0u);
    ASSERT_EQ(back.kept.parameters.shift_e7, program::Place{});
    ASSERT_EQ(back.kept.parameters.tool_length_e7, kept.parameters.tool_length_e7);
    ASSERT_EQ(back.kept.parameters.changed, 0);
  }
  EXPECT_GT(longest, 2 * settings::flash_page);
}

TEST(PersistentState, TheLongestStateFits) {
  PersistentState kept;
  kept.parameters.systems_e7.fill({1, 1, 1, 1});
  kept.parameters.rotations_e7.fill(1);
  kept.parameters.home_g28_e7 = kept.parameters.home_g30_e7 = {1, 1, 1, 1};
  kept.parameters.tool_length_e7 = 1;
  for (std::uint32_t number = 1; number <= program::ToolTable::capacity; ++number)
    ASSERT_TRUE(kept.parameters.tools.set(program::ToolTable::Entry(number, {})));
  for (KeptText* text : {&kept.start_up[0], &kept.start_up[1], &kept.build_text})
    ASSERT_TRUE(text->set(std::string(80, '~')));
  EXPECT_EQ(packed(kept).size(), PersistentStateRecord::max_bytes);
  EXPECT_EQ(unpacked(packed(kept)).kept, kept);
}

TEST(PersistentState, EachFieldChangesTheBytes) {
  const std::vector<std::function<void(PersistentState&)>> changes{
      [](PersistentState& k) { k.parameters.systems_e7[8][3] = 1; },
      [](PersistentState& k) { k.parameters.rotations_e7[0] = 1; },
      [](PersistentState& k) { k.parameters.rotations_e7[8] = -1; },
      [](PersistentState& k) { k.parameters.home_g28_e7[0] = 1; },
      [](PersistentState& k) { k.parameters.home_g30_e7[2] = 1; },
      [](PersistentState& k) { k.parameters.tool_length_e7 = -1; },
      [](PersistentState& k) { k.parameters.tools.set(program::ToolTable::Entry(255, {})); },
      [](PersistentState& k) {
        k.parameters.tools.set(program::ToolTable::Entry(1, {-10, 1000}));
      },
      [](PersistentState& k) { k.start_up[0].set("x"); },
      [](PersistentState& k) { k.start_up[1].set("x"); },
      [](PersistentState& k) { k.build_text.set("x"); }};
  for (const auto& change : changes) {
    PersistentState kept;
    change(kept);
    EXPECT_FALSE(kept == PersistentState{});
    EXPECT_EQ(unpacked(packed(kept)).kept, kept);
  }
  PersistentState same;
  same.parameters.shift_e7[0] = same.parameters.changed = 1;
  EXPECT_EQ(same, PersistentState{});
}

TEST(PersistentState, ClearingPlacesKeepsTexts) {
  PersistentState kept = some_program();
  kept.clear_places();
  EXPECT_EQ(kept.parameters.systems_e7, program::Parameters{}.systems_e7);
  EXPECT_EQ(packed(kept),
            record({piece(32, "G21"), piece(33, "G54 G90"), piece(48, "the left one")}));
}

TEST(PersistentState, TextsAreEightyPrintableCharacters) {
  KeptText text;
  EXPECT_TRUE(text.set(std::string(80, 'x')));
  EXPECT_TRUE(text.set("G54"));
  EXPECT_FALSE(text.set(std::string(81, 'x')));
  EXPECT_FALSE(text.set("a\nb"));
  EXPECT_FALSE(text.set("a\x7f"));
  EXPECT_FALSE(text.set("\xc3\xa4"));
  EXPECT_EQ(text.view(), "G54");
  KeptText other;
  EXPECT_FALSE(other == text);
  EXPECT_TRUE(other.set("G55"));
  EXPECT_FALSE(other == text);
  EXPECT_TRUE(text.set(""));
  EXPECT_EQ(text, KeptText{});
}

TEST(PersistentState, UnknownFieldsAreSkipped) {
  const auto after = [](const Bytes& strange) {
    return unpacked(record({piece(32, "G21"), strange, piece(33, "G54")}));
  };
  PersistentState wanted;
  wanted.start_up[0].set("G21");
  wanted.start_up[1].set("G54");
  for (const Bytes& strange :
       {places(11, {1, 2, 3, 4}), piece(34, "M3"), piece(200, ""), places(0, {1, 2, 3}),
        places(9, {1, 2, 3, 4, 5}), piece(48, std::string(81, 'x')), piece(48, "a\rb"),
        places(0, {0, 0, 0, 2 * max_position_e7 + 1}),
        places(8, {-2 * max_position_e7 - 1, 0, 0, 0}), places(9, {0, max_position_e7 + 1, 0, 0}),
        places(10, {0, 0, -max_position_e7 - 1, 0}),
        places(10, {0, 0, std::numeric_limits<std::int64_t>::min(), 0})}) {
    EXPECT_EQ(after(strange).kept, wanted);
    EXPECT_EQ(after(strange).unknown, 1u);
  }
}

TEST(PersistentState, ARecordOfAnotherVersionIsIgnored) {
  for (const int version : {0, 2, 255}) {
    Bytes bytes = some_bytes;
    bytes[0] = static_cast<std::uint8_t>(version);
    EXPECT_EQ(unpacked(bytes).kept, PersistentState{});
    EXPECT_EQ(unpacked(bytes).unknown, 1u);
  }
  EXPECT_EQ(unpacked({}).unknown, 1u);
}

TEST(PersistentState, ATruncatedRecordGivesItsCompleteFields) {
  for (std::size_t size = 1; size < some_bytes.size(); ++size) {
    const Unpacked part =
        unpacked({some_bytes.begin(), some_bytes.begin() + static_cast<long>(size)});
    Bytes again = packed(part.kept);
    ASSERT_LE(again.size(), size);
    ASSERT_TRUE(std::equal(again.begin(), again.end(), some_bytes.begin()));
    ASSERT_EQ(part.unknown, again.size() == size ? 0u : 1u);
  }
}

bool in_range(const program::Place& place, std::int64_t most) {
  return std::all_of(place.begin(), place.end(),
                     [most](auto v) { return v >= -most && v <= most; });
}

TEST(PersistentState, AnyBytesGiveAStateThatAnInterpreterAccepts) {
  Random random(6200);
  for (int i = 0; i < test::scaled(50'000); ++i) {
    Bytes bytes = packed(test::random_persistent_state(random));
    for (auto n = 1 + random() % 8; n != 0; --n)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    const PersistentState kept = unpacked(bytes).kept;
    for (const program::Place& origin : kept.parameters.systems_e7)
      ASSERT_TRUE(in_range(origin, 2 * max_position_e7));
    ASSERT_TRUE(in_range(kept.parameters.home_g28_e7, max_position_e7));
    ASSERT_TRUE(in_range(kept.parameters.home_g30_e7, max_position_e7));
    for (const KeptText& text : {kept.start_up[0], kept.start_up[1], kept.build_text})
      for (const char c : text.view()) ASSERT_TRUE(c >= ' ' && c <= '~');
    ASSERT_EQ(unpacked(packed(kept)).kept, kept);
  }
}

}  // namespace
}  // namespace lamplock::machine
