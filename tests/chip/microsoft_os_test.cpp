// A device's Microsoft OS descriptors, as the simulated PC reads them: a valid set, and every
// defect.
#include "sim/chip/usb_host/microsoft_os.hpp"

#include <gmock/gmock.h>

#include <random>
#include <string_view>

#include "tests/scale.hpp"

namespace lamplock::sim::chip::usb::microsoft_os_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The specification's examples of a BOS descriptor and a composite device.
Bytes bos() {
  return {5,    15,   33,   0,    1,    28,   16,   5,    0,    0xDF, 0x60,
          0xDD, 0xD8, 0x89, 0x45, 0xC7, 0x4C, 0x9C, 0xD2, 0x65, 0x9D, 0x9E,
          0x64, 0x8A, 0x9F, 0x00, 0x00, 0x03, 0x06, 178,  0,    0x20, 0};
}

Bytes set() {
  Bytes bytes = {10, 0, 0, 0, 0, 0, 3,   6, 178, 0, 8,   0, 1,   0,   0,   0,   168, 0,
                 8,  0, 2, 0, 2, 0, 160, 0, 20,  0, 3,   0, 'W', 'I', 'N', 'U', 'S', 'B',
                 0,  0, 0, 0, 0, 0, 0,   0, 0,   0, 132, 0, 4,   0,   7,   0,   42,  0};
  const auto wide = [&bytes](std::string_view text, std::size_t zeros) {
    for (const char c : text) bytes.insert(bytes.end(), {static_cast<std::uint8_t>(c), 0});
    bytes.insert(bytes.end(), 2 * zeros, 0);
  };
  wide("DeviceInterfaceGUIDs", 1);
  bytes.insert(bytes.end(), {80, 0});
  wide("{12345678-9abc-def0-1234-56789ABCDEF0}", 2);
  return bytes;
}

constexpr MicrosoftCapability capability{0x20, 178};

TEST(MicrosoftOs, AValidSetIsUnderstood) {
  Violations violations;
  EXPECT_EQ(parse_bos_head(Bytes{5, 15, 33, 0, 1}, violations), 33);
  const auto found = parse_bos(bos(), violations);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->request, 0x20);
  EXPECT_EQ(found->set_size, 178);
  const MicrosoftSet read = parse_microsoft_set(set(), *found, violations);
  EXPECT_EQ(read.interface, 2);
  EXPECT_EQ(read.compatible_id, "WINUSB");
  EXPECT_THAT(read.guids, testing::ElementsAre("{12345678-9abc-def0-1234-56789ABCDEF0}"));
  EXPECT_THAT(violations, testing::IsEmpty());
}

TEST(MicrosoftOs, ABosDescriptorMayHaveOtherCapabilities) {
  // The USB 2.0 extension (USB 3.2, table 9-13) comes first.
  Bytes bytes = bos();
  const Bytes extension = {7, 16, 2, 0, 0, 0, 0};
  bytes.insert(bytes.begin() + 5, extension.begin(), extension.end());
  bytes[2] = 40;
  bytes[4] = 2;
  Violations violations;
  EXPECT_TRUE(parse_bos(bytes, violations).has_value());
  EXPECT_FALSE(parse_bos(Bytes{5, 15, 12, 0, 1, 7, 16, 2, 0, 0, 0, 0}, violations).has_value());
  EXPECT_THAT(violations, testing::IsEmpty());
}

TEST(MicrosoftOs, DefectsAreNamed) {
  struct Defect {
    const char* what;
    std::size_t at;
    std::uint8_t value;
  };
  const auto expect_named = [](const Violations& violations, const Defect& defect) {
    EXPECT_THAT(violations, testing::Contains(testing::HasSubstr(defect.what)));
  };
  for (const Defect& defect :
       {Defect{"wTotalLength is wrong", 2, 34}, Defect{"bNumDeviceCaps is wrong", 4, 2},
        Defect{"wrong length", 5, 29}, Defect{"not a capability", 6, 5},
        Defect{"platform capability is wrong", 8, 1}, Defect{"Windows is not 8.1", 28, 0x0a}}) {
    Violations violations;
    Bytes bytes = bos();
    bytes.at(defect.at) = defect.value;
    parse_bos(bytes, violations);
    expect_named(violations, defect);
  }
  for (const Defect& defect :
       {Defect{"does not begin with a set header", 0, 8}, Defect{"wTotalLength is 177", 8, 177},
        Defect{"not counted from 0", 14, 1}, Defect{"configuration subset does not", 16, 160},
        Defect{"function subset does not", 24, 168}, Defect{"has no function subset", 20, 1},
        Defect{"compatible ID is not 20", 26, 21}, Defect{"part at 26 has length 2", 26, 2},
        Defect{"part of type 9", 28, 9}, Defect{"not a list of strings", 50, 1},
        Defect{"name of a property does not fit", 52, 200}, Defect{"property is unknown", 54, 'd'},
        Defect{"data is wrong", 96, 78}, Defect{"GUID is not like", 98, '('},
        Defect{"does not end with two zeros", 174, 'x'}}) {
    Violations violations;
    Bytes bytes = set();
    bytes.at(defect.at) = defect.value;
    parse_microsoft_set(bytes, capability, violations);
    expect_named(violations, defect);
  }
  Violations violations;
  parse_bos_head(Bytes{5, 15, 4, 0, 1}, violations);
  EXPECT_THAT(violations, testing::Contains(testing::HasSubstr("no header")));
}

TEST(MicrosoftOs, RandomBytesAreParsedSafely) {
  std::mt19937_64 random(18);
  for (int i = 0; i < test::scaled(20000); ++i) {
    Bytes bytes = i % 2 == 0 ? bos() : set();
    for (std::uint64_t changes = random() % 4; changes > 0; --changes)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bytes.resize(random() % 4 == 0 ? random() % (bytes.size() + 4) : bytes.size());
    Violations violations;
    parse_bos_head(bytes, violations);
    parse_bos(bytes, violations);
    parse_microsoft_set(bytes, capability, violations);
  }
}

}  // namespace
}  // namespace lamplock::sim::chip::usb::microsoft_os_test
