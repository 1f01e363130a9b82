// Reports of jobs that the server has run: kept, listed with the history, served alone.
#include "host/serve/reports.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "host/job/job.hpp"
#include "host/job/job_file.hpp"
#include "host/job/profile.hpp"
#include "host/raster/rows.hpp"
#include "host/serve/content_policy.hpp"
#include "host/serve/run_page.hpp"
#include "tests/serve/running_server.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::serve::test::reports_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

TEST(Reports, are_read_by_their_name_alone) {
  const lamplock::test::TemporaryFolder folder;
  const Reports reports(folder.file("reports"));
  EXPECT_TRUE(reports.names().empty());
  // Of the same second.
  const std::string one = Reports::new_name("2026-11-29T10:00:00Z"),
                    two = Reports::new_name("2026-11-29T10:00:00Z");
  reports.keep(one, "one");
  reports.keep(two, "two");
  EXPECT_EQ(reports.names(), (std::set{one, two}));
  EXPECT_EQ(reports.read(one), "one");
  EXPECT_EQ(reports.read(two), "two");
  std::string other = one;
  other.back() = other.back() == '0' ? '1' : '0';
  folder.write("2026-11-29T10-00-00Z-0123456789abcdef0123456789abcdef.html", "outside");
  const std::string beside = "../2026-11-29T10-00-00Z-0123456789abcdef0123456789abcdef";
  for (const std::string& name : {other, std::string(), std::string("2026"), beside})
    EXPECT_EQ(reports.read(name), std::nullopt) << name;
}

TEST(Reports, the_oldest_go_first) {
  const lamplock::test::TemporaryFolder folder;
  const Reports reports(folder.file("reports"));
  for (std::size_t i = 0; i < Reports::max_kept + 5; ++i)
    reports.keep(Reports::new_name(fmt::format("2026-11-29T10:00:{:02}Z", i)), "report");
  const auto names = reports.names();
  EXPECT_EQ(names.size(), Reports::max_kept);
  EXPECT_EQ(names.begin()->substr(0, 20), "2026-11-29T10-00-05Z");
}

TEST(AlonePolicy, permits_the_script_and_style_of_its_document) {
  // By `printf %s 'a()' | openssl dgst -sha256 -binary | base64`, and the same of `b{}`.
  EXPECT_EQ(alone_policy("<style>b{}</style><script type=\"x\">c</script><script>a()</script>"),
            "default-src 'none'; script-src 'sha256-qVpDBgj7bpq5hMAcGp3AOc79J3Y1Z4HvySTwKrWDoy4='; "
            "style-src 'sha256-7yqHVAesot11p6HczDsgKRipvI5UPgs97z80zNXlans='; img-src data:; "
            "base-uri 'none'; form-action 'none'; frame-ancestors 'none'; sandbox allow-scripts");
}

/// The name of the report of the only job in the history.
std::string report_of_job(RawClient& client) {
  std::string name;
  comes_true([&] {
    const Json history = client.call("history.list")["result"];
    if (!history.empty() && history[0]["report"].is_string()) name = history[0]["report"];
    return !name.empty();
  });
  return name;
}

/// The sender tries to stop the machine for ten seconds; its user is not to wait for the result.
TEST(Stop, of_points_without_a_connection_names_the_emergency_stop_at_once) {
  RunningServer server;
  geometry::PointCloud points;
  for (int row = 0; row < 50; ++row)
    for (int column = 0; column < 400; ++column) points.push_back({0.01 * column, 0.01 * row, 0});
  job::write_job_file(server.folder() / "long.llj",
                      job::make_job(points, job::default_profile(), job::JobOptions{}));
  RawClient client = server.controller();
  const auto console = [&client] { return client.call("console.lines")["result"].dump(); };
  client.call("job.start", {{"name", "long.llj"}});
  ASSERT_TRUE(comes_true([&] { return server.machine().view().job.done > 50; }));
  server.written().is_unplugged = true;
  ASSERT_TRUE(
      comes_true([&] { return console().find("the board does not answer") != std::string::npos; }));
  client.call("machine.stop");
  EXPECT_TRUE(comes_true([&] { return console().find("emergency stop") != std::string::npos; }));
  EXPECT_TRUE(server.machine().view().job.is_running) << "before the ten seconds";
  server.written().is_unplugged = false;
  EXPECT_NE(server.wait_for_end(), "done");
}

TEST(History, has_the_report_of_a_job_of_points) {
  RunningServer server;
  geometry::PointCloud points;
  for (int i = 0; i < 50; ++i) points.push_back({0.05 * i, 0, 0});
  job::write_job_file(server.folder() / "line.llj",
                      job::make_job(points, job::default_profile(), job::JobOptions{}));
  RawClient client = server.controller();
  client.call("job.start", {{"name", "line.llj"}});
  EXPECT_EQ(server.wait_for_end(), "done");
  const std::string name = report_of_job(client);
  ASSERT_NE(name, "");
  const std::string host = fmt::format("Host: 127.0.0.1:{}\r\n", server.port());
  const auto get = [&](const std::string& target) {
    return request(server.port(), "GET " + target + " HTTP/1.1\r\n" + host + "\r\n");
  };
  const Reply reply = get("/reports/" + name);
  EXPECT_EQ(reply.status, 200);
  EXPECT_THAT(reply.text, HasSubstr("sandbox allow-scripts"));
  EXPECT_THAT(reply.text, HasSubstr("line.llj"));
  EXPECT_THAT(reply.text, HasSubstr("\"points_fired\":50"));
  EXPECT_EQ(get("/reports/").status, 404);
  EXPECT_EQ(get("/reports/../line.llj").status, 404);
  EXPECT_EQ(get("/reports/" + name + ".html").status, 404);
  EXPECT_EQ(request(server.port(),
                    "POST /reports/" + name + " HTTP/1.1\r\n" + host + "Content-Length: 0\r\n\r\n")
                .status,
            405);
  EXPECT_EQ(
      request(server.port(), "GET /reports/" + name + " HTTP/1.1\r\nHost: evil.example\r\n\r\n")
          .status,
      403);
  EXPECT_EQ(client.call("job.list")["result"].size(), 1u) << "reports are no files of clients";
}

