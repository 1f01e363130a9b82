// Descriptions: their contents, their errors, and that their text is read back as the same.
#include "host/glass/description.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "host/error.hpp"
#include "host/glass/description_file.hpp"
#include "tests/error_of.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::glass {
namespace {

using test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

class DescriptionTest : public ::testing::Test {
 protected:
  Description read(const std::string& text) const {
    return read_description(folder_.write("job.toml", text));
  }
  std::string refusal(const std::string& text) const {
    return error_of([&] { read(text); });
  }
  std::string path(const std::string& name) const { return folder_.file(name).string(); }

  test::TemporaryFolder folder_;
};

std::vector<Parameter> all_parameters(Description& d) {
  std::vector<Parameter> all;
  const auto add = [&all](std::vector<Parameter> more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  add(parameters(d.machine));
  add(parameters(d.glass));
  for (Object& object : d.objects) add(parameters(object));
  add(parameters(d.order));
  add(parameters(d.pause));
  add(parameters(d.output));
  return all;
}

TEST_F(DescriptionTest, ReadsItsValues) {
  const Description d = read(
      "[machine]\nprofile = \"m.toml\"\nlamp = 50\nmode = \"path\"\n"
      "[glass]\nmaterial = \"k9\"\nblock = [50, 50.5, 80]\nmargin = 5\n"
      "[[object]]\nfile = \"a.stl\"\nsize = 40\ntransform = [\"rotate z 30\", \"fit\"]\n"
      "[[object]]\nfile = \"sub/b.xyz\"\nend_points = true\nlayers = 3\n"
      "[order]\nby = \"cone\"\n[pause]\nevery = 10000\nbeats = 200\n[output]\nchannel = 2\n");
  EXPECT_EQ(d.machine.profile, path("m.toml"));
  EXPECT_EQ(d.machine.lamp_hz, 50);
  EXPECT_EQ(d.machine.mode, "path");
  EXPECT_EQ(d.glass.material, "k9");
  EXPECT_EQ(d.glass.block_mm, (Triple{50, 50.5, 80}));
  EXPECT_EQ(d.glass.margin_mm, 5);
  ASSERT_EQ(d.objects.size(), 2u);
  EXPECT_EQ(d.objects[0].file, path("a.stl"));
  EXPECT_EQ(d.objects[0].size_mm, 40);
  EXPECT_EQ(d.objects[0].transform, (std::vector<std::string>{"rotate z 30", "fit"}));
  EXPECT_EQ(d.objects[1].file, path("sub/b.xyz"));
  EXPECT_EQ(d.objects[1].end_points, true);
  EXPECT_EQ(d.objects[1].layers, 3);
  EXPECT_EQ(d.order.name, "cone");
  EXPECT_EQ(d.pause.every_points, 10000);
  EXPECT_EQ(d.pause.beats, 200);
  EXPECT_EQ(d.output.channel, 2);
}

TEST_F(DescriptionTest, ErrorsNameTheLine) {
  const std::string object = "[[object]]\nfile = \"a.stl\"\n";
  const auto expect_line = [&](const std::string& text, int line, const std::string& names) {
    EXPECT_THAT(refusal(text),
                AllOf(HasSubstr(fmt::format("job.toml:{}:", line)), HasSubstr(names)))
        << text;
  };
  expect_line(object + "colour = 3\n", 3, "colour");
  expect_line("[glas]\nmargin = 3\n" + object, 1, "glas");
  expect_line("margin = 3\n" + object, 1, "margin");
  expect_line(object + "size = \n", 3, "");
  expect_line(object + "size = \"40\"\n", 3, "number");
  expect_line(object + "size = 0\n", 3, "more than 0");
  expect_line(object + "size = nan\n", 3, "size");
  expect_line(object + "size = inf\n", 3, "size");
  expect_line(object + "layers = 1.5\n", 3, "whole");
  expect_line(object + "layers = 0\n", 3, "layers");
  expect_line(object + "layers = 99999999999999\n", 3, "layers");
  expect_line(object + "invert = 1\n", 3, "true or false");
  expect_line(object + "method = \"slices\"\n", 3, "slice");
  expect_line(object + "method = 3\n", 3, "quotes");
  expect_line(object + "transform = \"fit\"\n", 3, "list");
  expect_line(object + "transform = [\"fit\",\n\"turn\"]\n", 3, "turn");
  expect_line(object + "turn = [1, 2]\n", 3, "three");
  expect_line(object + "[glass]\nblock = [1, 2, 0]\n", 4, "block");
  expect_line(object + "[glass]\nindex = 0.5\n", 4, "index");
  expect_line(object + "[machine]\nlamp = 0\n", 4, "lamp");
  expect_line(object + "[pause]\nbeats = 70000\n", 4, "beats");
  expect_line("[[object]]\nsize = 3\n", 1, "file");
  expect_line("object = 3\n", 1, "object");
  EXPECT_THAT(refusal("[glass]\nmargin = 3\n"), HasSubstr("no object"));
  EXPECT_THAT(refusal(object + "size = 1\nsize = 2\n"), HasSubstr("job.toml:4"));
}

TEST_F(DescriptionTest, EveryKeyHasItsOwnOption) {
  Description d;
  d.objects.resize(1);
  std::set<std::string> options;
  for (const Parameter& parameter : all_parameters(d)) {
    EXPECT_TRUE(options.insert(parameter.option).second) << parameter.option;
    EXPECT_FALSE(parameter.about.empty()) << parameter.key;
  }
}

/// Sets a parameter to a random allowed value.
class RandomValue {
 public:
  explicit RandomValue(std::mt19937_64& random) : random_(random) {}

  void fill(const Parameter& parameter) {
    parameter_ = &parameter;
    std::visit([this](auto* place) { put(*place); }, parameter.place);
  }

 private:
  double number() {
    const Range& range = parameter_->range;
    const double low = std::isfinite(range.low) ? range.low : -1000;
    const double high = std::isfinite(range.high) ? range.high : low + 1000;
    return std::uniform_real_distribution<>(low + (high - low) * 1e-3, high)(random_);
  }
  std::string text() {
    const auto& names = parameter_->names;
    if (!names.empty()) return names[random_() % names.size()];
    return parameter_->check != nullptr ? "rotate z 30.5" : "my \"own\" 'file' \\ \xc3\xa4.stl";
  }
  void put(double& value) { value = number(); }
  void put(std::optional<double>& value) { value = number(); }
  void put(int& value) { value = static_cast<int>(std::ceil(number())); }
  void put(std::optional<int>& value) { put(value.emplace()); }
  void put(bool& value) { value = random_() % 2 == 0; }
  void put(std::optional<bool>& value) { value = random_() % 2 == 0; }
  void put(std::string& value) { value = text(); }
  void put(std::optional<std::string>& value) { value = text(); }
  void put(std::optional<Triple>& value) { value = Triple{number(), number(), number()}; }
  void put(std::vector<std::string>& value) { value.assign(1 + random_() % 3, text()); }

  std::mt19937_64& random_;
  const Parameter* parameter_ = nullptr;
};

TEST_F(DescriptionTest, ItsTextIsReadBackUnchanged) {
  std::mt19937_64 random(7);
  RandomValue values(random);
  for (int i = 0; i < test::scaled(100); ++i) {
    Description d;
    d.objects.resize(1 + random() % 3);
    for (const Parameter& parameter : all_parameters(d)) {
      if (random() % 2 == 0 || parameter.key == "file") values.fill(parameter);
    }
    for (Object& object : d.objects) object.file = path(object.file);
    if (!d.machine.profile.empty()) d.machine.profile = path(d.machine.profile);
    const std::string text = to_text(d, folder_.file("."));
    Description back = read(text);
    EXPECT_EQ(to_text(back, folder_.file(".")), text);
    const auto first = all_parameters(d), again = all_parameters(back);
    ASSERT_EQ(first.size(), again.size());
    for (std::size_t k = 0; k < first.size(); ++k) {
      const bool same = std::visit(
          [&](auto* place) { return *place == *std::get<decltype(place)>(again[k].place); },
          first[k].place);
      EXPECT_TRUE(same) << first[k].key << "\n" << text;
    }
  }
}

/// Its text would name another file.
TEST_F(DescriptionTest, ANameThatIsNotUtf8IsRefused) {
  Description d;
  d.objects.resize(1);
  for (const char* name : {"M\xfcller.stl", "\xc3", "a\xed\xa0\x80.stl"}) {
    d.objects[0].file = path(name);
    EXPECT_THROW(to_text(d, folder_.file(".")), Error) << name;
  }
  d.objects[0].file = path("M\u00fcller \u20ac \U0001F600.stl");
  EXPECT_EQ(read(to_text(d, folder_.file("."))).objects[0].file, d.objects[0].file);
}

TEST_F(DescriptionTest, TruncatedAnywhereItIsAnErrorOrADescription) {
  const std::string text =
      "[glass]\nblock = [50, 50, 80]\nmaterial = \"k9\"\n[[object]]\nfile = \"a.stl\"\n"
      "transform = [\"rotate z 30\", \"fit\"]\nsize = 40\n[pause]\nevery = 10\n";
  for (std::size_t length = 1; length < text.size(); ++length) {
    try {
      EXPECT_FALSE(read(text.substr(0, length)).objects.empty());
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), Exit::bad_input);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace lamplock::glass
