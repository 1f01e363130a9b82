// `check` and `send` with (probeopen NAME): names, notes and files. Contacts: tests/run.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class ProbeLogOptions : public testing::Test {
 protected:
  std::string program(const std::string& text) const { return folder_.write("p.ngc", text); }
  Finished send(const std::string& file, std::vector<std::string> options) const {
    options.insert(options.begin(), {"send", file, "--board", "virtual"});
    return run(options);
  }
  std::string logs() const {
    std::filesystem::create_directories(folder_.path() / "logs");
    return folder_ / "logs";
  }

  Folder folder_;
};

TEST_F(ProbeLogOptions, CheckNamesTheLogs) {
  const std::string file = program(
      "(probeopen a.txt)\nG38.3 Z-1 F600 (PROBEOPEN b c.txt)\n(probeclose)\no1 repeat [2]\n"
      "(probeopen d.txt)\nG0 X1\no1 endrepeat\no2 if [0]\n(probeopen e.txt)\no2 endif\nM2\n");
  const Finished done = run({"check", file});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("logs      a.txt, b c.txt, d.txt: written by lamplock send"));
  const auto document = nlohmann::json::parse(run({"check", file, "--json"}).out);
  EXPECT_EQ(document["probe_logs"], (nlohmann::json{"a.txt", "b c.txt", "d.txt"}));
  EXPECT_THAT(run({"check", program("G0 X1 (a probeopen b)\n")}).out, Not(HasSubstr("logs")));
}

/// Nothing is written where the user has not permitted it.
TEST_F(ProbeLogOptions, WithoutAFolderIsOneNote) {
  const std::string file = program("(probeopen a.txt)\nG38.3 Z-1 F600\n(probeopen a.txt)\nX2\n");
  const auto before = folder_.files();
  const Finished sent = send(file, {});
  EXPECT_EQ(sent.status, 0) << sent.err;
  EXPECT_THAT(sent.err, HasSubstr("note: " + file +
                                  ": its probe log (a.txt) is not written; "
                                  "--probe-logs FOLDER writes it"));
  EXPECT_EQ(sent.err.find("--probe-logs"), sent.err.rfind("--probe-logs"));
  EXPECT_EQ(folder_.files(), before);
  EXPECT_THAT(sent.out, HasSubstr("2 of 2 lines"));
}

TEST_F(ProbeLogOptions, FilesAreInTheFolder) {
  const std::string text = "G21\n(probeopen a.txt)\nG0 X2\nG38.3 Z-1 F600\n(MSG, hi)\nG0 X3\nM2\n";
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--dry"}, {"--from", "4"}}) {
    const std::string file = program(text);
    std::vector<std::string> options{"--probe-logs", logs()};
    options.insert(options.end(), more.begin(), more.end());
    folder_.write("logs/a.txt", "of another run\n");
    const Finished sent = send(file, options);
    EXPECT_EQ(sent.status, 0) << sent.err;
    EXPECT_THAT(sent.err, Not(HasSubstr("probe log")));
    EXPECT_EQ(read(folder_ / "logs/a.txt"), "") << "no contact";
  }
  const std::string calls =
      program("G91\no1 repeat [2]\n(probeopen b.txt)\nG38.3 Z-1 F600\no1 endrepeat\n");
  EXPECT_EQ(send(calls, {"--probe-logs", logs()}).status, 0);
  EXPECT_EQ(read(folder_ / "logs/b.txt"), "");
}

TEST_F(ProbeLogOptions, BadNamesAreRefused) {
  const std::string outside = "needs the plain name of a file";
  for (const std::string name : {"../a", "/tmp/a", "a/b", "..", ".", "", "a\\b", "a..b"}) {
    const std::string file = program("G21\nG0 X1\n(probeopen " + name + ")\nG38.3 Z-1 F600\n");
    for (const Finished& ended :
         {run({"check", file}), send(file, {}), send(file, {"--probe-logs", logs()})}) {
      EXPECT_EQ(ended.status, 2) << name;
      EXPECT_THAT(ended.err, HasSubstr("error: " + file + ":3: ")) << name;
      EXPECT_THAT(ended.err, HasSubstr(outside)) << name;
    }
  }
  const std::string file = program("(probeopen p.ngc)\nG38.3 Z-1 F600\n");
  const Finished itself = send(file, {"--probe-logs", folder_.path().string()});
  EXPECT_EQ(itself.status, 2);
  EXPECT_THAT(itself.err, HasSubstr("the probe log would replace the program"));
  EXPECT_THAT(read(file), HasSubstr("G38.3"));
  const Finished none = send(file, {"--probe-logs", folder_ / "none"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("no such folder"));
  EXPECT_THAT(send(folder_.write("a.llj", "x"), {"--probe-logs", logs()}).err,
              HasSubstr("--probe-logs: is for programs of G-code, not for jobs"));
}

}  // namespace
}  // namespace lamplock::cli::test
