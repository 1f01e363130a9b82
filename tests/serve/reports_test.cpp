// Reports of jobs that the server has run: kept, listed with the history, served alone.
#include "host/serve/reports.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "host/job/job.hpp"
#include "host/job/job_file.hpp"
#include "host/job/profile.hpp"
#include "host/serve/content_policy.hpp"
#include "tests/serve/running_server.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::serve::test::reports_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(Reports, are_read_by_their_name_alone) {
  const lamplock::test::TemporaryFolder folder;
  const Reports reports(folder.file("reports"));
  EXPECT_TRUE(reports.names().empty());
  reports.keep("2026-11-29T10:00:00Z", "one");
  reports.keep("2026-11-29T10:05:07Z", "two");
  const auto names = reports.names();
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(reports.read(names.at("2026-11-29T10:00:00Z")), "one");
  EXPECT_EQ(reports.read(names.at("2026-11-29T10:05:07Z")), "two");
  std::string other = names.at("2026-11-29T10:00:00Z");
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
    reports.keep(fmt::format("2026-11-29T10:00:{:02}Z", i), "report");
  const auto names = reports.names();
  EXPECT_EQ(names.size(), Reports::max_kept);
  EXPECT_EQ(names.begin()->first, "2026-11-29T10:00:05Z");
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
  for (int tries = 0; tries < 100; ++tries) {
    const Json history = client.call("history.list")["result"];
    if (!history.empty() && history[0]["report"].is_string()) return history[0]["report"];
    std::this_thread::sleep_for(20ms);
  }
  return "";
}

TEST(History, has_the_report_of_a_job_of_points) {
  RunningServer server;
  geometry::PointCloud points;
  for (int i = 0; i < 50; ++i) points.push_back({0.05 * i, 0, 0});
  job::write_job_file(server.folder() / "line.llj",
                      job::make_job(points, job::default_profile(), job::JobOptions{}));
  RawClient client = server.client("client");
  client.call("control.take");
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

}  // namespace
}  // namespace lamplock::serve::test::reports_test
