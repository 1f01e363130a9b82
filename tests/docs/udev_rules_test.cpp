// The rules of udev name the identifiers that the firmware and the devices have.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/boards/rp2040/usb/descriptors.hpp"
#include "host/file.hpp"

namespace lamplock {
namespace {

using testing::HasSubstr;

std::string rules() { return read_file(LAMPLOCK_ROOT "/toolchain/udev/60-lamplock.rules"); }

TEST(UdevRules, NameTheBoardAsItNamesItself) {
  const std::string vendor = fmt::format("{:04x}", rp2040::usb::vendor_id);
  const std::string product = fmt::format("{:04x}", rp2040::usb::product_id);
  EXPECT_THAT(rules(), HasSubstr(fmt::format(R"(ATTR{{idVendor}}=="{}", ATTR{{idProduct}}=="{}")",
                                             vendor, product)));
  EXPECT_THAT(rules(), HasSubstr(fmt::format(R"(ATTRS{{idVendor}}=="{}", ATTRS{{idProduct}}=="{}")",
                                             vendor, product)));
  // The string descriptor is UTF-16 behind two bytes.
  std::string name;
  const auto& descriptor = rp2040::usb::product_descriptor;
  for (std::size_t i = 2; i < descriptor.size(); i += 2) name += static_cast<char>(descriptor[i]);
  EXPECT_TRUE(name.starts_with("lamplock")) << "the rules say product==\"lamplock*\"";
}

/// Every rule is one line of matches and assignments, each with a known operator.
TEST(UdevRules, AreLinesThatUdevUnderstands) {
  const std::string text = rules();
  std::size_t from = 0, count = 0;
  while (from < text.size()) {
    const std::size_t end = text.find('\n', from);
    ASSERT_NE(end, std::string::npos) << "the last line has an end";
    const std::string line = text.substr(from, end - from);
    from = end + 1;
    if (line.empty() || line.starts_with('#')) continue;
    ++count;
    EXPECT_THAT(line,
                testing::MatchesRegex("([A-Z_]+(\\{[A-Za-z_]+\\})?(==|\\+=|=)\"[^\"]*\"(, )?)+"))
        << line;
  }
  EXPECT_GE(count, 7u);
}

}  // namespace
}  // namespace lamplock
