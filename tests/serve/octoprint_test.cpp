// A subset of OctoPrint's REST, as slicers use it; what it refuses.
#include "host/serve/octoprint.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "host/error.hpp"
#include "host/serve/multipart.hpp"
#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* api_key = "fedcba9876543210fedcba9876543210";

RunningOptions with_key(bool is_simulated = true) {
  return {.is_simulated = is_simulated, .octoprint_key = api_key};
}

/// A program with a key.
struct Slicer {
  std::uint16_t port = 0;
  std::string key = api_key, more{};  ///< more: other headers

  Reply send(const std::string& method, const std::string& path, const std::string& type = "",
             const std::string& body = "") const {
    std::string text =
        fmt::format("{} /api/{} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nX-Api-Key: {}\r\n{}", method,
                    path, port, key, more);
    if (!type.empty())
      text += fmt::format("Content-Type: {}\r\nContent-Length: {}\r\n", type, body.size());
    return request(port, text + "\r\n" + body);
  }
  Reply get(const std::string& path) const { return send("GET", path); }
  Reply post(const std::string& path, const Json& body) const {
    return send("POST", path, "application/json; charset=UTF-8", body.dump());
  }
  Reply upload(const std::string& name, const std::string& text,
               const std::string& fields = "") const {
    const std::string body =
        fields +
        fmt::format(
            "--b0undary\r\nContent-Disposition: form-data; name=\"file\"; filename=\"{}\"\r\n"
            "Content-Type: application/octet-stream\r\n\r\n{}\r\n--b0undary--\r\n",
            name, text);
    return send("POST", "files/local", "multipart/form-data; boundary=b0undary", body);
  }
};

std::string field(const std::string& name, const std::string& value) {
  return fmt::format("--b0undary\r\nContent-Disposition: form-data; name=\"{}\"\r\n\r\n{}\r\n",
                     name, value);
}

Json body_of(const Reply& reply) {
  return Json::parse(reply.text.substr(reply.text.find("\r\n\r\n") + 4), nullptr, false);
}

std::string long_program() {
  std::string text = "G21G90\nM3S500\n";
  for (int i = 0; i < 200; ++i) text += fmt::format("G1X{}F3000\n", i % 2 == 0 ? 40 : -40);
  return text + "M5\n";
}

std::string state_of(const Slicer& slicer) {
  return body_of(slicer.get("printer"))["state"]["text"].get<std::string>();
}

bool is_under_way(const Slicer& slicer) {
  const Json done = body_of(slicer.get("job"))["progress"]["completion"];
  return done.is_number() && done.get<double>() > 1;
}

bool reaches(const Slicer& slicer, const std::string& state) {
  for (int i = 0; i < 500; ++i) {
    if (state_of(slicer) == state) return true;
    std::this_thread::sleep_for(20ms);
  }
  return false;
}

TEST(OctoPrintRest, a_slicer_sends_starts_pauses_and_cancels) {
  RunningServer server(with_key());
  const Slicer slicer{server.port()};
  EXPECT_EQ(body_of(slicer.get("version"))["text"].get<std::string>().substr(0, 9), "OctoPrint");
  EXPECT_EQ(slicer.post("login", {{"passive", true}}).status, 200);
  EXPECT_EQ(state_of(slicer), "Operational");
  const Reply sent = slicer.upload("long cut.gcode", long_program(),
                                   field("select", "true") + field("print", "true"));
  EXPECT_EQ(sent.status, 201) << sent.text;
  EXPECT_EQ(body_of(sent)["files"]["local"]["name"], "long cut.gcode");
  EXPECT_TRUE(reaches(slicer, "Printing"));
  EXPECT_EQ(body_of(slicer.get("job"))["job"]["file"]["name"], "long cut.gcode");
  EXPECT_EQ(slicer.post("job", {{"command", "start"}}).status, 409);  // it runs
  for (int i = 0; i < 500 && !is_under_way(slicer); ++i) std::this_thread::sleep_for(20ms);
  EXPECT_EQ(slicer.post("job", {{"command", "pause"}, {"action", "pause"}}).status, 204);
  EXPECT_TRUE(reaches(slicer, "Paused"));
  EXPECT_EQ(slicer.post("job", {{"command", "pause"}, {"action", "resume"}}).status, 204);
  EXPECT_TRUE(reaches(slicer, "Printing"));
  EXPECT_EQ(slicer.post("job", {{"command", "cancel"}}).status, 204);
  EXPECT_EQ(server.wait_for_end(), "stopped");
  EXPECT_TRUE(server.wait_for_state("Idle"));
  EXPECT_EQ(slicer.post("printer/command", {{"commands", {"G90", "G0X1"}}}).status, 204);
  EXPECT_EQ(slicer.post("files/local/long%20cut.gcode", {{"command", "select"}}).status, 204);
}

