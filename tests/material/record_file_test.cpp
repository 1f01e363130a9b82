// Records as TOML: they come back as they were; a wrong one is refused with its line and field.
#include "host/material/record_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>

#include "host/geometry/random.hpp"
#include "host/material/delivered.hpp"
#include "host/material/fields.hpp"
#include "host/material/library.hpp"
#include "tests/damaged.hpp"
#include "tests/error_of.hpp"
#include "tests/scale.hpp"

namespace lamplock::material::record_file_test {
namespace {

using testing::HasSubstr;

/// Random values of all fields, inside their ranges.
template <class Record>
Record random_record(geometry::Random& random) {
  Record record;
  for (const Field& field : fields(record)) {
    const auto number = [&] {
      const double high = std::min(field.range.high, 1e6);
      return field.range.low + (high - field.range.low) * (0.001 + 0.999 * random.uniform());
    };
    if (auto* const* real = std::get_if<double*>(&field.place)) **real = number();
    if (auto* const* maybe = std::get_if<std::optional<double>*>(&field.place))
      if (random.next() % 2 == 0) **maybe = number();
    if (auto* const* whole = std::get_if<int*>(&field.place))
      **whole = 1 + static_cast<int>(random.next() % 100);
    if (auto* const* flag = std::get_if<bool*>(&field.place)) **flag = random.next() % 2 == 0;
    if (auto* const* text = std::get_if<std::string*>(&field.place)) {
      if (!field.names.empty())
        **text = field.names[random.next() % field.names.size()];
      else if (field.is_name)
        **text = fmt::format("n-{}_\u00e4.{}", random.next(), random.next() % 9);
      else if (random.next() % 2 == 0)
        **text = fmt::format("\"quoted\" \\ # = [{}] \u00b5m", random.next());
    }
  }
  return record;
}

template <class Record>
void expect_same(const std::vector<Record>& a, const std::vector<Record>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(same_record(a[i], b[i])) << i;
}

TEST(record_file, random_records_come_back) {
  geometry::Random random(1);
  for (int i = 0; i < test::scaled(200, 10); ++i) {
    Records records;
    records.lasers.push_back(random_record<Laser>(random));
    if (records.lasers[0].beam_shape == "round") records.lasers[0].beam_height_mm.reset();
    records.materials.push_back(random_record<Material>(random));
    Setting setting = random_record<Setting>(random);
    setting.min_feed_mm_min = setting.feed_mm_min / 2;
    setting.max_feed_mm_min.reset();
    records.settings.push_back(setting);
    Measurement measurement = random_record<Measurement>(random);
    measurement.thickness_mm.reset();
    if (measurement.result == "cut") measurement.depth_mm.reset();
    records.measurements = {measurement, measurement};
    const std::string text = to_toml(records);
    const Records again = parse_records(text, "a.toml");
    expect_same(records.lasers, again.lasers);
    expect_same(records.materials, again.materials);
    expect_same(records.settings, again.settings);
    expect_same(records.measurements, again.measurements);
    EXPECT_EQ(to_toml(again), text);
  }
}

TEST(record_file, wrong_records_are_refused_with_line_and_field) {
  const auto refusal = [](const std::string& text) {
    return test::error_of([&] { parse_records(text, "a.toml"); });
  };
  const std::string laser = "[[laser]]\nname = \"a\"\npower_w = 3\nbeam_width_mm = 0.5\n";
  EXPECT_EQ(parse_records(laser, "a.toml").lasers.size(), 1u);
  EXPECT_THAT(refusal(laser + "power = 4\n"),
              HasSubstr("a.toml:5: unknown field 'power'; did you"));
  EXPECT_THAT(refusal(laser + "wavelength_nm = \"450\"\n"),
              HasSubstr("a.toml:5: 'wavelength_nm' must be a number; write it without quotes"));
  EXPECT_THAT(refusal(laser + "wavelength_nm = 5\n"), HasSubstr("a.toml:1: 'wavelength_nm' is 5"));
  EXPECT_THAT(refusal(laser + "wavelength_nm = nan\n"), HasSubstr("'wavelength_nm' is nan"));
  EXPECT_THAT(refusal(laser + "beam_shape = \"rond\"\n"), HasSubstr("did you mean 'round'?"));
  EXPECT_THAT(refusal(laser + "beam_shape = \"round\"\nbeam_height_mm = 0.4\n"),
              HasSubstr("'beam_height_mm' differs from the width of a round beam"));
  EXPECT_THAT(refusal(laser + "note = \"a\\nb\"\n"), HasSubstr("'note' has characters"));
  EXPECT_THAT(refusal("[[laser]]\npower_w = 3\n"), HasSubstr("a.toml:1: 'name' is missing"));
  EXPECT_THAT(refusal("[[laser]]\nname = \"a\"\n"), HasSubstr("'power_w' is missing or 0"));
  EXPECT_THAT(refusal(laser + "\n" + laser), HasSubstr("a.toml:6: 'name' is 'a', as of another"));
  EXPECT_THAT(refusal("[laser]\nname = \"a\"\n"), HasSubstr("write [[laser]]"));
  EXPECT_THAT(refusal("[[lasers]]\nname = \"a\"\n"), HasSubstr("did you mean 'laser'?"));
  EXPECT_THAT(refusal("# nothing\n"), HasSubstr("it has no record"));
  for (const char* name : {"", "-a", "a b", "a/b", "a\\tb", "a'b"})
    EXPECT_THAT(refusal(fmt::format("[[material]]\nname = \"{}\"\n", name)), HasSubstr("'name'"));
  const std::string cut =
      "[[measurement]]\nmaterial = \"m\"\nlaser = \"l\"\nfeed_mm_min = 60\npower_w = 3\n";
  EXPECT_THAT(refusal(cut), HasSubstr("'depth_mm' is missing"));
  EXPECT_THAT(refusal(cut + "depth_mm = 3\nthickness_mm = 2\n"), HasSubstr("more than thickness"));
  EXPECT_THAT(refusal(cut + "depth_mm = 1\nresult = \"cut\"\n"),
              HasSubstr("'depth_mm' is given for a cut that came through"));
  EXPECT_THAT(refusal(cut + "depth_mm = 1\npasses = 1.5\n"), HasSubstr("must be a whole number"));
  EXPECT_THAT(refusal(cut + "depth_mm = 1\npasses = 0\n"), HasSubstr("'passes' is 0"));
  EXPECT_THAT(refusal(cut + "depth_mm = 1\nrejected = 1\n"), HasSubstr("true or false"));
  const std::string setting =
      "[[setting]]\nmaterial = \"m\"\nlaser = \"l\"\nfeed_mm_min = 60\npower_w = 3\n";
  EXPECT_THAT(refusal(setting + "min_feed_mm_min = 61\n"), HasSubstr("'min_feed_mm_min' is more"));
  EXPECT_THAT(refusal(setting + "max_feed_mm_min = 59\n"), HasSubstr("'max_feed_mm_min' is less"));
}

TEST(record_file, every_delivered_record_has_a_source) {
  const Records records = parse_records(delivered_text(), "materials.toml");
  const auto check = [](auto record) { EXPECT_THAT(record.source, HasSubstr("Ausmanas")); };
  for (const auto& one : records.lasers) check(one);
  for (const auto& one : records.materials) check(one);
  for (const auto& one : records.settings) check(one);
  for (const auto& one : records.measurements) check(one);
  EXPECT_EQ(records.measurements.size(), 39u);
}

TEST(record_file, changes_name_their_field) {
  Material material;
  apply_changes(material, {"name=oak", "density_g_cm3=0.7", "cuttable=false", "note=a=b"}, "here");
  EXPECT_EQ(material.density_g_cm3, 0.7);
  EXPECT_FALSE(material.cuttable);
  EXPECT_EQ(material.note, "a=b");
  apply_changes(material, {"density_g_cm3="}, "here");
  EXPECT_FALSE(material.density_g_cm3);
  const auto refusal = [&](const std::string& change) {
    return test::error_of([&] { apply_changes(material, {change}, "here"); });
  };
  EXPECT_THAT(refusal("density=1"), HasSubstr("here: unknown field 'density'"));
  EXPECT_THAT(refusal("density_g_cm3=heavy"),
              HasSubstr("'density_g_cm3' is 'heavy', not a number"));
  EXPECT_THAT(refusal("cuttable=yes"), HasSubstr("give true or false"));
  EXPECT_THAT(refusal("note"), HasSubstr("write FIELD=VALUE"));
}

}  // namespace
}  // namespace lamplock::material::record_file_test
