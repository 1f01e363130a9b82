// Attacks on the server: each of them is refused, and the server still serves others.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <list>
#include <string>

#include "host/error.hpp"
#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

std::string get(const std::string& target, const std::string& headers) {
  return "GET " + target + " HTTP/1.1\r\n" + headers + "\r\n";
}

std::string post(const std::string& target, const std::string& headers, const std::string& body) {
  return fmt::format("POST {} HTTP/1.1\r\n{}Content-Length: {}\r\n\r\n{}", target, headers,
                     body.size(), body);
}

class Attacks : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    RunningOptions options;
    options.limits.header_time = 300ms;
    options.limits.body_time = 300ms;
    server = new RunningServer(options);
  }
  static void TearDownTestSuite() {
    delete server;
    server = nullptr;
  }
  void TearDown() override {  // it still serves
    EXPECT_EQ(status(get("/", host())), 200);
    EXPECT_EQ(status(call(R"({"jsonrpc":"2.0","id":1,"method":"status"})")), 200);
  }

  static std::string host() { return fmt::format("Host: 127.0.0.1:{}\r\n", server->port()); }
  static std::string permit() { return fmt::format("Authorization: Bearer {}\r\n", token); }
  static std::string json() { return "Content-Type: application/json\r\n"; }
  static std::string bytes() { return "Content-Type: application/octet-stream\r\n"; }
  static std::string call(const std::string& body) {
    return post("/api", host() + permit() + json(), body);
  }
  static int status(const std::string& text) { return request(server->port(), text).status; }
  static std::string upgrade(const std::string& headers) {
    return get("/ws", headers +
                          "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                          "Sec-WebSocket-Version: 13\r\n"
                          "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n");
  }

  static inline RunningServer* server = nullptr;
};

TEST_F(Attacks, foreign_host_as_after_dns_rebinding) {
  const std::string port = std::to_string(server->port());
  for (const std::string& name : {"example.org:" + port, "127.0.0.1.example.org:" + port,
                                  std::string("127.0.0.1:1"), std::string("127.0.0.1")}) {
    EXPECT_EQ(status(get("/", "Host: " + name + "\r\n")), 403) << name;
    EXPECT_EQ(status(upgrade("Host: " + name + "\r\n")), 403) << name;
    EXPECT_EQ(status(post("/api", "Host: " + name + "\r\n" + permit() + json(), "{}")), 403);
  }
  EXPECT_EQ(status("GET / HTTP/1.1\r\n\r\n"), 403);
  EXPECT_EQ(status(get("/", host() + "Host: example.org\r\n")), 403);
}

TEST_F(Attacks, foreign_origin) {
  for (const char* origin :
       {"http://example.org", "null", "http://127.0.0.1:1", "https://127.0.0.1"})
    for (const std::string& text :
         {upgrade(host() + "Origin: " + origin + "\r\n"),
          post("/api", host() + permit() + json() + "Origin: " + origin + "\r\n", "{}")})
      EXPECT_EQ(status(text), 403) << origin;
  const std::string own = fmt::format("Origin: http://127.0.0.1:{}\r\n", server->port());
  EXPECT_EQ(status(get("/", host() + own)), 200);
}

TEST_F(Attacks, no_token_or_a_wrong_one) {
  EXPECT_EQ(status(post("/api", host() + json(), "{}")), 401);
  EXPECT_EQ(status(post("/files/a.ngc", host() + bytes(), "G0X1\n")), 401);
  const std::string wrong = "Authorization: Bearer 0123456789abcdef0123456789abcdee\r\n";
  EXPECT_EQ(status(post("/api", host() + wrong + json(), "{}")), 401);
  RawClient client(server->port(), "wrong", "client-secret-wrong");
  EXPECT_TRUE(client.call("machine.stop").is_null());
  EXPECT_TRUE(client.socket().is_closed());
}

TEST_F(Attacks, form_post_that_needs_no_preflight) {
  for (const char* type :
       {"text/plain", "application/x-www-form-urlencoded", "multipart/form-data", ""}) {
    const std::string header = fmt::format("Content-Type: {}\r\n", type);
    EXPECT_EQ(status(post("/api", host() + permit() + header, "{}")), 415) << type;
    EXPECT_EQ(status(post("/files/a.ngc", host() + permit() + header, "G0\n")), 415) << type;
  }
  EXPECT_EQ(status("OPTIONS /api HTTP/1.1\r\n" + host() + "\r\n"), 405);
}

