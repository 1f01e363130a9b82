// Errors for serial ports that cannot be opened, and their remedies.
#include "host/link/serial_transport.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host/error.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::link {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The error of opening `port` as a user without root's rights.
std::string said_to_nobody(const std::filesystem::path& port) {
  constexpr uid_t unprivileged = 65534;
  const bool root = ::geteuid() == 0;
  if (root) {
    EXPECT_EQ(::setresuid(unprivileged, unprivileged, 0), 0);
  }
  std::string text;
  try {
    const SerialTransport transport(port.string());
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::no_device);
    text = error.what();
  }
  if (root) {
    EXPECT_EQ(::setresuid(0, 0, 0), 0);
  }
  return text;
}

TEST(SerialTransport, without_permission_it_names_the_rule_or_the_group) {
  const test::TemporaryFolder folder;
  const auto port = folder.write("ttyACM0", "");
  ASSERT_EQ(::chmod(port.c_str(), 0), 0);
  EXPECT_THAT(said_to_nobody(port),
              AllOf(HasSubstr("cannot open the port"), HasSubstr("install 60-lamplock.rules")));
  if (::geteuid() != 0) return;
  constexpr gid_t dialout = 20;  // of Debian
  ASSERT_EQ(::chown(port.c_str(), 0, dialout), 0);
  ASSERT_EQ(::chmod(port.c_str(), 0660), 0);
  EXPECT_THAT(said_to_nobody(port), HasSubstr("sudo adduser $USER dialout"));
}

TEST(SerialTransport, a_missing_port_is_not_reported_as_a_permission_problem) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(said_to_nobody(folder.file("ttyACM0")),
              AllOf(HasSubstr("there is no such port"), Not(HasSubstr("rules"))));
}

}  // namespace
}  // namespace lamplock::link
