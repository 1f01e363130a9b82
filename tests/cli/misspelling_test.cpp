// One letter deleted, added or swapped in a command, an option or a setting: the message suggests
// the right name. All slips are tried in this process.
#include "host/suggestion.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "host/cli/program.hpp"
#include "host/cli/usage_error.hpp"
#include "host/error.hpp"
#include "host/link/board_settings.hpp"
#include "host/run/board_names.hpp"
#include "host/similar_files.hpp"
#include "tests/cli/program.hpp"
#include "tests/scale.hpp"

namespace lamplock::cli::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Every word that differs by one letter deleted, added or swapped with the next one, after
/// `begin`. Small runs add fewer letters.
std::set<std::string> slips_of(const std::string& name, std::size_t begin) {
  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz_-0";
  std::set<std::string> slips;
  for (std::size_t i = begin; i < name.size(); ++i) {
    std::string slip = name;
    slips.insert(slip.erase(i, 1));
    if (i + 1 == name.size()) continue;
    slip = name;
    std::swap(slip[i], slip[i + 1]);
    slips.insert(slip);
  }
  const auto shares = static_cast<std::size_t>(std::min(16, scaled(16)));
  for (std::size_t i = begin; i <= name.size(); ++i)
    for (std::size_t k = i % (16 / shares); k < letters.size(); k += 16 / shares) {
      std::string slip = name;
      slips.insert(slip.insert(i, 1, letters[k]));
    }
  slips.erase(name);
  return slips;
}

/// Counts the slips whose message has the right name in quotes; words that are names are no slips.
class Score {
 public:
  using Message = std::function<std::string(const std::string& slip)>;
  void add(const std::string& name, const std::vector<std::string>& names, const Message& message) {
    for (const std::string& slip : slips_of(name, name.starts_with("--") ? 2 : 0)) {
      if (slip == "--" || slip.empty() ||
          std::find(names.begin(), names.end(), slip) != names.end())
        continue;
      ++tried_;
      if (message(slip).find("'" + name + "'") != std::string::npos) ++found_;
    }
  }
  double share() const { return static_cast<double>(found_) / static_cast<double>(tried_); }
  std::size_t tried() const { return tried_; }

 private:
  std::size_t tried_ = 0, found_ = 0;
};

constexpr double wanted_share = 0.95;

/// The remedy of the error about these arguments; empty if there is none.
std::string remedy_of(const Command& program, const std::vector<std::string>& arguments) {
  const auto error = usage_error(program, arguments);
  if (!error) return "";
  const std::string text(error->message());
  return text.substr(text.find("; ") + 1);
}

TEST(Misspelling, CommandsAreSuggested) {
  const auto program = make_program();
  std::vector<std::string> names;
  for (const Command& command : program->commands()) names.push_back(command.name());
  Score score;
  for (const std::string& name : names)
    score.add(name, names, [&](const auto& slip) { return remedy_of(*program, {slip}); });
  EXPECT_GT(score.tried(), 100u);
  EXPECT_GE(score.share(), wanted_share);
}

TEST(Misspelling, OptionsOfEveryCommandAreSuggested) {
  const auto program = make_program();
  Score score;
  const auto add = [&](const Command& command, std::vector<std::string> words) {
    std::vector<std::string> names;
    for (const Option& option : command.options())
      for (const std::string& name : option.typed_names()) names.push_back(name);
    words.emplace_back();
    for (const std::string& name : names)
      if (name.starts_with("--"))
        score.add(name, names, [&](const auto& slip) {
          words.back() = slip;
          return remedy_of(*program, words);
        });
  };
  // Options that many commands share are tried once.
  for (const Command& command : program->commands()) {
    if (command.name() == "engrave" || command.name() == "raster" || command.name() == "cut")
      add(command, {command.name()});
    for (const Command& inner : command.commands())
      if (inner.name() == "get" || inner.name() == "pulse" || inner.name() == "card")
        add(inner, {command.name(), inner.name()});
  }
  EXPECT_GT(score.tried(), 1000u);
  EXPECT_GE(score.share(), wanted_share);
}

TEST(Misspelling, SettingsAreSuggested) {
  const std::vector<std::string> names = link::setting_names();
  Score score;
  for (const std::string& name : names)
    score.add(name, names, [&](const std::string& slip) -> std::string {
      try {
        link::number_of_setting(slip, "test");
        return "";
      } catch (const Error& error) {
        return error.what();
      }
    });
  EXPECT_GT(score.tried(), 1000u);
  EXPECT_GE(score.share(), wanted_share);
}