TEST_F(Attacks, path_that_leaves_the_folder) {
  for (const char* name :
       {"../x.ngc", "..%2fx.ngc", "%2e%2e/x.ngc", "%252e%252e%252fx.ngc", "a%00.ngc",
        "a/../../x.ngc", "", ".x.ngc", "/etc/passwd", "x.html", "x.sh", "x"})
    EXPECT_EQ(status(post(std::string("/files/") + name, host() + permit() + bytes(), "G0\n")), 422)
        << name;
  for (const char* target : {"/../page.html", "/page.html", "/etc/passwd", "/files/a.ngc/", "//"})
    EXPECT_NE(status(get(target, host())), 200) << target;
  EXPECT_TRUE(std::filesystem::is_empty(server->folder()));
  const Reply reply = request(
      server->port(),
      call(
          R"({"jsonrpc":"2.0","id":1,"method":"job.check","params":{"name":"../../etc/passwd"}})"));
  EXPECT_THAT(reply.text, HasSubstr("no such file"));
}

TEST_F(Attacks, a_name_in_codes_is_a_name) {
  EXPECT_EQ(status(post("/files/my%20part%28.ngc", host() + permit() + bytes(), "G0\n")), 201);
  EXPECT_TRUE(std::filesystem::remove(server->folder() / "my part(.ngc"));
}

