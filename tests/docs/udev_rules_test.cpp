// The udev rules and docs/install.md name the same USB identifiers as the firmware and the devices.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "firmware/boards/rp2040/usb/descriptors.hpp"
#include "host/file.hpp"
#include "host/pendant/pendant_ids.hpp"
#include "host/usb/known_devices.hpp"
#include "shared/boards/usb_ids.hpp"
#include "tests/paths.hpp"

namespace lamplock {
namespace {

using testing::HasSubstr;

std::string rules() { return read_file(test::in_repository("toolchain/udev/60-lamplock.rules")); }
std::string serial_rules() {
  return read_file(test::in_repository("toolchain/udev/60-lamplock-serial.rules"));
}

TEST(UdevRules, NameTheBoardByItsProductName) {
  const std::string vendor = fmt::format("{:04x}", boards::usb_vendor_id);
  const std::string product = fmt::format("{:04x}", boards::usb_product_id);
  EXPECT_THAT(rules(), HasSubstr(fmt::format(R"(ATTR{{idVendor}}=="{}", ATTR{{idProduct}}=="{}")",
                                             vendor, product)));
  EXPECT_THAT(rules(), HasSubstr(fmt::format(R"(ATTRS{{idVendor}}=="{}", ATTRS{{idProduct}}=="{}")",
                                             vendor, product)));
  // The string descriptor is UTF-16 after a header of two bytes.
  std::string name;
  const auto& descriptor = rp2040::usb::product_descriptor;
  for (std::size_t i = 2; i < descriptor.size(); i += 2) name += static_cast<char>(descriptor[i]);
  EXPECT_TRUE(name.starts_with("lamplock")) << "the rules match product==\"lamplock*\"";
}

/// "10ce:eb70"
std::string identifier(std::uint16_t vendor, std::uint16_t product) {
  return fmt::format("{:04x}:{:04x}", vendor, product);
}

std::set<std::string> pendants() {
  std::set<std::string> all;
  for (const pendant::PendantId& id : pendant::pendant_ids)
    all.insert(identifier(id.vendor, id.product));
  return all;
}

/// The boot loader of an RP2040 (datasheet, 2.8.5.1), as defined in the program.
std::string loader() {
  constexpr std::uint16_t vendor = 0x2e8a, product = 0x0003;
  usb::DeviceInfo device;
  device.vendor = vendor;
  device.product = product;
  EXPECT_EQ(usb::known_device(device).kind, usb::Kind::boot_loader);
  return identifier(vendor, product);
}

/// The lines of the rules without comments.
std::vector<std::string> rule_lines() {
  std::vector<std::string> all;
  std::istringstream text(rules());
  for (std::string line; std::getline(text, line);)
    if (!line.empty() && !line.starts_with('#')) all.push_back(line);
  return all;
}

/// Identifiers of a subsystem to whose nodes the rules grant access.
std::set<std::string> given(const std::string& subsystem) {
  static const std::regex numbers(
      R"re(\{idVendor\}=="([0-9a-f]{4})", ATTRS?\{idProduct\}=="([0-9a-f|]+)")re");
  std::set<std::string> all;
  for (const std::string& line : rule_lines()) {
    std::smatch found;
    if (!line.starts_with("SUBSYSTEM==\"" + subsystem + "\"") ||
        line.find("TAG+=\"uaccess\"") == std::string::npos ||
        !std::regex_search(line, found, numbers))
      continue;
    std::istringstream products(found[2]);
    for (std::string product; std::getline(products, product, '|');)
      all.insert(found[1].str() + ":" + product);
  }
  return all;
}

TEST(UdevRules, NameTheBoardTheLoaderAndEveryPendantAndNothingElse) {
  const std::string board = identifier(boards::usb_vendor_id, boards::usb_product_id);
  EXPECT_EQ(given("usb"), (std::set<std::string>{board, loader()}));
  EXPECT_EQ(given("tty"), (std::set<std::string>{board}));
  EXPECT_EQ(given("hidraw"), pendants());
}

TEST(UdevRules, GrantNoAccessToGpioLines) {
  for (const std::string& line : rule_lines()) {
    EXPECT_EQ(line.find("gpio"), std::string::npos) << line;
  }
}

TEST(UdevRules, TheTableOfTheDocumentHasTheSameIdentifiers) {
  std::set<std::string> expected = pendants();
  expected.insert(identifier(boards::usb_vendor_id, boards::usb_product_id));
  expected.insert(loader());
  static const std::regex number("[0-9a-f]{4}:[0-9a-f]{4}");
  std::set<std::string> listed;
  std::istringstream page(read_file(test::in_repository("docs/install.md")));
  for (std::string line; std::getline(page, line);)
    if (line.starts_with('|')) {
      listed.insert(std::sregex_token_iterator(line.begin(), line.end(), number), {});
    }
  EXPECT_EQ(listed, expected);
}

/// Chips of other boards: those of the rules and of the paragraph in the document.
TEST(UdevRules, TheSerialChipsOfOtherBoardsAreThoseOfTheDocument) {
  static const std::regex chip(
      R"re(\{idVendor\}=="([0-9a-f]{4})", ATTRS\{idProduct\}=="([0-9a-f|]+)"(.*))re");
  std::set<std::string> ruled;
  std::istringstream text(serial_rules());
  for (std::string line; std::getline(text, line);) {
    std::smatch found;
    if (line.starts_with('#') || !std::regex_search(line, found, chip)) continue;
    EXPECT_THAT(found[3].str(), HasSubstr(R"(TAG+="uaccess")"));
    EXPECT_THAT(found[3].str(), HasSubstr(R"(ENV{ID_MM_PORT_IGNORE}="1")"));
    std::istringstream products(found[2]);
    for (std::string product; std::getline(products, product, '|');)
      EXPECT_TRUE(ruled.insert(found[1].str() + ":" + product).second) << product;
  }
  static const std::regex number("(1a86|10c4|0403):[0-9a-f]{4}");
  const std::string page = read_file(test::in_repository("docs/install.md"));
  const std::set<std::string> listed(std::sregex_token_iterator(page.begin(), page.end(), number),
                                     {});
  EXPECT_EQ(ruled, listed);
  for (const char* usual : {"1a86:7523", "10c4:ea60", "0403:6001"})
    EXPECT_EQ(ruled.count(usual), 1u) << usual;
}

/// Every rule is one line of matches and assignments, each with a known operator.
TEST(UdevRules, AreLinesThatUdevUnderstands) {
  const std::string text = rules() + serial_rules();
  std::size_t from = 0, count = 0;
  while (from < text.size()) {
    const std::size_t end = text.find('\n', from);
    ASSERT_NE(end, std::string::npos) << "no newline at the end of the file";
    const std::string line = text.substr(from, end - from);
    from = end + 1;
    if (line.empty() || line.starts_with('#')) continue;
    ++count;
    EXPECT_THAT(line,
                testing::MatchesRegex("([A-Z_]+(\\{[A-Za-z_]+\\})?(==|!=|\\+=|=)\"[^\"]*\"(, )?)+"))
        << line;
  }
  EXPECT_GE(count, 6u);
}

}  // namespace
}  // namespace lamplock
