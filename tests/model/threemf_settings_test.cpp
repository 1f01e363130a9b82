// Volumes of 3MF files that slicers mark as modifiers, negative volumes or supports.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "host/model/transform.hpp"
#include "tests/model/threemf_files.hpp"

namespace lamplock::threemf {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* prusa = "Metadata/Slic3r_PE_model.config";
constexpr const char* bambu = "Metadata/model_settings.config";

std::string prusa_volume(int first, int last, const std::string& type) {
  return fmt::format(
      "<volume firstid=\"{}\" lastid=\"{}\"><metadata type=\"volume\" key=\"name\" value=\"a\"/>"
      "<metadata type=\"volume\" key=\"volume_type\" value=\"{}\"/></volume>",
      first, last, type);
}

std::string prusa_config(const std::string& volumes) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?><config><object id=\"1\">" + volumes +
         "</object></config>";
}

std::string bambu_config(const std::string& subtype) {
  return fmt::format(
      "<config><object id=\"3\"><part id=\"1\" subtype=\"normal_part\"/>"
      "<part id=\"2\" subtype=\"{}\"/></object></config>",
      subtype);
}

class ThreemfSettings : public Threemf {
 protected:
  /// Two boxes in one mesh, triangles 0 to 11 and 12 to 23; the second is the wide one.
  std::filesystem::path two_volumes(const std::string& config) const {
    Mesh mesh = test::box(1, 1, 1);
    const Mesh wide = test::box(5, 5, 5);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), wide.vertices.begin(), wide.vertices.end());
    for (const auto& t : wide.triangles)
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return write_model(model_text(object(1, mesh_text(mesh)), item(1)), {{prusa, config}});
  }
  /// Two boxes as components; the second is the wide one.
  std::filesystem::path two_parts(const std::string& config) const {
    return write_model(model_text(object(1, box_text()) + object(2, mesh_text(test::box(5, 5, 5))) +
                                      object(3, holding({1, 2})),
                                  item(3)),
                       {{bambu, config}});
  }
  static double width(const Mesh& mesh) {
    const auto box = model::bounds(mesh.vertices);
    return box.high.x - box.low.x;
  }
};

TEST_F(ThreemfSettings, VolumesOfPrusaSlicerAreLeftOut) {
  for (const char* type :
       {"ParameterModifier", "NegativeVolume", "SupportBlocker", "SupportEnforcer"}) {
    const Mesh read = read_mesh(
        two_volumes(prusa_config(prusa_volume(0, 11, "ModelPart") + prusa_volume(12, 23, type))));
    EXPECT_EQ(read.triangles.size(), 12u) << type;
    EXPECT_EQ(width(read), 2) << type;
    EXPECT_THAT(read.reader_warnings, ElementsAre(HasSubstr("left out: 1")));
  }
  const Mesh whole = read_mesh(two_volumes(
      prusa_config(prusa_volume(0, 11, "ModelPart") + prusa_volume(12, 23, "ModelPart"))));
  EXPECT_EQ(whole.triangles.size(), 24u);
  EXPECT_THAT(whole.reader_warnings, IsEmpty());
  // Ranges that do not exist leave the mesh as it is.
  for (const int last : {24, 3})
    EXPECT_EQ(read_mesh(two_volumes(prusa_config(prusa_volume(12, last, "NegativeVolume"))))
                  .triangles.size(),
              24u);
}

TEST_F(ThreemfSettings, PartsOfBambuStudioAreLeftOut) {
  for (const char* type :
       {"modifier_part", "negative_part", "support_blocker", "support_enforcer"}) {
    const Mesh read = read_mesh(two_parts(bambu_config(type)));
    EXPECT_EQ(width(read), 2) << type;
    EXPECT_THAT(read.reader_warnings, ElementsAre(HasSubstr("left out: 1")));
  }
  const Mesh whole = read_mesh(two_parts(bambu_config("normal_part")));
  EXPECT_EQ(width(whole), 10);
  EXPECT_THAT(whole.reader_warnings, IsEmpty());
}

TEST_F(ThreemfSettings, DamagedSettingsAreAWarning) {
  for (const char* config : {"<config><object", "", "<other/>"}) {
    const auto named = ElementsAre(HasSubstr("the settings of the slicer are not read"));
    EXPECT_THAT(read_mesh(two_parts(config)).reader_warnings, named);
    EXPECT_THAT(read_mesh(two_volumes(config)).reader_warnings, named);
  }
}

TEST_F(ThreemfSettings, RefusalNamesWhatIsLeftOut) {
  const auto file = two_volumes(prusa_config(prusa_volume(0, 23, "SupportEnforcer")));
  EXPECT_THAT(error_of([&] { read_mesh(file); }), HasSubstr("supports of the slicer left out: 1"));
}

}  // namespace
}  // namespace lamplock::threemf
