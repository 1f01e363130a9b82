// Text entities of DXF files: characters, formatting codes, places.
#include "host/model/dxf_text.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/model/read_dxf.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::model::dxf_text_test {
namespace {

using testing::ElementsAre;

TEST(DxfText, characters) {
  EXPECT_EQ(dxf_characters("plain"), "plain");
  EXPECT_EQ(dxf_characters("45%%d %%p1 %%c8 100%%%"),
            "45\xc2\xb0 \xc2\xb1"
            "1 \xc3\x98"
            "8 100%");
  EXPECT_EQ(dxf_characters("%%uline%%u %%065"), "line A");
  EXPECT_EQ(dxf_characters("\\U+2300 \\U+00e4"), "\xe2\x8c\x80 \xc3\xa4");
  EXPECT_EQ(dxf_characters("M\xfcnchen"), "M\xc3\xbcnchen") << "ISO 8859-1";
  EXPECT_EQ(dxf_characters("M\xc3\xbcnchen"), "M\xc3\xbcnchen");
  for (const char* whole : {"%", "%%", "%%x", "%%12", "\\U+12", "\\U+ghij", "\\"})
    EXPECT_EQ(dxf_characters(whole), whole);
}

TEST(DxfText, lines_without_formatting) {
  EXPECT_THAT(dxf_lines("one\\Ptwo^Jthree"), ElementsAre("one", "two", "three"));
  EXPECT_THAT(dxf_lines("{\\fArial|b1|i0;bold \\H2x;tall} \\C1;red"), ElementsAre("bold tall red"));
  EXPECT_THAT(dxf_lines("\\A1;a\\~b \\Lunder\\l \\\\ \\{\\}"), ElementsAre("a\xc2\xa0"
                                                                           "b under \\ {}"));
  EXPECT_THAT(dxf_lines("\\S1/2; \\S+0.1^-0.2; \\S3#4;"), ElementsAre("1/2 +0.1/-0.2 3/4"));
  EXPECT_THAT(dxf_lines("%%c5 \\U+00B0 a^Ib ^ c"), ElementsAre("\xc3\x98"
                                                               "5 \xc2\xb0 a b ^c"));
  EXPECT_THAT(dxf_lines(""), ElementsAre(""));
  for (const char* broken : {"\\", "\\f", "\\fArial", "\\S", "\\S1", "^", "{", "}", "\\H2x"})
    EXPECT_EQ(dxf_lines(broken).size(), 1u) << broken;
}

std::vector<TextBlock> texts_of(const std::string& entities, const std::string& blocks = "") {
  const lamplock::test::TemporaryFolder folder;
  return read_dxf_with_texts(
             folder.write("a.dxf",
                          fmt::format("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\n"
                                      "SECTION\n2\nBLOCKS\n{}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
                                      "{}0\nENDSEC\n0\nEOF\n",
                                      blocks, entities)))
      .texts;
}

void expect_at(const TextBlock& block, const geometry::Point& of, double x, double y) {
  const geometry::Point at = block.frame(of);
  EXPECT_NEAR(at.x, x, 1e-9);
  EXPECT_NEAR(at.y, y, 1e-9);
}

TEST(DxfText, places_of_lines) {
  const std::string begin = "0\nTEXT\n8\nL\n62\n1\n10\n5\n20\n7\n40\n2\n1\nAbc\n";
  const TextBlock plain = texts_of(begin).at(0);
  EXPECT_THAT(plain.lines, ElementsAre("Abc"));
  EXPECT_EQ(plain.colour, 0xff0000u);
  expect_at(plain, {0, 0, 0}, 5, 7);
  expect_at(plain, {1, 1, 0}, 7, 9);
  expect_at(texts_of(begin + "50\n90\n41\n0.5\n").at(0), {1, 1, 0}, 3, 8);
  expect_at(texts_of(begin + "51\n45\n").at(0), {0, 1, 0}, 7, 9);
  expect_at(texts_of(begin + "71\n2\n").at(0), {1, 1, 0}, 3, 9);
  expect_at(texts_of(begin + "71\n4\n").at(0), {1, 1, 0}, 7, 5);
  const TextBlock right = texts_of(begin + "11\n20\n21\n30\n72\n2\n73\n3\n").at(0);
  EXPECT_EQ(right.align, 1);
  EXPECT_EQ(right.anchor, TextAnchor::top);
  expect_at(right, {0, 0, 0}, 20, 30);
  const TextBlock middle = texts_of(begin + "11\n20\n21\n30\n72\n4\n").at(0);
  EXPECT_EQ(middle.align, 0.5);
  EXPECT_EQ(middle.anchor, TextAnchor::middle);
  for (const bool is_aligned : {true, false}) {
    const TextBlock between =
        texts_of(begin + "11\n5\n21\n17\n72\n" + (is_aligned ? "3" : "5") + "\n").at(0);
    EXPECT_EQ(between.fit_width, 5) << "10 mm in heights of 2 mm";
    EXPECT_EQ(between.fits_height, is_aligned);
    expect_at(between, {5, 0, 0}, 5, 17);
  }
  // A mirrored entity: X is to the left.
  expect_at(texts_of(begin + "210\n0\n220\n0\n230\n-1\n").at(0), {1, 1, 0}, -7, 9);
}

TEST(DxfText, places_of_paragraphs_and_blocks) {
  const std::string begin = "0\nMTEXT\n8\nL\n10\n5\n20\n7\n40\n2\n3\none\\Pt\n1\nwo\n";
  const TextBlock plain = texts_of(begin).at(0);
  EXPECT_THAT(plain.lines, ElementsAre("one", "two"));
  EXPECT_EQ(plain.anchor, TextAnchor::top);
  EXPECT_NEAR(plain.line_step, 5.0 / 3, 1e-12);
  expect_at(plain, {1, 1, 0}, 7, 9);
  const TextBlock other = texts_of(begin + "41\n30\n44\n2\n71\n6\n50\n90\n").at(0);
  EXPECT_EQ(other.align, 1);
  EXPECT_EQ(other.anchor, TextAnchor::middle);
  EXPECT_EQ(other.wrap_width, 15);
  EXPECT_NEAR(other.line_step, 10.0 / 3, 1e-12);
  expect_at(other, {1, 0, 0}, 5, 9);
  expect_at(texts_of(begin + "50\n30\n11\n0\n21\n1\n").at(0), {1, 0, 0}, 5, 9);
  // In a block, twice as large; an attribute is in the coordinates of the drawing.
  const std::string block = "0\nBLOCK\n2\nK\n10\n0\n20\n0\n" + begin + "0\nENDBLK\n";
  const std::vector<TextBlock> texts = texts_of(
      "0\nINSERT\n8\nL\n2\nK\n10\n100\n20\n0\n41\n2\n42\n2\n66\n1\n"
      "0\nATTRIB\n8\nL\n10\n1\n20\n2\n40\n3\n1\nv\n2\nTAG\n"
      "0\nATTRIB\n8\nL\n10\n1\n20\n2\n40\n3\n1\nhidden\n2\nTAG\n70\n1\n0\nSEQEND\n",
      block);
  ASSERT_EQ(texts.size(), 2u);
  expect_at(texts[0], {1, 1, 0}, 114, 18);
  EXPECT_THAT(texts[1].lines, ElementsAre("v"));
  expect_at(texts[1], {1, 0, 0}, 4, 2);
}

TEST(DxfText, blank_texts_are_left_out_and_heights_are_checked) {
  EXPECT_TRUE(texts_of("0\nLINE\n10\n0\n20\n0\n11\n1\n21\n1\n0\nTEXT\n40\n1\n1\n \n").empty());
  EXPECT_THROW(texts_of("0\nTEXT\n40\n0\n1\na\n"), Error);
  EXPECT_THROW(texts_of("0\nMTEXT\n40\n-1\n1\na\n"), Error);
}

}  // namespace
}  // namespace lamplock::model::dxf_text_test
