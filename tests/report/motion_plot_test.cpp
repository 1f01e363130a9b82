// Plots of motion: well-formed, complete, inside their frame.
#include "host/report/motion_plot.hpp"

#include <gmock/gmock.h>

#include <cctype>
#include <sstream>

#include "tests/report/traced_run.hpp"

namespace lamplock::test {
namespace {

using report::motion_svg;
using report::MotionSeries;
using testing::HasSubstr;
using testing::Not;

/// The first XML fault of a text: tags that do not match, a stray < or &; empty if there is none.
std::string xml_fault(const std::string& text) {
  std::vector<std::string> open;
  std::size_t elements = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '&') {
      const std::size_t end = text.find(';', i);
      const std::string entity = text.substr(i, end - i + 1);
      if (entity != "&amp;" && entity != "&lt;" && entity != "&gt;") return "stray & " + entity;
    }
    if (text[i] == '>') return "stray >";
    if (text[i] != '<') continue;
    const std::size_t end = text.find('>', i);
    if (end == std::string::npos) return "a tag that does not end";
    const std::string tag = text.substr(i + 1, end - i - 1);
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0) return "quotes in " + tag;
    if (tag.find('<') != std::string::npos) return "a tag in a tag";
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag.front() == '/') {
      if (open.empty() || "/" + open.back() != tag) return "closes " + tag;
      open.pop_back();
    } else {
      if (open.empty() && elements++ > 0) return "two roots";
      if (tag.back() != '/') open.push_back(name);
    }
    i = end;
  }
  return open.empty() ? "" : open.back() + " is not closed";
}

/// All numbers of all paths.
std::vector<double> path_numbers(const std::string& svg) {
  std::vector<double> numbers;
  for (std::size_t i = svg.find(" d=\""); i != std::string::npos; i = svg.find(" d=\"", i + 1)) {
    std::string path = svg.substr(i + 4, svg.find('"', i + 4) - i - 4);
    for (char& c : path)
      if (c == 'M' || c == 'L') c = ' ';
    std::istringstream in(path);
    for (double n = 0; in >> n;) numbers.push_back(n);
    EXPECT_TRUE(in.eof()) << path;
  }
  return numbers;
}

TEST(MotionPlot, IsWellFormedForAnyInput) {
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(6)); ++seed)
    for (const double hz : {20.0, 100.0, 4000.0}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << hz << " Hz");
      const job::Profile profile = lamp_profile(hz);
      const job::Job job = job::make_job(wild_points(1 + seed * 7, seed), profile, {});
      const sim::BeatWindow window{-100, 400};
      const TracedRun run(profile, job, window);
      for (const report::Fit fit : {report::Fit::motion, report::Fit::window}) {
        const std::string svg = motion_svg(run.series(window, fit), "a <b> & \"c\"\n");
        ASSERT_EQ(xml_fault(svg), "");
        EXPECT_THAT(svg, HasSubstr("a &lt;b&gt; &amp; \"c\" <"));
        EXPECT_THAT(svg, Not(HasSubstr("nan")));
        EXPECT_THAT(svg, Not(HasSubstr("inf")));
        for (const char* label : {"position, mm", "speed, m/s", "accel., m/s2", "beats of "})
          EXPECT_THAT(svg, HasSubstr(label));
        for (const double n : path_numbers(svg)) ASSERT_LT(std::fabs(n), 1e6);
      }
    }
}

TEST(MotionPlot, ShowsAllEvents) {
  const job::Profile profile = lamp_profile();
  const job::Job job = job::make_job(wild_points(12, 3), profile, {});
  sim::LampConfig lamp;
  const std::string good =
      motion_svg(TracedRun(profile, job, all_beats, lamp).series(all_beats), "");
  EXPECT_THAT(good, HasSubstr(">X</text>"));
  EXPECT_THAT(good, HasSubstr(">Z</text>"));
  EXPECT_THAT(good, HasSubstr("stroke-dasharray"));
  EXPECT_THAT(good, HasSubstr("from above"));
  EXPECT_THAT(good, HasSubstr(">shot</text>"));
  EXPECT_THAT(good, HasSubstr(">limit</text>"));
  EXPECT_THAT(good, Not(HasSubstr("no axis moves")));
  EXPECT_THAT(good, Not(HasSubstr("no flash")));
  EXPECT_THAT(good, Not(HasSubstr("tick, us")));
  lamp.dropout = 0.2;
  lamp.wander = 0.02;
  EXPECT_THAT(motion_svg(TracedRun(profile, job, all_beats, lamp).series(all_beats), ""),
              HasSubstr("no flash"));
}

