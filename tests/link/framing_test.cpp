// Framing: intact frames arrive, damaged ones do not, and text and frames never mix.
#include "shared/wire/framing.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/scale.hpp"

namespace lamplock::wire {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Everything a parser reports.
struct Log {
  std::vector<Bytes> frames;
  std::vector<std::string> lines;
  Bytes realtime;
  int bad_frames = 0;
  int lost_lines = 0;
  void on_realtime(std::uint8_t byte) { realtime.push_back(byte); }
  void on_frame(std::span<const std::uint8_t> content) {
    frames.emplace_back(content.begin(), content.end());
  }
  void on_bad_frame() { ++bad_frames; }
  void on_line(std::string_view line) { lines.emplace_back(line); }
  void on_lost_line() { ++lost_lines; }
};

template <End end = End::device>
Log parse(const Bytes& bytes) {
  StreamParser<end> parser;
  Log log;
  for (const std::uint8_t byte : bytes) parser.push(byte, log);
  return log;
}

Bytes frame_of(const Bytes& content) {
  Bytes frame(max_frame);
  frame.resize(encode_frame(content, frame));
  return frame;
}

Bytes text(std::string_view line) { return {line.begin(), line.end()}; }

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes random_content(std::mt19937_64& random, std::size_t size) {
  Bytes content(size);
  for (auto& byte : content) byte = static_cast<std::uint8_t>(random());
  return content;
}

TEST(Crc32, HasTheCheckValueOfTheStandard) {
  EXPECT_EQ(crc32(text("123456789")), 0xCBF43926u);
  EXPECT_EQ(crc32(text("6789"), crc32(text("12345"))), 0xCBF43926u);
}

RC_GTEST_PROP(Framing, RoundTrip, (const std::vector<Bytes>& contents)) {
  Bytes stream;
  for (const Bytes& content : contents) stream = stream + frame_of(content);
  const Log log = parse(stream);
  RC_ASSERT(log.frames == contents);
  RC_ASSERT(log.bad_frames == 0);
  RC_ASSERT(log.lines.empty() && log.realtime.empty());
  RC_ASSERT(parse<End::host>(stream).frames == contents);
}

TEST(Framing, NoForbiddenByteEverOccurs) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(300); ++i) {
    const Bytes frame = frame_of(random_content(random, random() % (max_content - crc_size + 1)));
    ASSERT_GE(frame.size(), 2u);
    EXPECT_EQ(frame.front(), frame_start);
    EXPECT_EQ(frame.back(), frame_end);
    for (std::size_t k = 1; k + 1 < frame.size(); ++k) {
      const std::uint8_t b = frame[k];
      // Written out, so that the test is independent of the function under test.
      const bool forbidden = b == 0x18 || b == '?' || b == '!' || b == '~' || b == '\r' ||
                             b == '\n' || b == 2 || b == 3 || b == 0x11 || b == 0x13 ||
                             (b >= 0x80 && b <= 0xAF);
      ASSERT_FALSE(forbidden) << int{b};
    }
  }
}

TEST(Framing, LongestContentFitsAndOneMoreDoesNot) {
  const Bytes longest(max_content - crc_size, 0x80);
  EXPECT_EQ(parse(frame_of(longest)).frames.size(), 1u);
  EXPECT_TRUE(frame_of(Bytes(max_content - crc_size + 1, 0x41)).empty());
  // A longer frame, built by hand, is dropped without effect on the next.
  const Bytes giant = Bytes{frame_start} + Bytes(5000, 'A') + Bytes{frame_end};
  const Log log = parse(giant + frame_of({1, 2, 3}));
  EXPECT_EQ(log.frames, std::vector<Bytes>({{1, 2, 3}}));
  EXPECT_EQ(log.bad_frames, 1);
}

