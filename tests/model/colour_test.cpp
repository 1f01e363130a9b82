// Colours of curves: texts, AutoCAD's index, and what DXF and SVG files say of their curves.
#include "host/model/colour.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/model/read_dxf.hpp"
#include "host/model/read_svg.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::model::colour_test {
namespace {

TEST(Colours, texts_of_css) {
  for (const char* red : {"red",
                          "RED",
                          " red ",
                          "#f00",
                          "#ff0000",
                          "#F00f",
                          "#ff000080",
                          "rgb(255,0,0)",
                          "rgb(255, 0, 0)",
                          "rgb(100% 0% 0%)",
                          "rgba(255,0,0,.5)",
                          "rgb(300, -5, 0)",
                          "rgb(255 none 0 / 50%)",
                          "#f00 icc-color(p, 1, 0)",
                          "hsl(0, 100%, 50%)",
                          "HSL(0 100% 50%)",
                          "hsla(-360deg, 100%, 50%, 0.5)",
                          "hsl(720 100 50 / .3)",
                          "hsl(400grad 120% 50%)",
                          "hsl(none 100% 50%)",
                          "hwb(1turn 0% 0%)",
                          "hwb(0 0 0 / 1)"})
    EXPECT_EQ(colour_named(red), 0xff0000u) << red;
  EXPECT_EQ(colour_named("aliceblue"), 0xf0f8ffu);
  EXPECT_EQ(colour_named("yellowgreen"), 0x9acd32u);
  EXPECT_EQ(colour_named("green"), 0x008000u);
  EXPECT_EQ(colour_named("lime"), 0x00ff00u);
  EXPECT_EQ(colour_named("grey"), colour_named("gray"));
  EXPECT_EQ(colour_named("rebeccapurple"), 0x663399u);
  for (const char* none : {"",
                           "none",
                           "url(#a)",
                           "#ff",
                           "#ggg",
                           "#12345",
                           "rgb(1,2)",
                           "rgb(",
                           "rgb(a,b,c)",
                           "rgb(1,2,3,4,5)",
                           "rgb(1deg,2,3)",
                           "hsl(1)",
                           "hsl(1,2px,3)",
                           "hsl(1foo 2% 3%)",
                           "hwb()",
                           "xrgb(1,2,3)",
                           "icc-color(p, 1)",
                           "reddish",
                           "aaaa",
                           "zzzz",
                           "currentColor"})
    EXPECT_FALSE(colour_named(none)) << none;
  EXPECT_EQ(colour_text(0x00ff7fu), "#00ff7f");
  EXPECT_EQ(colour_text(no_colour), "");
}

/// Values of the named colours of CSS in other forms.
TEST(Colours, functions_of_css) {
  const std::vector<std::pair<const char*, const char*>> known{
      {"hsl(120, 100%, 50%)", "lime"},   {"hsl(120deg 100% 25.1%)", "green"},
      {"hsl(240,100%,50%)", "blue"},     {"hsl(3.14159265rad 100% 50%)", "cyan"},
      {"hsl(38.82 100% 50%)", "orange"}, {"hsl(270 50% 40%)", "rebeccapurple"},
      {"hsl(77 0% 100%)", "white"},      {"hsl(77 100% 0%)", "black"},
      {"hsl(210 14% 53%)", "#768798"},   {"hwb(90 0% 50%)", "#408000"},
      {"hwb(120 0% 0%)", "lime"},        {"hwb(195 0% 0%)", "deepskyblue"},
      {"hwb(77 50.2% 49.8%)", "grey"},   {"hwb(77 100% 100%)", "grey"}};
  for (const auto& [function, name] : known)
    EXPECT_EQ(colour_text(colour_named(function).value_or(no_colour)),
              colour_text(*colour_named(name)))
        << function;
}

/// Values of AutoCAD's table.
TEST(Colours, index_of_autocad) {
  const std::vector<std::pair<int, Colour>> known{
      {1, 0xff0000},   {2, 0xffff00},  {3, 0x00ff00},   {4, 0x00ffff},   {5, 0x0000ff},
      {6, 0xff00ff},   {7, 0x000000},  {10, 0xff0000},  {11, 0xff7f7f},  {12, 0xa50000},
      {14, 0x7f0000},  {16, 0x4c0000}, {20, 0xff3f00},  {30, 0xff7f00},  {40, 0xffbf00},
      {50, 0xffff00},  {90, 0x00ff00}, {130, 0x00ffff}, {170, 0x0000ff}, {210, 0xff00ff},
      {250, 0x333333}, {255, 0xffffff}};
  for (const auto& [number, colour] : known)
    EXPECT_EQ(colour_of_aci(number), colour)
        << number << " " << colour_text(*colour_of_aci(number));
  for (const int none : {0, -1, 256, 1000}) EXPECT_FALSE(colour_of_aci(none)) << none;
}

std::vector<std::string> colours_of(const Curves& curves) {
  std::vector<std::string> colours;
  for (const Path& path : curves.paths) colours.push_back(colour_text(path.colour));
  return colours;
}

std::string line_entity(const std::string& more, int y) {
  return "0\nLINE\n" + more + "10\n0\n20\n" + std::to_string(y) + "\n11\n9\n21\n" +
         std::to_string(y) + "\n";
}

TEST(Colours, of_a_dxf_are_by_entity_layer_or_block) {
  const test::TemporaryFolder folder;
  const std::string text =
      "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n"
      "0\nLAYER\n2\nA\n70\n0\n62\n3\n0\nLAYER\n2\nB\n70\n0\n62\n5\n420\n1193046\n0\nENDTAB\n0\n"
      "ENDSEC\n0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nK\n" +
      line_entity("8\n0\n62\n0\n", 1) + line_entity("8\n0\n", 2) + line_entity("8\nA\n", 3) +
      line_entity("8\nA\n62\n2\n", 4) + "0\nENDBLK\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n" +
      line_entity("8\nA\n", 5) + line_entity("8\nB\n62\n256\n", 6) +
      line_entity("8\nB\n62\n6\n", 7) + line_entity("8\nB\n62\n6\n420\n255\n", 8) +
      line_entity("8\nC\n", 9) +
      "0\nINSERT\n8\nB\n62\n1\n2\nK\n10\n50\n20\n0\n"
      "0\nENDSEC\n0\nEOF\n";
  EXPECT_EQ(colours_of(read_dxf(folder.write("a.dxf", text))),
            (std::vector<std::string>{"#00ff00", "#123456", "#ff00ff", "#0000ff", "", "#ff0000",
                                      "#123456", "#00ff00", "#ffff00"}));
}

TEST(Colours, of_an_svg_are_those_of_the_stroke_or_the_fill) {
  const test::TemporaryFolder folder;
  const std::string text =
      "<svg xmlns='http://www.w3.org/2000/svg' width='90' height='90'><g stroke='blue'>"
      "<rect width='5' height='5'/><rect x='9' width='5' height='5' style='stroke:#0f0'/></g>"
      "<rect x='19' width='5' height='5' fill='rgb(1,2,3)'/>"
      "<rect x='29' width='5' height='5'/>"
      "<rect x='39' width='5' height='5' fill='red' stroke='none'/></svg>";
  EXPECT_EQ(colours_of(read_svg(folder.write("a.svg", text))),
            (std::vector<std::string>{"#0000ff", "#00ff00", "#010203", "#000000", "#ff0000"}));
}

/// currentColor is the property color where it is used: SVG 2, 13.2; CSS Color Module Level 4.
TEST(Colours, of_an_svg_may_be_the_current_colour) {
  const test::TemporaryFolder folder;
  const auto colours = [&](const std::string& root, const std::string& elements) {
    return colours_of(read_svg(
        folder.write("a.svg", "<svg xmlns='http://www.w3.org/2000/svg' width='90' height='90' " +
                                  root + ">" + elements + "</svg>")));
  };
  using Texts = std::vector<std::string>;
  const std::string icon = "fill='none' stroke='currentColor'";
  const std::string line = "<path d='M0 0L9 9'/>";
  EXPECT_EQ(colours(icon, line), Texts{"#000000"}) << "black by default";
  EXPECT_EQ(colours(icon + " color='red'", line), Texts{"#ff0000"});
  EXPECT_EQ(colours("", "<g color='blue'><path d='M0 0L9 9' stroke='CURRENTCOLOR'/></g>"),
            Texts{"#0000ff"});
  EXPECT_EQ(
      colours(icon, "<path color='lime' d='M0 0L9 9'/><path style='color:#123456' d='M0 9L9 9'/>"),
      (Texts{"#00ff00", "#123456"}))
      << "the keyword is inherited, not the colour";
  EXPECT_EQ(colours("color='red'", "<rect width='5' height='5' fill='currentColor'/>"),
            Texts{"#ff0000"});
  EXPECT_EQ(
      colours("color='red' " + icon, "<g color='nonsense'>" + line + "</g><g color='inherit'>" +
                                         line + "</g><g color='currentColor'>" + line +
                                         "</g><g style='color:initial'>" + line + "</g>"),
      (Texts{"#ff0000", "#ff0000", "#ff0000", "#000000"}));
  EXPECT_EQ(colours("",
                    "<style>.a{color:blue}</style><g class='a'><path stroke='currentColor' "
                    "d='M0 0L9 9'/></g>"),
            Texts{"#0000ff"});
}

}  // namespace
}  // namespace lamplock::model::colour_test
