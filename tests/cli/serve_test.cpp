// `lamplock serve`: one server for a board, one for a port; the address with its token.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test::serve {
namespace {

using testing::HasSubstr;

TEST(Serve, has_one_server_for_a_board_and_for_a_port) {
  const Folder folder;
  const std::string board = folder / "port", jobs = folder / "jobs";
  Running sim({"sim", "--pty", board});
  ASSERT_TRUE(sim.wait_for("listening"));
  Running server({"serve", "--board", board, "--port", "0", "--folder", jobs, "--pair"});
  ASSERT_TRUE(server.wait_for("code for pairing: "));
  const std::string shown = server.out();
  std::smatch found;
  ASSERT_TRUE(std::regex_search(
      shown, found, std::regex("page: http://127\\.0\\.0\\.1:([0-9]+)/#token=[0-9a-f]{32}\n")));
  const Finished second = run({"serve", "--board", board, "--port", "0", "--folder", jobs});
  EXPECT_EQ(second.status, 3);
  EXPECT_THAT(second.err, HasSubstr("error: "));
  EXPECT_EQ(second.out, "");
  const Finished same_port =
      run({"serve", "--board", "virtual", "--port", found[1], "--folder", jobs});
  EXPECT_EQ(same_port.status, 3);
  EXPECT_THAT(same_port.err, HasSubstr("give another port with --port"));
  server.interrupt();
  EXPECT_EQ(server.finish().status, 130);
}

TEST(Serve, MakesTheKeyOfProgramsForOctoPrint) {
  const Folder folder;
  const std::string key = folder / "key";
  std::string first;
  for (int i = 0; i < 2; ++i) {  // the second server has the same key
    Running server({"serve", "--port", "0", "--folder", folder / "jobs", "--octoprint", key});
    ASSERT_TRUE(server.wait_for("use the key in " + key));
    server.interrupt();
    EXPECT_EQ(server.finish().status, 130);
    if (i == 0) first = read(key);
    EXPECT_EQ(read(key), first);
    EXPECT_TRUE(std::regex_match(first, std::regex("[0-9a-f]{32}\n")));
  }
  EXPECT_EQ(std::filesystem::status(key).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  folder.write("short", "abc\n");
  const Finished refused =
      run({"serve", "--port", "0", "--folder", folder / "jobs", "--octoprint", folder / "short"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("is not a key of 16 to 64 letters and digits"));
}

TEST(Watch, shows_the_machine_of_a_server) {
  const Folder folder;
  Running server({"serve", "--board", "virtual", "--port", "0", "--folder", folder / "jobs"});
  ASSERT_TRUE(server.wait_for("page: "));
  const std::string shown = server.out();
  std::smatch found;
  ASSERT_TRUE(std::regex_search(shown, found, std::regex("page: (http://\\S+)\n")));
  const std::string page = found[1];
  Running watch({"watch", page, "--every", "0.1"});
  EXPECT_TRUE(watch.wait_for("Idle  X 0.000 Y 0.000 Z 0.000 mm\n"));
  watch.interrupt();
  EXPECT_EQ(watch.finish().status, 130);
  const Finished once = run({"watch", page, "--once", "--json"});
  EXPECT_EQ(once.status, 0);
  const auto status = nlohmann::json::parse(once.out);
  EXPECT_EQ(status["board"]["state"], "Idle");
  EXPECT_EQ(status["control"]["held"], false);
  const Finished wrong = run({"watch", page.substr(0, page.size() - 32) + std::string(32, '0')});
  EXPECT_EQ(wrong.status, 3);
  EXPECT_THAT(wrong.err, HasSubstr("the token is wrong"));
  Running lost({"watch", page, "--every", "0.1"});
  EXPECT_TRUE(lost.wait_for("Idle"));
  server.interrupt();
  EXPECT_EQ(server.finish().status, 130);
  const Finished end = lost.finish();
  EXPECT_EQ(end.status, 3);
  EXPECT_THAT(end.err, HasSubstr("no server answers"));
}

TEST(Watch, refuses_what_is_no_address) {
  for (const char* page : {"x", "http://127.0.0.1:7125/", "http://127.0.0.1/#token=ab",
                           "http://127.0.0.1:7125/#token=", "http://127.0.0.1:7125/#token=x y",
                           "http://a b:7125/#token=ab", "https://127.0.0.1:7125/#token=ab"}) {
    const Finished finished = run({"watch", page, "--once"});
    EXPECT_EQ(finished.status, 2) << page;
    EXPECT_THAT(finished.err, HasSubstr("error: "));
  }
}

/// A server with an address that the user cannot know would wait for ever.
TEST(Serve, AndSimulatorsEndIfTheirAddressIsLost) {
  const Folder folder;
  const std::string err = folder / "err";
  for (const std::string& command :
       {"serve --port 0 --folder " + (folder / "jobs"), "sim --pty " + (folder / "port")})
    for (const char* const output : {"/dev/full", "&-"}) {
      const std::string line =
          "timeout 20 " + program_path() + " " + command + " >" + output + " 2>" + err;
      const int status = std::system(line.c_str());  // NOLINT(cert-env33-c)
      EXPECT_EQ(WEXITSTATUS(status), 1) << line;
      EXPECT_THAT(read(err), HasSubstr("error: standard output: cannot be written ("));
    }
}

TEST(Serve, refuses_what_it_cannot_use) {
  const Folder folder;
  EXPECT_EQ(run({"serve", "--board", folder / "none", "--folder", folder / "jobs"}).status, 3);
  EXPECT_EQ(run({"serve", "--port", "70000"}).status, 2);
  const Finished finished = run({"serve", "--board", "virtual", "--folder", "/dev/null"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_THAT(finished.err, HasSubstr("give another one with --folder"));
}

}  // namespace
}  // namespace lamplock::cli::test::serve