TEST(Misspelling, BoardsAndPortsAreSuggested) {
  const std::vector<std::string> ports{"/dev/ttyACM0", "/dev/ttyUSB1"};
  EXPECT_THAT(run::remedy_for_name("virtaul", ports), HasSubstr("did you mean 'virtual'?"));
  EXPECT_THAT(run::remedy_for_name("ubs", ports), HasSubstr("did you mean 'usb'?"));
  EXPECT_THAT(run::remedy_for_name("ttyACM", ports), HasSubstr("did you mean '/dev/ttyACM0'?"));
  EXPECT_THAT(run::remedy_for_name("engraver", ports), HasSubstr("give virtual, chip, auto, usb"));
}

TEST(Misspelling, FilesAreSuggested) {
  const Folder folder;
  folder.write("ball.stl", "x");
  folder.write("Part.NGC", "x");
  std::filesystem::create_directory(folder / "models");
  folder.write("models/cube.obj", "x");
  const auto remedy = [&](const char* name) { return missing_path_remedy(folder / name); };
  EXPECT_EQ(remedy("bal.stl"), "did you mean '" + folder / "ball.stl" + "'?");
  EXPECT_EQ(remedy("blal.stl"), "did you mean '" + folder / "ball.stl" + "'?");
  EXPECT_EQ(remedy("ball"), "did you mean '" + folder / "ball.stl" + "'?");
  EXPECT_EQ(remedy("part.ngc"), "did you mean '" + folder / "Part.NGC" + "'?");
  EXPECT_EQ(remedy("modles/cube.obj"), "did you mean '" + folder / "models/cube.obj" + "'?");
  EXPECT_EQ(remedy("elsewhere/cube.obj"), "check its folder: there is no " + folder / "elsewhere");
  EXPECT_EQ(remedy("statue.ply"), "check the name");
  // A folder is no file.
  EXPECT_EQ(remedy("model"), "check the name");
}

/// A second reading of the definition: recursion from the end, without a table.
std::size_t slow_distance(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  const auto cut = [](std::string_view text, std::size_t n) {
    return text.substr(0, text.size() - n);
  };
  std::size_t least =
      std::min({slow_distance(cut(a, 1), b) + 1, slow_distance(a, cut(b, 1)) + 1,
                slow_distance(cut(a, 1), cut(b, 1)) + (a.back() == b.back() ? 0 : 1)});
  if (a.size() > 1 && b.size() > 1 && a.back() == b[b.size() - 2] && b.back() == a[a.size() - 2])
    least = std::min(least, slow_distance(cut(a, 2), cut(b, 2)) + 1);
  return least;
}

TEST(EditDistance, IsThatOfTheDefinition) {
  std::mt19937_64 random(33);
  const auto word = [&random] {
    std::string text(random() % 6, ' ');
    for (char& letter : text) letter = static_cast<char>('a' + random() % 3);
    return text;
  };
  for (int i = 0; i < lamplock::test::scaled(300, 50); ++i) {
    const std::string a = word(), b = word();
    EXPECT_EQ(edit_distance(a, b), slow_distance(a, b)) << a << " " << b;
  }
  EXPECT_EQ(edit_distance("spacing", "spacign"), 1u);
}

TEST(SimilarNames, AreTheNearestOnes) {
  const std::vector<std::string> names{"--size", "--speed", "--seed", "--statistics"};
  EXPECT_THAT(similar_names("--sise", names), ElementsAre("--size"));
  EXPECT_THAT(similar_names("sized", names), ElementsAre("--size"));
  EXPECT_THAT(similar_names("--sped", names), ElementsAre("--speed", "--seed"));
  EXPECT_THAT(similar_names("--stat", names), ElementsAre("--statistics")) << "its beginning";
  EXPECT_THAT(similar_names("densty", {"density_g_cm3", "dose"}), ElementsAre("density_g_cm3"));
  EXPECT_THAT(similar_names("dens", {"dent_mm"}), IsEmpty()) << "too short to be likely";
  EXPECT_THAT(similar_names("--colour", names), IsEmpty());
  EXPECT_THAT(similar_names("", names), IsEmpty());
  EXPECT_THAT(similar_names("-x", {"-o", "-h"}), IsEmpty());
  EXPECT_THAT(similar_names(std::string(1'000'000, 's'), names), IsEmpty());
  EXPECT_EQ(question_of({"a", "b", "c"}), "did you mean 'a', 'b' or 'c'?");
  EXPECT_EQ(did_you_mean("zz", {"abc"}, "give abc"), "give abc");
}

}  // namespace
}  // namespace lamplock::cli::test