TEST(OctoPrintRest, needs_its_key_and_the_name_of_the_server) {
  RunningServer server(with_key());
  const std::string text = "G1X1F100\n";
  for (const std::string& key : {std::string("wrong"), std::string(token), std::string()}) {
    const Slicer slicer{server.port(), key};
    EXPECT_EQ(slicer.get("version").status, 403);
    EXPECT_EQ(slicer.upload("a.gcode", text).status, 403);
    EXPECT_EQ(slicer.post("job", {{"command", "cancel"}}).status, 403);
  }
  const Slicer foreign{server.port(), api_key, "Origin: http://evil.example\r\n"};
  EXPECT_EQ(foreign.get("version").status, 403);
  EXPECT_EQ(foreign.upload("a.gcode", text).status, 403);
  EXPECT_EQ(
      request(
          server.port(),
          fmt::format("GET /api/version HTTP/1.1\r\nHost: evil.example:{}\r\nX-Api-Key: {}\r\n\r\n",
                      server.port(), api_key))
          .status,
      403);
  const Slicer slicer{server.port()};
  EXPECT_EQ(slicer.get("settings").status, 404);
  EXPECT_EQ(slicer.send("DELETE", "files/local/a.gcode").status, 405);
  EXPECT_EQ(slicer.send("POST", "job", "text/plain", "{}").status, 415);
  RunningServer without;
  EXPECT_EQ(Slicer{without.port()}.get("version").status, 404);
}

TEST(OctoPrintRest, refuses_bad_files_and_commands) {
  RunningServer server(with_key());
  const Slicer slicer{server.port()};
  for (const char* name : {"a.exe", ".hidden.gcode", "a\nb.gcode"})
    EXPECT_EQ(slicer.upload(name, "G1X1F100\n").status, 400) << name;
  EXPECT_EQ(slicer.upload("../../inside.gcode", "G1X1F100\n").status, 201);  // its last name
  EXPECT_TRUE(std::filesystem::exists(server.folder() / "inside.gcode"));
  EXPECT_EQ(slicer.post("job", {{"command", "start"}}).status, 409);  // none is selected
  EXPECT_EQ(slicer.post("job", {{"command", "restart"}}).status, 400);
  EXPECT_EQ(slicer.post("job", {{"command", 7}}).status, 400);
  EXPECT_EQ(slicer.post("job", Json::array()).status, 400);
  EXPECT_EQ(slicer.post("printer/command", {{"command", 7}}).status, 400);
  EXPECT_EQ(slicer.post("printer/command", Json::object()).status, 400);
  EXPECT_EQ(slicer.post("files/local/..%2fa.gcode", {{"command", "select"}}).status, 400);
  EXPECT_EQ(slicer.post("files/local/none.gcode", {{"command", "select"}}).status, 400);
}

TEST(OctoPrintRest, fires_only_where_a_page_may_not_object) {
  RunningServer server(with_key());
  const Slicer slicer{server.port()};
  RawClient page = server.controller();
  const std::string start = field("print", "true");
  EXPECT_THAT(slicer.upload("a.gcode", long_program(), start).text,
              HasSubstr("a page holds control"));
  EXPECT_FALSE(std::filesystem::exists(server.folder() / "a.gcode"));
  EXPECT_EQ(slicer.post("printer/command", {{"command", "G0X1"}}).status, 409);
  EXPECT_EQ(slicer.post("job", {{"command", "cancel"}}).status, 204);  // always
  RunningServer real(with_key(false));
  const Slicer other{real.port()};
  EXPECT_EQ(other.upload("a.gcode", long_program()).status, 201);
  EXPECT_THAT(other.upload("b.gcode", long_program(), start).text, HasSubstr("may not fire"));
  EXPECT_THAT(other.post("printer/command", {{"command", "M3S1"}}).text, HasSubstr("may not fire"));
}

TEST(Forms, are_read_and_cut_forms_refused) {
  const std::string type = "multipart/form-data; boundary=\"x y\"";
  const std::string body =
      "--x y\r\nContent-Disposition: form-data; name=\"a\"\r\n\r\n1\r\n--x\r\n\r\n--x y\r\n"
      "Content-Disposition: form-data; name=\"f\"; filename=\"n.nc\"\r\n\r\nG1\r\n\r\n--x y--\r\n";
  const std::vector<FormPart> parts = parse_form(type, body);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "a");
  EXPECT_EQ(parts[0].content, "1\r\n--x\r\n");
  EXPECT_EQ(parts[1].file_name, "n.nc");
  EXPECT_EQ(parts[1].content, "G1\r\n");
  const std::size_t end = body.size() - 4;  // with less, "--" is not complete
  for (std::size_t cut = 0; cut < end; ++cut)
    EXPECT_THROW(parse_form(type, std::string_view(body).substr(0, cut)), Error) << cut;
  EXPECT_THROW(parse_form("multipart/form-data", body), Error);
  std::mt19937 random(1);
  for (int i = 0; i < 3000; ++i) {  // any bytes: an answer or an Error
    std::string any = body;
    for (int k = 0; k < 3; ++k) any[random() % any.size()] = static_cast<char>(random());
    try {
      parse_form(type, any);
    } catch (const Error&) {
      continue;
    }
  }
}

}  // namespace
}  // namespace lamplock::serve::test