/// The history when it has this many jobs that have reports; they are written after their end.
Json reported(RawClient& client, std::size_t jobs) {
  Json history;
  comes_true([&] {
    history = client.call("history.list")["result"];
    const auto has_report = [](const Json& job) { return job["report"].is_string(); };
    return history.size() == jobs && std::ranges::all_of(history, has_report);
  });
  return history;
}

std::string page_of(const RunningServer& server, const Json& job) {
  const Reply reply =
      request(server.port(), fmt::format("GET /reports/{} HTTP/1.1\r\nHost: "
                                         "127.0.0.1:{}\r\n\r\n",
                                         job["report"].get<std::string>(), server.port()));
  EXPECT_EQ(reply.status, 200);
  return reply.text;
}

TEST(History, has_a_report_of_each_program_also_of_one_second) {
  RunningServer server;
  std::string text = "G21G90\nM3S500\n";
  for (int i = 0; i < 50; ++i) text += fmt::format("G1X{}Y{}F3000\n", i % 2 == 0 ? 40 : -40, i);
  server.add_file("long.ngc", text);
  server.add_file("wrong.ngc", "G1X1\n");
  RawClient client = server.controller();
  for (const char* name : {"one.ngc", "two.ngc"}) {
    server.add_file(name, "G21G90\nM3S500\nG1X1F3000\n");
    client.call("job.start", {{"name", name}});
    EXPECT_EQ(server.wait_for_end(), "done");
    EXPECT_TRUE(server.wait_for_state("Idle"));
  }
  client.call("job.start", {{"name", "long.ngc"}});
  client.watch(1s);
  client.call("machine.stop");
  EXPECT_EQ(server.wait_for_end(), "stopped");
  const Json history = reported(client, 3);
  ASSERT_EQ(history.size(), 3u);
  EXPECT_NE(history[1]["report"], history[2]["report"]);
  EXPECT_THAT(page_of(server, history[1]), HasSubstr("two.ngc"));
  EXPECT_THAT(page_of(server, history[2]), HasSubstr("one.ngc"));
  const std::string page = page_of(server, history[0]);
  EXPECT_THAT(page, HasSubstr("<td>stopped"));
  EXPECT_THAT(page, HasSubstr("class=\"done\""));
  EXPECT_THAT(page, HasSubstr("class=\"cut\"")) << "the part that is not done";
  // Nothing was sent of a program that is wrong.
  EXPECT_TRUE(server.wait_for_state("Idle"));
  client.call("job.start", {{"name", "wrong.ngc"}});
  EXPECT_EQ(server.wait_for_end(), "failed");
  EXPECT_TRUE(comes_true([&] { return client.call("history.list")["result"].size() == 4; }));
  EXPECT_EQ(client.call("history.list")["result"][0]["report"], Json());
}

TEST(History, the_report_of_a_stopped_loop_shows_no_piece_as_done) {
  RunningServer server;
  RawClient client = server.start(
      "loop.ngc", "G21G90\nM3S500\no1 repeat [50]\nG1X40F3000\nG1X-40\no1 endrepeat\n");
  client.watch(1s);
  client.call("machine.stop");
  EXPECT_EQ(server.wait_for_end(), "stopped");
  const Json history = reported(client, 1);
  ASSERT_EQ(history.size(), 1u);
  const std::string page = page_of(server, history[0]);
  EXPECT_THAT(page, HasSubstr("not known to be done"));
  EXPECT_THAT(page, testing::Not(HasSubstr("class=\"done\"")));
}

TEST(History, has_a_report_of_rows) {
  RunningServer server;
  job::Profile profile = job::default_profile();
  profile.settings.set_milli(settings::Id::laser_mode, 1000);
  raster::RowOptions options;
  options.pitch_mm = 1;
  options.feed_mm_min = 6000;
  options.overscan_mm = 3;
  job::write_job_file(
      server.folder() / "rows.llj",
      raster::make_rows({4, 2, std::vector<std::uint16_t>(8, 65535)}, options, profile));
  RawClient client = server.controller();
  client.call("job.start", {{"name", "rows.llj"}});
  EXPECT_EQ(server.wait_for_end(), "done") << server.machine().view().job.message;
  const Json history = reported(client, 1);
  ASSERT_EQ(history.size(), 1u);
  const std::string page = page_of(server, history[0]);
  EXPECT_THAT(page, HasSubstr("<h1>rows.llj</h1>"));
  EXPECT_THAT(page, HasSubstr("Starvations</th><td>0<"));
  EXPECT_THAT(page, HasSubstr("class=\"done\""));
  EXPECT_THAT(page, Not(HasSubstr("class=\"cut\""))) << "all is done";
}

TEST(RunPage, shows_names_of_files_as_text) {
  material::JobRecord record;
  record.file = "<b>.ngc";
  record.result = "done";
  const std::string page = run_page(record, {}, {{{0, 0, 0}}, {{1, 1, 0}, 1, false}});
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;.ngc"));
  EXPECT_THAT(page, HasSubstr("M0.000 -0.000L1.000 -1.000"));
}

}  // namespace
}  // namespace lamplock::serve::test::reports_test
