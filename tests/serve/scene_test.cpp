// Objects that a page places: numbers and words, descriptions that are written, files that are not
// of the folder, jobs.
#include "host/serve/scene.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/description_file.hpp"
#include "host/glass/transformation.hpp"
#include "host/job/progress_journal.hpp"
#include "host/run/read_job.hpp"
#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Placement random_placement(std::mt19937& random) {
  const auto number = [&](double most) {
    return random() % 3 == 0
               ? 0.0
               : std::round((static_cast<double>(random()) / 4294967295.0 * 2 - 1) * most * 1e4) /
                     1e4;
  };
  Placement placement;
  for (bool& axis : placement.mirror) axis = random() % 2 == 0;
  placement.scale = random() % 3 == 0 ? 1 : 0.0001 + std::abs(number(5));
  for (double& angle : placement.turn_deg) angle = number(180);
  for (double& mm : placement.move_mm) mm = number(60);
  return placement;
}

TEST(Placements, words_and_numbers_are_the_same) {
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    const Placement placement = random_placement(random);
    const std::vector<std::string> words = words_of(placement);
    for (const std::string& each : words) glass::check_transformation(each, "");
    const PlacedWords read = split_words(words);
    EXPECT_THAT(read.kept, ElementsAre());
    EXPECT_EQ(read.placement.mirror, placement.mirror);
    EXPECT_NEAR(read.placement.scale, placement.scale, 1e-6);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(read.placement.turn_deg[k], placement.turn_deg[k], 1e-6);
      EXPECT_NEAR(read.placement.move_mm[k], placement.move_mm[k], 1e-6);
    }
    EXPECT_EQ(words_of(read.placement), words);
  }
}

TEST(Placements, other_transformations_are_kept) {
  const PlacedWords fit = split_words({"fit", "rotate z 30", "move 0 0 6"});
  EXPECT_THAT(fit.kept, ElementsAre("fit"));
  EXPECT_EQ(fit.placement.turn_deg[2], 30);
  EXPECT_EQ(fit.placement.move_mm[2], 6);
  EXPECT_THAT(split_words({"move 1 2 3", "rotate z 30"}).kept, ElementsAre("move 1 2 3"));
  EXPECT_THAT(split_words({"rotate z 30", "rotate x 10"}).kept, ElementsAre("rotate z 30"));
  EXPECT_THAT(split_words({"scale 1 2 3"}).kept, ElementsAre("scale 1 2 3"));
  EXPECT_THAT(split_words({"rotate 1 1 0 30"}).kept, ElementsAre("rotate 1 1 0 30"));
  EXPECT_THAT(split_words({}).kept, ElementsAre());
}

/// A square of points, 4 mm wide, which is its own mirror image in no axis.
constexpr const char* points_text = "0 0 0\n4 0 0\n4 4 0\n0 4 1\n1 1 0\n";

struct Served {
  RunningServer server{};
  RawClient client = server.client("client");
  Served() {
    client.call("control.take");
    server.add_file("a.xyz", points_text);
    server.add_file(
        "a.toml",
        "[[object]]\nfile = \"a.xyz\"\ntransform = [\"scale 2 1 1\"]\n\n[output]\nflashes = 3\n");
  }
  Json result(const char* method, const Json& parameters) {
    const Json answer = client.call(method, parameters);
    EXPECT_TRUE(answer.contains("result")) << answer.dump();
    return answer.value("result", Json());
  }
  std::string error(const char* method, const Json& parameters) {
    return client.call(method, parameters).value("/error/message"_json_pointer, std::string());
  }
};

TEST(Scenes, are_opened_written_and_made) {
  Served served;
  const Json scene = served.result("scene.open", {{"name", "a.toml"}});
  ASSERT_EQ(scene["objects"].size(), 1u);
  EXPECT_EQ(scene["objects"][0]["file"], "a.xyz");
  EXPECT_EQ(scene["objects"][0]["kept"], Json::parse(R"(["scale 2 1 1"])"));
  EXPECT_EQ(scene["objects"][0]["bounds"], Json::parse("[[0.0,0.0,0.0],[8.0,4.0,1.0]]"));
  EXPECT_EQ(scene["objects"][0]["shown"], 5);
  EXPECT_TRUE(scene["block"].is_null());
  const Json objects = Json::parse(
      R"([{"object":0,"mirror":[true,false,false],"turn":[0,0,90],"move":[1,2,3]},{"file":"a.xyz","scale":0.5}])");
  served.result(
      "scene.write",
      {{"name", "b.toml"}, {"from", "a.toml"}, {"objects", objects}, {"block", {60, 50, 40}}});
  const glass::Description written = glass::read_description(served.server.folder() / "b.toml");
  ASSERT_EQ(written.objects.size(), 2u);
  EXPECT_THAT(written.objects[0].transform,
              ElementsAre("scale 2 1 1", "mirror x", "rotate z 90", "move 1 2 3"));
  EXPECT_THAT(written.objects[1].transform, ElementsAre("scale 0.5"));
  EXPECT_EQ(written.output.flashes, 3);
  EXPECT_EQ(written.glass.block_mm, (glass::Triple{60, 50, 40}));
  const Json made = served.result("job.make", {{"name", "b.toml"}});
  EXPECT_EQ(made["name"], "b.llj");
  EXPECT_EQ(made["points"], 10);
  // (4, 4, 0) is doubled in x, mirrored, turned by a quarter and moved: (-4 + 1, -8 + 2, 3).
  const auto job = run::read_prepared_job((served.server.folder() / "b.llj").string());
  EXPECT_TRUE(std::any_of(job.points.begin(), job.points.end(), [](const geometry::Point& p) {
    return std::hypot(p.x + 3, p.y + 6, p.z - 3) < 0.01;
  }));
}

