// Programs of `cut` on the virtual board: where the drives are while there is light, and its power.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host/cutting/contour.hpp"
#include "host/file.hpp"
#include "host/job/read_profile.hpp"
#include "host/model/input.hpp"
#include "host/run/cut.hpp"
#include "tests/board/program_host.hpp"
#include "tests/drawings.hpp"
#include "tests/judges/path_judge.hpp"
#include "tests/run/silent_frontend.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::test::cut_beam_test {
namespace {

using cutting::Contour;
using cutting::Vec;

constexpr double steps_per_mm = 100, step_mm = 1 / steps_per_mm;
constexpr const char* machine = R"(axes = 3
steps_per_mm = [100, 100, 400]
max_rate = [12000, 12000, 600]
acceleration = [2000, 2000, 200]
travel = [100, 100, 50]
min_corner = [-50, -50, -50]
lamp_mode = 0
laser_mode = 1
max_spindle_speed = 1000
)";

/// A place of the drives with the light there, parts of the full power.
struct LitPlace {
  Vec at;
  double light = 0;
};

/// Runs a program. All places after the first step, those without light included.
std::vector<LitPlace> run_on_board(const std::string& program, const job::Profile& profile) {
  Rig rig(profile);
  ProgramHost host(rig);
  StepRecord record(rig.board);
  EXPECT_TRUE(host.stream(program, 300));
  EXPECT_EQ(host.errors(), 0u);
  std::vector<LitPlace> places;
  for (const PassedPlace& place : record.places())
    places.push_back({{place.steps[0] * step_mm, place.steps[1] * step_mm},
                      rig.board.world().beam().at(place.at).light() / 65535.0});
  return places;
}

double distance_to_nearest(const std::vector<Contour>& contours, const Vec& at) {
  double nearest = 1e9;
  for (const Contour& contour : contours)
    for (const cutting::Edge& edge : contour.edges)
      nearest = std::min(nearest, distance_to(edge, at));
  return nearest;
}

/// The contours of entities, as the drawing has them.
std::vector<Contour> contours_of(const TemporaryFolder& folder, const std::string& entities) {
  const auto input = model::read_input(folder.write("wanted.dxf", dxf_drawing(entities)));
  return cutting::join_contours(std::get<model::Curves>(input), {}).contours;
}

class CutBeam : public testing::Test {
 protected:
  CutBeam() { profile_ = job::read_profile(folder_.write("machine.toml", machine)); }
  std::vector<LitPlace> beam_of(const std::string& entities, const std::string& operations) {
    folder_.write("part.dxf", dxf_drawing(entities));
    const auto description = folder_.write(
        "cut.toml",
        "[drawing]\nfile = \"part.dxf\"\n[machine]\nprofile = \"machine.toml\"\n" + operations);
    const std::string program = folder_.file("part.ngc").string();
    SilentFrontend frontend;
    run::make_cut({run::read_cut_description(description), program, {}, {}}, frontend);
    return run_on_board(read_file(program), profile_);
  }
  double tolerance_mm() const {
    return step_mm + profile_.settings.milli(settings::Id::arc_tolerance) * 1e-3;
  }

  TemporaryFolder folder_;
  job::Profile profile_;
};

TEST_F(CutBeam, light_is_half_a_kerf_beside_the_parts_and_nowhere_else) {
  const std::string part =
      dxf_rounded(-30, -20, 30, 14, 3) +
      dxf_polyline({{5, 0}, {25, 0}, {25, 8}, {13, 8}, {13, 20}, {5, 20}}, true);
  const std::string hole = dxf_circle(-20, -13, 4);
  const auto lit = beam_of(part + hole, R"([[operation]]
power = 80
feed = 1200
kerf = 0.4
lead_in = "line"
lead_in_mm = 1
)");
  const auto parts = contours_of(folder_, part), holes = contours_of(folder_, hole);
  std::vector<Contour> all = parts;
  all.insert(all.end(), holes.begin(), holes.end());
  double max_light = 0;
  std::vector<Vec> on_kerf;
  for (const LitPlace& place : lit) {
    if (place.light == 0) continue;
    max_light = std::max(max_light, place.light);
    const double distance_mm = distance_to_nearest(all, place.at);
    EXPECT_GE(distance_mm, 0.2 - tolerance_mm());
    EXPECT_LE(distance_mm, 0.2 + 1 + tolerance_mm()) << "leads are 1 mm long";
    for (const Contour& contour : parts)
      EXPECT_FALSE(is_inside(contour, place.at) && !is_inside(holes[0], place.at));
    if (distance_mm < 0.2 + tolerance_mm()) on_kerf.push_back(place.at);
  }
  EXPECT_NEAR(max_light, 0.8, 0.005);
  // The light is all along both sides: every place of the contours has some at half a kerf.
  for (const Contour& contour : all) {
    for (const cutting::Edge& edge : contour.edges) {
      for (int i = 0; i < 40; ++i) {
        const Vec at = point_at(edge, i / 40.0);
        const bool has_light = std::any_of(on_kerf.begin(), on_kerf.end(), [&](const Vec& place) {
          return distance(place, at) < 0.2 * 1.5 + tolerance_mm();
        });
        EXPECT_TRUE(has_light) << at.x << " " << at.y;
      }
    }
  }
}