TEST(Framing, EverySingleBitFlipIsRejected) {
  std::mt19937_64 random(2);
  const Bytes content = random_content(random, 200);
  const Bytes frame = frame_of(content);
  for (std::size_t at = 0; at < frame.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      Bytes broken = frame;
      broken[at] = static_cast<std::uint8_t>(broken[at] ^ (1u << bit));
      // The following frame must arrive whatever happens to this one.
      const Log log = parse(broken + frame_of({7}));
      ASSERT_EQ(log.frames, std::vector<Bytes>({{7}})) << at << " " << bit;
      // One flipped bit turns the frame start into a line feed: a blank line without effect.
      for (const std::string& line : log.lines) ASSERT_EQ(line, "");
    }
}

TEST(Framing, EveryTruncationIsRejected) {
  std::mt19937_64 random(3);
  const Bytes frame = frame_of(random_content(random, 120));
  for (std::size_t size = 0; size < frame.size(); ++size) {
    const Bytes head(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size));
    const Bytes tail(frame.begin() + static_cast<std::ptrdiff_t>(size), frame.end());
    ASSERT_EQ(parse(head + frame_of({7})).frames, std::vector<Bytes>({{7}})) << size;
    if (size == 0) continue;
    const Log log = parse(tail + frame_of({7}));
    ASSERT_EQ(log.frames, std::vector<Bytes>({{7}})) << size;
    ASSERT_TRUE(log.lines.empty());
  }
}

TEST(Framing, DroppedAndDoubledBytesAreRejected) {
  std::mt19937_64 random(4);
  const Bytes content = random_content(random, 150);
  const Bytes frame = frame_of(content);
  for (std::size_t at = 0; at < frame.size(); ++at) {
    const auto place = frame.begin() + static_cast<std::ptrdiff_t>(at);
    Bytes dropped = frame;
    dropped.erase(dropped.begin() + static_cast<std::ptrdiff_t>(at));
    ASSERT_EQ(parse(dropped + frame_of({7})).frames, std::vector<Bytes>({{7}})) << at;
    Bytes doubled = frame;
    doubled.insert(doubled.begin() + static_cast<std::ptrdiff_t>(at), *place);
    const bool harmless = *place == frame_start || *place == frame_end;
    ASSERT_EQ(parse(doubled + frame_of({7})).frames.size(), harmless ? 2u : 1u) << at;
  }
}

TEST(Framing, RealtimeBytesAreRemovedFromFramesAndLinesAnywhere) {
  std::mt19937_64 random(5);
  const Bytes content = random_content(random, 60);
  const Bytes frame = frame_of(content);
  for (std::size_t at = 0; at <= frame.size(); ++at)
    for (const std::uint8_t byte : Bytes{0x18, '?', '!', '~', 0x80, 0x85, 0x9E, 0xAF}) {
      Bytes stream = frame;
      stream.insert(stream.begin() + static_cast<std::ptrdiff_t>(at), byte);
      const Log log = parse(stream);
      ASSERT_EQ(log.frames, std::vector<Bytes>({content}));
      ASSERT_EQ(log.realtime, Bytes({byte}));
    }
  const Log log = parse(text("G1?X1!0\n"));
  EXPECT_EQ(log.lines, std::vector<std::string>({"G1X10"}));
  EXPECT_EQ(log.realtime, text("?!"));
}

TEST(Framing, FlowControlBytesAreDropped) {
  const Bytes frame = frame_of({1, 2, 3, 0x11, 0x13});
  for (std::size_t at = 1; at < frame.size(); ++at) {
    Bytes stream = frame;
    stream.insert(stream.begin() + static_cast<std::ptrdiff_t>(at), xoff);
    EXPECT_EQ(parse(stream).frames.size(), 1u);
  }
  EXPECT_EQ(parse(text("G1\x13X1\x11\n")).lines, std::vector<std::string>({"G1X1"}));
}

TEST(Framing, NeedlessEscapeIsRejected) {
  // 0x01 escaped: decodes to contents with the right CRC, but no encoder produces it.
  Bytes frame = frame_of({0x01, 0x05});
  ASSERT_EQ(frame[1], 0x01);
  frame[1] = 0x41;
  frame.insert(frame.begin() + 1, escape);
  EXPECT_TRUE(parse(frame).frames.empty());
}

