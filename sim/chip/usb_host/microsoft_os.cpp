#include "sim/chip/usb_host/microsoft_os.hpp"

#include <algorithm>
#include <array>

#include "sim/chip/usb_host/words.hpp"

namespace lamplock::sim::chip::usb {

namespace {

using Bytes = std::span<const std::uint8_t>;

/// D8DD60DF-4589-4CC7-9CD2-659D9E648A9F in the order of memory (specification, table 4).
constexpr std::array<std::uint8_t, 16> platform_uuid = {
    0xdf, 0x60, 0xdd, 0xd8, 0x89, 0x45, 0xc7, 0x4c, 0x9c, 0xd2, 0x65, 0x9d, 0x9e, 0x64, 0x8a, 0x9f};
constexpr std::size_t platform_head = 20;  ///< of a platform capability (USB 3.2, table 9-20)
constexpr std::size_t microsoft_capability_size = platform_head + 8;

/// wDescriptorType (specification, table 9).
enum SetPart : std::uint16_t {
  set_header = 0,
  configuration_subset = 1,
  function_subset = 2,
  compatible_id = 3,
  registry_property = 4
};

/// UTF-16 without its zeros; characters other than ASCII become '?'.
std::string narrow(Bytes bytes) {
  std::string text;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2)
    text += word(bytes, at) < 128 ? static_cast<char>(bytes[at]) : '?';
  return text;
}

/// {8-4-4-4-12} hexadecimal digits.
bool is_guid(const std::string& text) {
  constexpr std::string_view shape = "{xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx}";
  constexpr std::string_view digits = "0123456789abcdefABCDEF";
  return text.size() == shape.size() &&
         std::equal(text.begin(), text.end(), shape.begin(), [&](char c, char s) {
           return s == 'x' ? digits.find(c) != std::string_view::npos : c == s;
         });
}

/// Walks through a set.
class SetReader {
 public:
  explicit SetReader(Violations& violations) : violations_(violations) {}

  MicrosoftSet read(Bytes bytes, const MicrosoftCapability& capability) {
    expect(bytes.size() == capability.set_size, "length is not what the BOS descriptor says");
    if (bytes.size() < 10 || word(bytes, 0) != 10 || word(bytes, 2) != set_header) {
      report("does not begin with a set header of 10 bytes");
      return {};
    }
    expect(word(bytes, 8) == bytes.size(), "wTotalLength is " + std::to_string(word(bytes, 8)));
    parts(bytes);
    expect(in_function_, "has no function subset");
    return set_;
  }

 private:
  void report(const std::string& text) { violations_.push_back("Microsoft set: " + text); }
  void expect(bool good, const std::string& text) {
    if (!good) report(text);
  }

  void parts(Bytes bytes) {
    for (std::size_t at = 10; at < bytes.size();) {
      const std::size_t left = bytes.size() - at;
      const std::size_t size = left < 4 ? 0 : word(bytes, at);
      if (size < 4 || size > left)
        return report("part at " + std::to_string(at) + " has length " + std::to_string(size));
      one(bytes.subspan(at, size), left);
      at += size;
    }
  }
  void one(Bytes d, std::size_t left) {
    switch (word(d, 2)) {
      case configuration_subset:
        if (d.size() != 8) return report("configuration subset header is not 8 bytes long");
        expect(d[4] == 0, "configuration is not counted from 0");
        expect(word(d, 6) == left, "configuration subset does not reach to the end");
        break;
      case function_subset:
        if (d.size() != 8) return report("function subset header is not 8 bytes long");
        in_function_ = true;
        set_.interface = d[4];
        expect(word(d, 6) == left, "function subset does not reach to the end");
        break;
      case compatible_id:
        if (d.size() != 20) return report("compatible ID is not 20 bytes long");
        set_.compatible_id.assign(d.begin() + 4, std::find(d.begin() + 4, d.begin() + 12, 0));
        break;
      case registry_property:
        property(d);
        break;
      default:
        report("part of type " + std::to_string(word(d, 2)));
    }
  }
  /// Only DeviceInterfaceGUIDs is known.
  void property(Bytes d) {
    const std::size_t name_size = d.size() < 10 ? 0 : word(d, 6);
    if (d.size() < 10 + name_size) return report("name of a property does not fit");
    const Bytes name = d.subspan(8, name_size), data = d.subspan(10 + name_size);
    if (word(d, 8 + name_size) != data.size())
      return report("length of a property's data is wrong");
    expect(word(d, 4) == 7, "property is not a list of strings");
    expect(narrow(name) == std::string("DeviceInterfaceGUIDs") + '\0', "property is unknown");
    std::string text = narrow(data);
    if (!text.ends_with(std::string(2, '\0')))
      return report("list of GUIDs does not end with two zeros");
    text.pop_back();
    for (std::size_t at = 0; at < text.size();) {
      const std::string guid = text.substr(at, text.find('\0', at) - at);
      expect(is_guid(guid), "GUID is not like {8-4-4-4-12}");
      set_.guids.push_back(guid);
      at += guid.size() + 1;
    }
  }

  Violations& violations_;
  MicrosoftSet set_;
  bool in_function_ = false;
};

}  // namespace

std::uint16_t parse_bos_head(Bytes bytes, Violations& violations) {
  if (bytes.size() == 5 && bytes[0] == 5 && bytes[1] == descriptor::bos && word(bytes, 2) >= 5)
    return word(bytes, 2);
  violations.push_back("BOS: no header of 5 bytes");
  return 0;
}

std::optional<MicrosoftCapability> parse_bos(Bytes bytes, Violations& violations) {
  const auto report = [&](const char* text) { violations.push_back(std::string("BOS: ") + text); };
  if (bytes.size() < 5 || word(bytes, 2) != bytes.size()) report("wTotalLength is wrong");
  std::optional<MicrosoftCapability> found;
  unsigned capabilities = 0;
  for (std::size_t at = 5; at < bytes.size();) {
    const std::size_t size = bytes[at];
    if (size < 3 || size > bytes.size() - at) {
      report("capability has a wrong length");
      return found;
    }
    const Bytes d = bytes.subspan(at, size);
    ++capabilities;
    at += size;
    if (d[1] != descriptor::device_capability) report("a descriptor that is not a capability");
    if (d[2] != 5) continue;  // platform
    if (d.size() < platform_head || d[3] != 0) {
      report("platform capability is wrong");
    } else if (std::equal(platform_uuid.begin(), platform_uuid.end(), d.begin() + 4)) {
      if (d.size() != microsoft_capability_size) {
        report("capability of Microsoft is not 28 bytes long");
        continue;
      }
      if (word(d, 22) != 0x0603) report("Windows is not 8.1");
      found = MicrosoftCapability{d[26], word(d, 24)};
    }
  }
  if (bytes.size() >= 5 && bytes[4] != capabilities) report("bNumDeviceCaps is wrong");
  return found;
}

MicrosoftSet parse_microsoft_set(Bytes bytes, const MicrosoftCapability& capability,
                                 Violations& violations) {
  return SetReader(violations).read(bytes, capability);
}

}  // namespace lamplock::sim::chip::usb
