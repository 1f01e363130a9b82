// Programs with process parameters: their material is chosen by a request, from the library of the
// server.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "host/job/job.hpp"
#include "host/job/job_file.hpp"
#include "host/job/profile.hpp"
#include "host/run/material_records.hpp"
#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test::material_choice_test {
namespace {

using testing::HasSubstr;

constexpr int needs_material = -32002;

/// A server whose library has a board of two thicknesses, and a program that reads its values.
class MaterialChoice : public testing::Test {
 public:
  MaterialChoice() {
    const std::string library = (server.folder() / "library.db").string();
    run::add_record({library, "material", "board"}, {"thickness_mm=3"});
    for (const auto& [thickness, feed] : {std::pair{"thickness_mm=3", "feed_mm_min=1200"},
                                          std::pair{"thickness_mm=6", "feed_mm_min=600"}})
      run::add_record({library, "setting", "board"},
                      {"laser=diode-3w", "power_w=3", "kerf_mm=0.25", thickness, feed});
    server.add_file("part.ngc", "G21G90\nG1X#<_material_thickness>F#<_material_feed>\n");
    server.add_file("asks.ngc",
                    "G21G90\no1 if [EXISTS[#<_material_feed>]]\nG1X7F#<_material_feed>\no1 "
                    "else\nG1X5F600\no1 endif\n");
    client.call("control.take");
  }
  double x_mm() const { return server.machine().view().board.machine_mm.at(0); }

  RunningServer server;
  RawClient client = server.client("client");
};

TEST_F(MaterialChoice, IsAskedForByItsOwnCode) {
  const Json refused = client.call("job.check", {{"name", "part.ngc"}});
  EXPECT_EQ(refused["error"]["code"], needs_material);
  EXPECT_THAT(error_of(refused), HasSubstr("part.ngc:2:4: '#<_material_thickness>': no material"));
  EXPECT_EQ(client.call("path.open", {{"name", "part.ngc"}})["error"]["code"], needs_material);
  client.call("job.start", {{"name", "part.ngc"}});
  EXPECT_EQ(server.wait_for_end(), "failed");
  EXPECT_THAT(server.machine().view().job.message, HasSubstr("no material is chosen"));
  EXPECT_EQ(x_mm(), 0);
}

TEST_F(MaterialChoice, GivesItsValuesToCheckPathAndRun) {
  const Json part{{"name", "part.ngc"},
                  {"material", "board"},
                  {"laser", "diode-3w"},
                  {"operation", "cut"},
                  {"thickness", 6}};
  const Json checked = client.call("job.check", part)["result"];
  EXPECT_EQ(checked["material"]["feed"], 600);
  EXPECT_EQ(checked["material"]["kerf"], 0.25);
  EXPECT_EQ(checked["material"]["thickness"], 6);
  EXPECT_EQ(checked["material"]["frequency"], Json());
  EXPECT_EQ(checked["bounds"][1][0], 6);
  EXPECT_EQ(client.call("path.open", part)["result"]["bounds"][1][0], 6);
  EXPECT_EQ(error_of(client.call("job.start", part)), "");
  EXPECT_EQ(server.wait_for_end(), "done");
  EXPECT_TRUE(server.wait_for_state("Idle"));
  EXPECT_NEAR(x_mm(), 6, 0.01);
}

TEST_F(MaterialChoice, HasTheThicknessOfTheMaterialByDefault) {
  const Json checked =
      client.call("job.check", {{"name", "part.ngc"}, {"material", "board"}})["result"];
  EXPECT_EQ(checked["material"]["feed"], 1200);
  EXPECT_EQ(checked["bounds"][1][0], 3);
}

TEST_F(MaterialChoice, IsOptionalForAProgramThatAsksForIt) {
  const Json without = client.call("job.check", {{"name", "asks.ngc"}})["result"];
  EXPECT_TRUE(without.contains("material"));
  EXPECT_EQ(without["material"], Json());
  EXPECT_EQ(without["bounds"][1][0], 5);
  const Json with =
      client.call("job.check", {{"name", "asks.ngc"}, {"material", "board"}})["result"];
  EXPECT_EQ(with["bounds"][1][0], 7);
  server.add_file("plain.ngc", "G21G90\nG1X1F600\n");
  EXPECT_FALSE(client.call("job.check", {{"name", "plain.ngc"}})["result"].contains("material"));
}

TEST_F(MaterialChoice, IsRefusedIfTheLibraryOrTheFileHasNone) {
  const auto refusal = [&](Json parameters) {
    parameters["name"] = parameters.value("name", "part.ngc");
    return error_of(client.call("job.check", parameters));
  };
  EXPECT_THAT(refusal({{"material", "bord"}}), HasSubstr("board"));
  EXPECT_THAT(refusal({{"material", "board"}, {"thickness", 4}}), HasSubstr("no setting for 4 mm"));
  EXPECT_THAT(refusal({{"laser", "diode-3w"}}), HasSubstr("without the material"));
  EXPECT_THAT(refusal({{"material", "board"}, {"operation", "burn"}}), HasSubstr("operation"));
  EXPECT_THAT(refusal({{"material", "board"}, {"thickness", -1}}), HasSubstr("thickness"));
  job::write_job_file(server.folder() / "dot.llj",
                      job::make_job({{0, 0, 0}}, job::default_profile(), job::JobOptions{}));
  EXPECT_THAT(refusal({{"name", "dot.llj"}, {"material", "board"}}),
              HasSubstr("only programs of G-code"));
  client.call("job.start", {{"name", "dot.llj"}, {"material", "board"}});
  EXPECT_EQ(server.wait_for_end(), "failed") << "no point may be fired";
  EXPECT_EQ(server.machine().view().job.done, 0u);
}

}  // namespace
}  // namespace lamplock::serve::test::material_choice_test
