// Who may talk to the server, by its headers alone.
#include "host/serve/access.hpp"

#include <gtest/gtest.h>

#include "host/serve/job_folder.hpp"

namespace lamplock::serve {
namespace {

TEST(Access, loopback_is_judged_by_the_bytes_of_an_address) {
  for (const char* own : {"127.0.0.1", "127.0.0.0", "127.255.255.255", "::1"})
    EXPECT_TRUE(is_loopback(own)) << own;
  for (const char* other :
       {"", "127", "127.", "127.0.0", "127.0.0.1.", "127.0.0.1.example.org", "127.0.0.256",
        "127.0.0.01", "127.0..1", "127.0.0.1 ", "1270.0.0.1", "128.0.0.1", "0.0.0.0", "::2",
        "::", "10.0.0.1", "localhost", "127.0.0.1\n", "127.0x0.0.1"})
    EXPECT_FALSE(is_loopback(other)) << other;
}

TEST(Access, a_host_is_this_computer_and_the_port) {
  for (const char* own : {"127.0.0.1:7125", "localhost:7125", "[::1]:7125", "127.1.2.3:7125"})
    EXPECT_TRUE(is_own_host(own, 7125)) << own;
  for (const char* other :
       {"", ":7125", "127.0.0.1", "127.0.0.1:7126", "127.0.0.1:17125", "example.org:7125",
        "localhost.example.org:7125", "127.0.0.1.example.org:7125", "user@127.0.0.1:7125",
        "[127.0.0.1]:7125", "[::1:7125", "::1:7125", "[]:7125", "127.0.0.1:7125:7125", "LOCALHOST"})
    EXPECT_FALSE(is_own_host(other, 7125)) << other;
}

TEST(Access, an_origin_is_a_page_of_this_server) {
  const ServerNames names{7125};
  EXPECT_TRUE(names.is_origin("http://127.0.0.1:7125", "127.0.0.1"));
  EXPECT_TRUE(names.is_origin("http://localhost:7125", "127.0.0.1"));
  for (const char* other : {"", "null", "http://127.0.0.1", "https://127.0.0.1:7125",
                            "http://127.0.0.1:7125/", "http://127.0.0.1:8000", "file://",
                            "http://example.org:7125", "http://127.0.0.1:7125.example.org"})
    EXPECT_FALSE(names.is_origin(other, "127.0.0.1")) << other;
}

TEST(Access, another_computer_names_the_address_at_which_it_arrives) {
  const ServerNames names{7125};
  EXPECT_TRUE(names.is_host("192.168.1.5:7125", "192.168.1.5"));
  EXPECT_TRUE(names.is_host("[fe80::1]:7125", "fe80::1"));
  EXPECT_TRUE(names.is_origin("http://192.168.1.5:7125", "192.168.1.5"));
  for (const char* other : {"192.168.1.6:7125", "192.168.1.5", "192.168.1.5:80", "laser:7125",
                            "192.168.1.5.example.org:7125", ""})
    EXPECT_FALSE(names.is_host(other, "192.168.1.5")) << other;
  EXPECT_FALSE(names.is_host(":7125", ""));
}

TEST(Access, a_proxy_has_one_origin) {
  const ServerNames names{7125, parse_origin("https://laser.example.org")};
  EXPECT_TRUE(names.is_host("laser.example.org", "127.0.0.1"));
  EXPECT_TRUE(names.is_origin("https://laser.example.org", "127.0.0.1"));
  EXPECT_FALSE(names.is_origin("http://laser.example.org", "127.0.0.1"));
  EXPECT_FALSE(names.is_host("example.org", "127.0.0.1"));
  EXPECT_TRUE(parse_origin("http://10.0.0.1:8080"));
  for (const char* other : {"", "laser.example.org", "https://", "ftp://a", "https://a/b",
                            "https://user@a", "https://A", "https://a b"})
    EXPECT_FALSE(parse_origin(other)) << other;
}

TEST(Access, secrets_are_random_and_compared_whole) {
  EXPECT_EQ(random_token().size(), 32u);
  EXPECT_NE(random_token(), random_token());
  EXPECT_EQ(random_code().size(), 6u);
  EXPECT_TRUE(is_same_secret("abc", "abc"));
  EXPECT_FALSE(is_same_secret("abc", "abd"));
  EXPECT_FALSE(is_same_secret("abc", "ab"));
  EXPECT_FALSE(is_same_secret("", "a"));
}

TEST(JobFolder, names_cannot_leave_the_folder) {
  for (const char* name : {"part.ngc", "My part (2).llj", "a+b_c-1.nc"})
    EXPECT_TRUE(JobFolder::is_name(name)) << name;
  for (const char* name : {"", ".", "..", "../part.ngc", "a/b.ngc", "a\\b.ngc", ".hidden.ngc",
                           "%2e%2e%2fpart.ngc", "a\n.ngc", "C:part.ngc", "part.ngc?x"})
    EXPECT_FALSE(JobFolder::is_name(name)) << name;
  EXPECT_FALSE(JobFolder::is_name(std::string(101, 'a')));
  EXPECT_FALSE(JobFolder::is_name(std::string("a\0b", 3)));
}

}  // namespace
}  // namespace lamplock::serve