TEST(Scenes, keep_a_job_whose_last_run_has_no_known_end) {
  Served served;
  EXPECT_EQ(served.result("job.make", {{"name", "a.toml"}})["name"], "a.llj");
  job::ProgressJournal journal(served.server.folder() / "a.llj.progress");
  job::ProgressRecord record{job::Progress::running, 1, 2, 3, 0, 4};
  journal.append(record);
  const std::string before = read_file((served.server.folder() / "a.llj").string());
  EXPECT_THAT(served.error("job.make", {{"name", "a.toml"}}), HasSubstr("no known end"));
  EXPECT_EQ(read_file((served.server.folder() / "a.llj").string()), before);
  record.progress = job::Progress::ended;
  journal.append(record);
  EXPECT_EQ(served.result("job.make", {{"name", "a.toml"}})["name"], "a.llj");
}

TEST(Scenes, write_nothing_of_bad_input) {
  Served served;
  const auto refused = [&](const char* name, const char* objects, const Json& block = Json()) {
    Json parameters{{"name", name}, {"from", "a.toml"}, {"objects", Json::parse(objects)}};
    if (!block.is_null()) parameters["block"] = block;
    std::string error = served.error("scene.write", parameters);
    EXPECT_FALSE(std::filesystem::exists(served.server.folder() / name)) << objects;
    return error;
  };
  EXPECT_THAT(refused("b.toml", R"([{"object":7}])"), HasSubstr("no such object"));
  EXPECT_THAT(refused("b.toml", R"([{"object":0,"scale":0}])"), HasSubstr("more than 0"));
  EXPECT_THAT(refused("b.toml", R"([{"object":0,"scale":-1}])"), HasSubstr("more than 0"));
  EXPECT_THAT(refused("b.toml", R"([{"object":0,"move":[1,2]}])"), HasSubstr("list of three"));
  EXPECT_THAT(refused("b.toml", R"([{"object":0,"mirror":[1,0,0]}])"), HasSubstr("list of three"));
  EXPECT_THAT(refused("b.toml", R"([{"object":0,"turn":"x"}])"), HasSubstr("list of three"));
  EXPECT_THAT(refused("b.toml", R"([{"file":"none.stl"}])"), HasSubstr("no such file"));
  EXPECT_THAT(refused("b.toml", R"([{"file":"../a.xyz"}])"), HasSubstr("is not in the folder"));
  EXPECT_THAT(refused("b.toml", R"([{"file":"/etc/passwd"}])"), HasSubstr("is not in the folder"));
  EXPECT_THAT(refused("b.toml", R"([{}])"), HasSubstr("has no file"));
  EXPECT_THAT(refused("b.toml", R"([{"object":0}])", {5, 50, 50}), HasSubstr("margin"));
  EXPECT_THAT(refused("b.ngc", R"([{"object":0}])"), HasSubstr("name it .toml"));
  EXPECT_NE(refused("b.toml", "[]"), "");
}

TEST(Scenes, read_no_file_outside_of_the_folder) {
  Served served;
  for (const char* file : {"../a.xyz", "/etc/hostname", "sub/a.xyz"}) {
    served.server.add_file("c.toml", "[[object]]\nfile = \"" + std::string(file) + "\"\n");
    for (const char* method : {"scene.open", "job.make"})
      EXPECT_THAT(served.error(method, {{"name", "c.toml"}}), HasSubstr("is not in the folder"));
  }
  served.server.add_file(
      "c.toml", "[machine]\nprofile = \"/etc/machine.toml\"\n[[object]]\nfile = \"a.xyz\"\n");
  EXPECT_THAT(served.error("scene.open", {{"name", "c.toml"}}), HasSubstr("is not in the folder"));
  EXPECT_THAT(served.error("scene.open", {{"name", "../a.toml"}}), HasSubstr("no such file"));
  const JobFolder folder(served.server.folder());
  for (const char* name : {"a.obj", "a.glb", "a.exe", "a", "a.toml.exe"})
    EXPECT_THROW(folder.write(name, "x"), Error) << name;
}

TEST(Scenes, need_control_to_write) {
  Served served;
  RawClient other = served.server.client("other");
  for (const Json& call :
       {Json{{"method", "job.make"}, {"params", {{"name", "a.toml"}}}},
        Json{{"method", "scene.write"},
             {"params", {{"name", "a.toml"}, {"objects", Json::parse(R"([{"object":0}])")}}}}})
    EXPECT_THAT(other.call(call["method"], call["params"])
                    .value("/error/message"_json_pointer, std::string()),
                HasSubstr("take control first"));
}

}  // namespace
}  // namespace lamplock::serve::test