TEST(Lines, EndsAreCrLfOrBoth) {
  const Log log = parse(text("a\nb\rc\r\n\r\n\n\rd\n"));
  EXPECT_EQ(log.lines, std::vector<std::string>({"a", "b", "c", "", "", "", "d"}));
}

TEST(Lines, LongestLineFitsAndOneMoreIsAnsweredOnce) {
  const std::string longest(max_line, 'x');
  const Log log = parse(text(longest + "\n" + longest + "y\nz\n"));
  EXPECT_EQ(log.lines, std::vector<std::string>({longest, "z"}));
  EXPECT_EQ(log.lost_lines, 1);
}

TEST(Lines, HighBytesOutsideFramesAreDropped) {
  const Log log = parse(text("G1\xC2\x90X1\n"));  // feed override as a UTF-8 sender writes it
  EXPECT_EQ(log.lines, std::vector<std::string>({"G1X1"}));
  EXPECT_EQ(log.realtime, Bytes({0x90}));
}

TEST(Lines, FrameStartDropsTheUnfinishedLine) {
  const Log log = parse(text("G1 X1") + frame_of({9}) + text("0\n"));
  EXPECT_EQ(log.frames.size(), 1u);
  EXPECT_EQ(log.lines, std::vector<std::string>({"0"}));
}

TEST(Lines, AnUnfinishedLineCanBeDroppedFromWithinAnEvent) {
  struct Dropping : Log {
    explicit Dropping(StreamParser<End::device>& its) : parser(its) {}
    void on_realtime(std::uint8_t) { parser.reset(); }
    StreamParser<End::device>& parser;
  };
  StreamParser<End::device> parser;
  Dropping log(parser);
  for (const std::uint8_t byte : text("half\x18whole\nspoilt\x01\x18whole\n"))
    parser.push(byte, log);
  EXPECT_EQ(log.lines, std::vector<std::string>({"whole", "whole"}));
  EXPECT_EQ(log.lost_lines, 0);
}

TEST(Lines, LineEndInAFrameIsAnsweredByAnError) {
  Bytes cut = frame_of(Bytes(50, 'A'));
  cut.pop_back();
  const Log log = parse(cut + text("$H\n$I\n"));
  EXPECT_EQ(log.bad_frames, 1);
  EXPECT_EQ(log.lost_lines, 1);
  EXPECT_EQ(log.lines, std::vector<std::string>({"$I"}));
}

TEST(Lines, RestOfAFrameIsNeverExecuted) {
  Bytes headless = frame_of(text("$H"));
  headless.erase(headless.begin());
  const Log log = parse(headless + text("$X\n$I\n"));
  EXPECT_EQ(log.lost_lines, 1);
  EXPECT_EQ(log.lines, std::vector<std::string>({"$I"}));
}

/// Each line end is answered once; a line with one flipped bit is executed unchanged, with one
/// other character, or not at all, but never in part.
TEST(Lines, AFlippedBitNeverLeavesPartOfALine) {
  const std::string line = "G1 X10 F600";
  for (std::size_t at = 0; at < line.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      Bytes bytes = text(line + "\n");
      bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << bit));
      if (bytes[at] == '\r' || bytes[at] == '\n')
        continue;  // a flipped end changes the number of lines
      const Log log = parse(bytes);
      ASSERT_EQ(log.lines.size() + static_cast<std::size_t>(log.lost_lines), 1u);
      if (log.lost_lines == 0) {
        ASSERT_GE(log.lines[0].size() + 1, line.size());
      }
    }
}

/// For any input the parser reports no frame that was not sent, and recovers.
TEST(Framing, NoiseIsHarmless) {
  std::mt19937_64 random(6);
  for (int i = 0; i < test::scaled(200); ++i) {
    const Log log =
        parse(random_content(random, 2000) + Bytes{'\n'} + frame_of({1, 2}) + text("ok\n"));
    ASSERT_EQ(log.frames, std::vector<Bytes>({{1, 2}}));
    ASSERT_FALSE(log.lines.empty());
    ASSERT_EQ(log.lines.back(), "ok");
  }
}

}  // namespace
}  // namespace lamplock::wire