TEST_F(Attacks, oversized) {
  const auto declared = [&](const char* target, const std::string& headers, const char* length) {
    return status(fmt::format("POST {} HTTP/1.1\r\n{}Content-Length: {}\r\n\r\n", target,
                              host() + permit() + headers, length));
  };
  EXPECT_EQ(declared("/api", json(), "1000000"), 413);
  EXPECT_EQ(declared("/files/a.ngc", bytes(), "99999999999"), 413);
  EXPECT_EQ(declared("/api", json(), "-1"), 400);
  EXPECT_EQ(status(get("/", host() + "X: " + std::string(20'000, 'x') + "\r\n")), 431);
  const std::string chunk = "40000\r\n" + std::string(0x40000, 'x') + "\r\n";
  EXPECT_EQ(status("POST /api HTTP/1.1\r\n" + host() + permit() + json() +
                   "Transfer-Encoding: chunked\r\n\r\n" + chunk + chunk),
            413);
  RawClient client = server->client("oversized");
  client.send_text(std::string(300 * 1024, ' '));
  client.watch(2s);
  EXPECT_TRUE(client.socket().is_closed());
}

TEST_F(Attacks, slow_loris) {
  std::list<RawSocket> slow;
  for (int i = 0; i < 100; ++i) {
    slow.emplace_back(server->port());
    slow.back().send(i % 2 == 0 ? "GET / HT"
                                : post("/api", host() + permit() + json(), "{}").substr(0, 140));
  }
  EXPECT_EQ(status(get("/", host())), 200) << "served meanwhile";
  for (RawSocket& socket : slow) {
    socket.read_all(2s);
    EXPECT_TRUE(socket.is_closed());
  }
}

TEST_F(Attacks, broken_requests) {
  for (const char* text : {"x\r\n\r\n", "GET\r\n\r\n", "\x16\x03\x01\x02\x01\x01\r\n\r\n"})
    EXPECT_EQ(status(text), 400) << text;
  for (const char* body : {"", "{", "[]", "null", "1", R"("x")", R"({"jsonrpc":"2.0"})", "[[[[[[",
                           R"({"jsonrpc":"2.0","id":null,"method":"status"})",
                           R"({"jsonrpc":"2.0","id":1,"method":7})",
                           R"({"jsonrpc":"2.0","id":1,"method":"status","params":[1]})",
                           "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"\xff\"}"})
    EXPECT_THAT(request(server->port(), call(body)).text, HasSubstr("\"error\"")) << body;
  const std::string deep(100'000, '[');
  EXPECT_THAT(request(server->port(), call(deep)).text, HasSubstr("not valid JSON"));
}

/// Every place where a client puts JSON, before a login too.
TEST_F(Attacks, deep_requests) {
  constexpr std::size_t depth = 60'000;  // of 256 KiB that a message may have
  const std::string list = std::string(depth, '[') + std::string(depth, ']');
  std::string object;
  for (std::size_t i = 0; i < depth / 2; ++i) object += R"({"":)";
  object += "0" + std::string(depth / 2, '}');
  for (const std::string& deep : {list, object})
    for (const char* form : {R"({{"jsonrpc":"2.0","id":1,"method":"status","params":{{"a":{}}}}})",
                             R"({{"jsonrpc":"2.0","id":{},"method":"status"}})",
                             R"({{"jsonrpc":"2.0","id":1,"method":"status","client":{}}})", "{}"}) {
      const std::string text = fmt::format(fmt::runtime(form), deep);
      EXPECT_THAT(request(server->port(), call(text)).text, HasSubstr("not valid JSON"));
      RawSocket socket(server->port());
      socket.send(upgrade(host()));
      EXPECT_THAT(socket.read(2s), HasSubstr("101 Switching"));
      std::string frame{'\x81', static_cast<char>(0x80 | 127)};
      for (unsigned shift = 64; shift > 0; shift -= 8)
        frame += static_cast<char>(static_cast<std::uint64_t>(text.size()) >> (shift - 8));
      frame += std::string(4, '\0');
      frame += text;
      socket.send(frame);
      EXPECT_THAT(socket.read(2s), HasSubstr("not valid JSON"));
    }
}

TEST(Connections, of_one_address_leave_room_for_others) {
  RunningOptions options;
  options.limits.connections = 8;
  options.limits.connections_of_address = 4;
  RunningServer server(options);
  const std::string page = get("/", fmt::format("Host: 127.0.0.1:{}\r\n", server.port()));
  constexpr std::uint8_t attacker = 2, other = 3;
  {
    std::list<RawSocket> idle;
    for (int i = 0; i < 20; ++i) idle.emplace_back(server.port(), attacker);
    EXPECT_EQ(request(server.port(), page, other).status, 200);
    EXPECT_EQ(request(server.port(), page, attacker).status, 0);
  }
  EXPECT_TRUE(comes_true([&] { return request(server.port(), page, attacker).status == 200; }));
}

TEST_F(Attacks, upload_that_is_cut_off_or_for_which_the_disk_is_full) {
  const auto upload = [&](const std::string& body) {
    return post("/files/part.ngc", host() + permit() + bytes(), body);
  };
  const std::string file = "G21\n" + std::string(100'000, ' ');
  {
    RawSocket socket(server->port());
    socket.send(upload(file).substr(0, 50'000));
  }
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto on_signal = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{8192, before.rlim_max};  // a longer file fails as on a full disk
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_EQ(status(upload(file)), 422);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, on_signal);
  EXPECT_TRUE(std::filesystem::is_empty(server->folder()));
  EXPECT_EQ(status(upload(file)), 201);
  std::filesystem::remove(server->folder() / "part.ngc");
}

TEST_F(Attacks, second_server_at_the_same_port) {
  Server site({}, JobFolder(server->folder()));
  EXPECT_THROW(WebServer("127.0.0.1", server->port(), site), Error);
}

TEST_F(Attacks, messages_before_the_login) {
  RawSocket socket(server->port());
  socket.send(upgrade(host()));
  EXPECT_THAT(socket.read(2s), HasSubstr("101 Switching"));
  const std::string text = R"({"jsonrpc":"2.0","id":1,"method":"status"})";
  socket.send(std::string{'\x81', static_cast<char>(0x80 | text.size())} + std::string(4, '\0') +
              text);
  const std::string answer = socket.read_all(2s);
  EXPECT_THAT(answer, HasSubstr("login must be the first message"));
  EXPECT_TRUE(socket.is_closed());
}

TEST_F(Attacks, two_hundred_clients) {
  std::list<RawClient> clients;
  for (int i = 0; i < 200; ++i)
    clients.emplace_back(server->port(), token, fmt::format("client-secret-{:04}", i));
  for (RawClient& client : clients) EXPECT_TRUE(client.call("subscribe").contains("result"));
}

TEST_F(Attacks, replies_have_a_policy_without_inline_script) {
  const Reply page = request(server->port(), get("/", host()));
  EXPECT_THAT(page.text,
              HasSubstr("Content-Security-Policy: default-src 'none'; script-src 'self'"));
  EXPECT_THAT(page.text, HasSubstr("style-src 'sha256-"));
  EXPECT_THAT(page.text, testing::Not(HasSubstr("unsafe")));
  EXPECT_THAT(page.text, HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(page.text, HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_THAT(page.text, testing::Not(HasSubstr("Set-Cookie")));
  EXPECT_THAT(page.text, testing::Not(HasSubstr("Access-Control")));
}

}  // namespace
}  // namespace lamplock::serve::test