TEST(MotionPlot, ShowsNoEventsThatDidNotOccur) {
  MotionSeries series;
  series.from = 2'000'000'000, series.to = 2'000'002'000, series.beat_ms = 10;
  const std::string svg = motion_svg(series, "");
  ASSERT_EQ(xml_fault(svg), "");
  EXPECT_THAT(svg, HasSubstr("no axis moves in these beats"));
  for (const char* word : {">shot<", ">limit<", "without a shot", "no flash", "stroke-dasharray"})
    EXPECT_THAT(svg, Not(HasSubstr(word)));
  EXPECT_THAT(svg, HasSubstr(">2000000500</text>"));
}

TEST(MotionPlot, NamesOfHoldsAreAboveTheGrid) {
  MotionSeries series;
  series.from = 0, series.to = 100, series.beat_ms = 10;
  series.bands.push_back({20, 60, "hold"});
  const std::string svg = motion_svg(series, "");
  const std::size_t name = svg.find(">hold</text>"), panel = svg.find("panel2");
  ASSERT_NE(name, std::string::npos);
  EXPECT_LT(svg.rfind("<path", panel), name);
  EXPECT_LT(name, panel);
  // Inside the panel for any time of the hold.
  for (const double from : {0.0, 99.9}) {
    series.bands = {{from, from + 0.1, "door open"}};
    const std::string edge = motion_svg(series, "");
    const std::size_t text = edge.rfind("<text x=\"", edge.find(">door open<"));
    const double x = std::stod(edge.substr(text + 9));
    EXPECT_GT(x, 96 + 30);
    EXPECT_LT(x, 864 - 30);
  }
}

TEST(MotionPlot, TitlesAreValidUtf8ForAnyInput) {
  const MotionSeries series{0, 1, 10, false, {}, {}, {}, {}};
  const auto title = [&](const std::string& text) {
    const std::string svg = motion_svg(series, text);
    const std::size_t from = svg.find("<text", svg.find("bold")), begin = svg.find('>', from) + 1;
    return svg.substr(begin, svg.find('<', begin) - begin);
  };
  for (const char* good : {"Schale", "\xc5\x82\xc3\xb3", "\xe2\x82\xac", "\xf0\x9f\x90\x9a"})
    EXPECT_EQ(title(good), good);
  EXPECT_EQ(title("a\xff\x01z"), "a? z");
  EXPECT_EQ(title("cut \xe2\x82"), "cut ??");        // in the middle of a character
  EXPECT_EQ(title("\xc0\xaf"), "??");                // longer than needed
  EXPECT_EQ(title("\xed\xa0\x80"), "???");           // half of a pair
  EXPECT_EQ(title("\xf4\x90\x80\x80 b"), "???? b");  // above the last one
}

TEST(MotionPlot, CurvesStayInsideTheirPanels) {
  MotionSeries series;
  series.from = 0, series.to = 10, series.beat_ms = 10;
  report::AxisSeries axis;
  axis.name = "X";
  axis.max_speed_m_s = 1, axis.max_accel_m_s2 = 2;
  for (int beat = 0; beat <= 10; ++beat) {
    axis.position_mm.push_back({1.0 * beat, beat * 1e3});
    axis.speed_m_s.push_back({1.0 * beat, beat % 2 - 0.5});
    axis.accel_m_s2.push_back({1.0 * beat, beat % 2 == 0 ? 1.9 : -1.9});
  }
  series.axes.push_back(axis);
  const std::string svg = motion_svg(series, "one axis");
  ASSERT_EQ(xml_fault(svg), "");
  EXPECT_THAT(svg, Not(HasSubstr("from above")));
  const std::vector<double> numbers = path_numbers(svg);
  ASSERT_GT(numbers.size(), 60u);
  for (const double n : numbers) {
    EXPECT_GE(n, 0);
    EXPECT_LE(n, 880);
  }
}

TEST(MotionPlot, StraightCurvesAreShort) {
  MotionSeries series;
  series.from = 0, series.to = 1000, series.beat_ms = 10;
  report::AxisSeries axis;
  axis.name = "X";
  for (int i = 0; i <= 100'000; ++i) axis.position_mm.push_back({i * 0.01, i * 0.5});
  axis.speed_m_s = {{0, 0.05}, {1000, 0.05}};
  axis.accel_m_s2 = {{0, 0}, {1000, 0}};
  series.axes.push_back(axis);
  EXPECT_LT(motion_svg(series, "").size(), 20'000u);
}

}  // namespace
}  // namespace lamplock::test