/// The board compensates: the light is on the path of the host's own compensation.
TEST_F(CutBeam, the_board_compensates_as_the_host_does) {
  const std::string part =
      dxf_rounded(-30, -20, 30, 14, 3) + dxf_circle(-20, -13, 4) +
      dxf_polyline({{5, 0}, {25, 0}, {25, 8}, {13, 8}, {13, 20}, {5, 20}}, true);
  const auto lit_by = [&](const std::string& compensation) {
    std::vector<Vec> places;
    for (const LitPlace& place :
         beam_of(part, "[[operation]]\npower = 80\nfeed = 1200\nkerf = 0.4\ncompensation = \"" +
                           compensation + "\"\n"))
      if (place.light > 0) places.push_back(place.at);
    return places;
  };
  const std::vector<Vec> host = lit_by("auto"), board = lit_by("controller");
  EXPECT_GT(host.size(), 10'000u);
  const auto apart = [](const std::vector<Vec>& from, const std::vector<Vec>& to) {
    double most = 0;
    for (std::size_t i = 0; i < from.size(); i += 7) {
      double least = 1e9;
      for (const Vec& place : to) least = std::min(least, distance(from[i], place));
      most = std::max(most, least);
    }
    return most;
  };
  EXPECT_LE(apart(host, board), 2 * step_mm);
  EXPECT_LE(apart(board, host), 2 * step_mm);
}

TEST_F(CutBeam, operations_have_their_power_and_engravings_stay_in_their_area) {
  const std::string cut = dxf_rectangle(-30, -20, 40, 30);
  const std::string score = dxf_polyline({{-25, -15}, {-10, -12}, {-5, -15}}, false, "SCORE");
  const std::string engrave = dxf_rectangle(-20, -5, 12, 6, "FILL");
  const auto lit = beam_of(cut + score + engrave, R"([[operation]]
layers = ["CUT"]
power = 90
feed = 1200
[[operation]]
layers = ["SCORE"]
kind = "score"
power = 40
feed = 3000
[[operation]]
layers = ["FILL"]
kind = "engrave"
power = 20
feed = 6000
hatch = 0.5
)");
  const auto lines = contours_of(folder_, cut), scores = contours_of(folder_, score);
  const auto area = contours_of(folder_, engrave);
  double cut_light = 0, score_light = 0, fill_light = 0;
  for (const LitPlace& place : lit) {
    if (place.light == 0) continue;
    // Light may last to the end of its cell of 64 us: 6 um at 100 mm/s.
    const double slack_mm = tolerance_mm() + 0.007;
    if (is_inside(area[0], place.at) || distance_to_nearest(area, place.at) < slack_mm)
      fill_light = std::max(fill_light, place.light);
    else if (distance_to_nearest(scores, place.at) < tolerance_mm())
      score_light = std::max(score_light, place.light);
    else if (distance_to_nearest(lines, place.at) < tolerance_mm())
      cut_light = std::max(cut_light, place.light);
    else
      ADD_FAILURE() << "light at " << place.at.x << " " << place.at.y;
  }
  EXPECT_NEAR(cut_light, 0.9, 0.005);
  EXPECT_NEAR(score_light, 0.4, 0.005);
  EXPECT_NEAR(fill_light, 0.2, 0.005);
}

}  // namespace
}  // namespace lamplock::test::cut_beam_test
