// Logins with a password, and what other computers need to reach the server.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/serve/hashes.hpp"
#include "host/serve/log_file.hpp"
#include "host/serve/logins.hpp"
#include "host/serve/serve.hpp"
#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test::logins {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* password = "a good password";

std::string login_text(std::uint16_t port, const std::string& body,
                       const char* type = "application/json") {
  return fmt::format(
      "POST /login HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: {}\r\n"
      "Content-Length: {}\r\n\r\n{}",
      port, type, body.size(), body);
}

Reply login(const RunningServer& server, const std::string& given) {
  return request(server.port(), login_text(server.port(), Json{{"password", given}}.dump()));
}

int call_with(const RunningServer& server, const std::string& its_token) {
  const std::string body = R"({"jsonrpc":"2.0","id":1,"method":"status"})";
  return request(server.port(),
                 fmt::format("POST /api HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n"
                             "Authorization: Bearer {}\r\nContent-Type: application/json\r\n"
                             "Content-Length: {}\r\n\r\n{}",
                             server.port(), its_token, body.size(), body))
      .status;
}

TEST(Hashes, of_passwords_are_salted_and_verified) {
  const std::string one = password_hash(password), other = password_hash(password);
  EXPECT_NE(one, other);
  EXPECT_TRUE(is_password_hash(one));
  EXPECT_TRUE(is_password(one, password));
  EXPECT_TRUE(is_password(other, password));
  EXPECT_FALSE(is_password(one, "a good passwore"));
  EXPECT_FALSE(is_password(one, ""));
  for (const std::string& text : {std::string(), std::string("a good password"), one.substr(0, 40),
                                  "$argon2id$" + std::string(200, 'x')})
    EXPECT_FALSE(is_password_hash(text)) << text;
}

/// FIPS 180-4, examples of NIST: the empty message and "abc".
TEST(Hashes, of_styles_are_those_of_sha_256) {
  EXPECT_EQ(policy_hash(""), "sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=");
  EXPECT_EQ(policy_hash("abc"), "sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
}

TEST(Logins, give_a_token_for_the_password) {
  RunningServer server({.password = password});
  const Reply reply = login(server, password);
  ASSERT_EQ(reply.status, 200);
  const std::string session = Json::parse(reply.text.substr(reply.text.find('{')))["token"];
  EXPECT_EQ(call_with(server, session), 200);
  EXPECT_EQ(call_with(server, token), 200) << "the token of the terminal";
  EXPECT_EQ(call_with(server, std::string(32, '0')), 401);
  EXPECT_EQ(call_with(server, ""), 401);
  RawClient client(server.port(), session, "client-secret-session");
  EXPECT_TRUE(client.call("status").contains("result"));
  for (const char* body : {"", "{", "[]", "{}", R"({"password":1})", R"({"password":null})"})
    EXPECT_EQ(request(server.port(), login_text(server.port(), body)).status, 400) << body;
  EXPECT_EQ(request(server.port(), login_text(server.port(), "{}", "text/plain")).status, 415);
  EXPECT_EQ(login(server, std::string(5000, 'x')).status, 413);
  EXPECT_EQ(login(server, std::string(1000, 'x')).status, 401);
}

TEST(Logins, are_limited) {
  RunningServer server({.password = password});
  for (int i = 0; i < 5; ++i) EXPECT_EQ(login(server, "wrong password").status, 401);
  EXPECT_EQ(login(server, "wrong password").status, 429);
  EXPECT_EQ(login(server, password).status, 429) << "also the right one";
  EXPECT_EQ(call_with(server, token), 200);
}

TEST(Logins, need_a_password_of_the_server) {
  RunningServer server;
  EXPECT_EQ(login(server, password).status, 404);
  EXPECT_EQ(login(server, "").status, 404);
}

TEST(LoginLimit, is_for_each_address_and_for_all) {
  LoginLimit limit;
  Clock::time_point now{1h};
  for (std::size_t i = 0; i < LoginLimit::max_of_one; ++i) {
    EXPECT_TRUE(limit.allows("10.0.0.1", now));
    limit.add_failure("10.0.0.1", now);
  }
  EXPECT_FALSE(limit.allows("10.0.0.1", now));
  EXPECT_TRUE(limit.allows("10.0.0.2", now));
  now += LoginLimit::window - 1s;
  EXPECT_FALSE(limit.allows("10.0.0.1", now));
  now += 1s;
  EXPECT_TRUE(limit.allows("10.0.0.1", now));
  for (std::size_t i = 0; i < LoginLimit::max_of_all; ++i)
    limit.add_failure(fmt::format("10.0.1.{}", i), now);
  EXPECT_FALSE(limit.allows("10.0.0.2", now));
}

/// A folder that ends with the test.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("lamplock-login-{}", now_us());
  Folder() { std::filesystem::create_directory(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::string refusal_of(const ServeOptions& options) {
  JobRequests requests;
  PageFrontend frontend(requests, {[](const std::string&) {}, [](const auto&) {}});
  try {
    serve(options, frontend);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    return std::string(error.message());
  }
  return "";
}

TEST(Listen, other_addresses_need_a_password) {
  const Folder folder;
  ServeOptions options;
  options.folder = folder.path.string();
  for (const char* address : {"0.0.0.0", "192.168.1.5", "::", "127.0.0.1.example.org"}) {
    options.address = address;
    EXPECT_THAT(refusal_of(options), HasSubstr("without a password")) << address;
  }
  options.address = loopback_address;
  options.proxy = "https://laser.example.org";
  EXPECT_THAT(refusal_of(options), HasSubstr("without a password"));
  options.proxy = "laser.example.org";
  EXPECT_THAT(refusal_of(options), HasSubstr("not an origin"));
  options.proxy.clear();
  options.password = (folder.path / "pw").string();
  EXPECT_THAT(refusal_of(options), HasSubstr("pw"));
  std::ofstream(options.password) << "a good password\n";
  EXPECT_THAT(refusal_of(options), HasSubstr("is not the hash of a password"));
}

TEST(Listen, a_password_is_stored_as_a_hash_for_its_owner) {
  const Folder folder;
  const std::string file = (folder.path / "pw").string();
  EXPECT_THROW(write_password(file, "short"), Error);
  EXPECT_FALSE(std::filesystem::exists(file));
  write_password(file, password);
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  const std::string text = read_file(file);
  EXPECT_THAT(text, testing::Not(HasSubstr(password)));
  EXPECT_TRUE(is_password(text.substr(0, text.size() - 1), password));
}

TEST(LogFile, keeps_parts_of_limited_size) {
  const Folder folder;
  const auto file = folder.path / "log";
  constexpr std::size_t max_bytes = 1000;
  {
    LogFile log(file, max_bytes);
    for (int i = 0; i < 200; ++i) EXPECT_TRUE(log.add(fmt::format("line {}\x1b\nforged", i)));
  }
  std::size_t parts = 0;
  for (const auto& part : std::filesystem::directory_iterator(folder.path)) {
    EXPECT_LE(part.file_size(), max_bytes);
    ++parts;
  }
  EXPECT_EQ(parts, 4u);
  EXPECT_THAT(read_file(file), HasSubstr("line 199\\x1b forged\n"));
  LogFile again(file, 2 * max_bytes);
  EXPECT_TRUE(again.add("after a restart"));
  EXPECT_THAT(read_file(file), testing::AllOf(HasSubstr("line 199"), HasSubstr("restart")));
}

TEST(LogFile, continues_when_the_disk_is_full) {
  LogFile log("/dev/full");
  EXPECT_FALSE(log.add("lost"));
  EXPECT_FALSE(log.add("lost too"));
  EXPECT_THROW(LogFile("/no/such/folder/log"), Error);
}

}  // namespace
}  // namespace lamplock::serve::test::logins
