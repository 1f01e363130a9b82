#include "sim/chip/usb_host/descriptors.hpp"

#include <array>
#include <map>
#include <optional>
#include <set>

#include "sim/chip/usb_host/words.hpp"

namespace lamplock::sim::chip::usb {

namespace {

using Bytes = std::span<const std::uint8_t>;

bool is_packet_size(unsigned size) { return size == 8 || size == 16 || size == 32 || size == 64; }

/// Endpoint types in bmAttributes (USB 2.0, table 9-13).
enum EndpointType : unsigned { control = 0, isochronous = 1, bulk = 2, interrupt = 3 };

/// Walks through a configuration.
class ConfigurationReader {
 public:
  ConfigurationReader(Bytes bytes, const DeviceInfo& device, Violations& violations)
      : bytes_(bytes), device_(device), violations_(violations) {}

  Configuration read();

 private:
  struct Interface {
    std::uint8_t number = 0, code = 0, subclass = 0, protocol = 0;
    unsigned endpoints = 0, endpoints_seen = 0;
  };

  void report(const std::string& text) { violations_.push_back("configuration: " + text); }
  void expect(bool good, const std::string& text) {
    if (!good) report(text);
  }
  void head();
  void one(Bytes d);
  void interface(Bytes d);
  void endpoint(Bytes d);
  void association(Bytes d);
  void functional(Bytes d);
  void close_interface();
  void finish();
  bool is_vendor() const { return current_ && current_->code == 0xff; }
  bool is_control() const { return current_ && current_->code == 2 && current_->subclass == 2; }

  Bytes bytes_;
  const DeviceInfo& device_;
  Violations& violations_;
  Configuration configuration_;
  SerialPort& port_ = configuration_.port;
  VendorPipe& vendor_ = configuration_.vendor;
  std::optional<Interface> current_;
  std::map<unsigned, Interface> interfaces_;
  std::set<unsigned> addresses_;
  bool association_ = false, header_ = false, acm_ = false;
  std::optional<std::array<unsigned, 2>> union_;
  std::optional<unsigned> call_data_;
};

Configuration ConfigurationReader::read() {
  if (bytes_.size() < 9) {
    report("shorter than 9 bytes");
    return {};
  }
  head();
  std::size_t at = bytes_[0];
  while (at < bytes_.size()) {
    const std::size_t length = bytes_[at];
    if (length < 2 || at + length > bytes_.size()) {
      report("descriptor at " + std::to_string(at) + " has length " + std::to_string(length));
      break;
    }
    one(bytes_.subspan(at, length));
    at += length;
  }
  finish();
  return configuration_;
}

void ConfigurationReader::head() {
  expect(bytes_[0] == 9, "bLength is not 9");
  expect(bytes_[1] == descriptor::configuration, "bDescriptorType is not 2");
  expect(word(bytes_, 2) == bytes_.size(), "wTotalLength is " + std::to_string(word(bytes_, 2)) +
                                               ", " + std::to_string(bytes_.size()) +
                                               " bytes came");
  expect(bytes_[5] != 0, "bConfigurationValue is 0");
  expect((bytes_[7] & 0x9f) == 0x80, "bmAttributes has reserved bits wrong");
  expect(bytes_[8] <= 250, "bMaxPower is above 500 mA");
  configuration_.value = bytes_[5];
  configuration_.remote_wakeup = (bytes_[7] & 0x20) != 0;
  if (bytes_[6] != 0) configuration_.strings.push_back(bytes_[6]);
}

void ConfigurationReader::one(Bytes d) {
  switch (d[1]) {
    case descriptor::interface:
      interface(d);
      break;
    case descriptor::endpoint:
      endpoint(d);
      break;
    case descriptor::association:
      association(d);
      break;
    case descriptor::class_interface:
      functional(d);
      break;
    default:
      report("descriptor of type " + std::to_string(d[1]) + " does not belong here");
  }
}

void ConfigurationReader::association(Bytes d) {
  if (d.size() != 8) return report("interface association is not 8 bytes long");
  close_interface();
  association_ = true;
  expect(d[3] == 2 && d[4] == 2 && d[5] == 2, "interface association is not of a CDC ACM pair");
  expect(
      device_.device_class == 0xef && device_.device_subclass == 2 && device_.device_protocol == 1,
      "interface association without class EF/02/01 of the device");
  if (d[7] != 0) configuration_.strings.push_back(d[7]);
}

void ConfigurationReader::interface(Bytes d) {
  if (d.size() != 9) return report("interface is not 9 bytes long");
  close_interface();
  current_ = Interface{d[2], d[5], d[6], d[7], d[4], 0};
  if (d[3] == 0) expect(!interfaces_.contains(d[2]), "interface number twice");
  if (d[8] != 0) configuration_.strings.push_back(d[8]);
  if (is_control()) {
    port_.control_interface = d[2];
    expect(d[7] <= 6 || d[7] == 0xff, "ACM interface has an unknown protocol");
  }
  if (d[5] == 0x0a) {
    port_.data_interface = d[2];
    expect(d[6] == 0 && d[7] == 0, "data interface has subclass or protocol");
  }
  if (is_vendor()) {
    vendor_.interface = d[2];
    vendor_.string = d[8];
  }
}

void ConfigurationReader::close_interface() {
  if (!current_) return;
  expect(current_->endpoints == current_->endpoints_seen,
         "interface " + std::to_string(current_->number) + " announces " +
             std::to_string(current_->endpoints) + " endpoints and has " +
             std::to_string(current_->endpoints_seen));
  interfaces_[current_->number] = *current_;
  current_.reset();
}

void ConfigurationReader::endpoint(Bytes d) {
  if (d.size() != 7) return report("endpoint is not 7 bytes long");
  if (!current_) return report("endpoint outside an interface");
  ++current_->endpoints_seen;
  const std::string name = "endpoint " + std::to_string(d[2]);
  const unsigned number = d[2] & 0x0fu;
  const bool in = (d[2] & 0x80) != 0;
  expect(number != 0 && (d[2] & 0x70) == 0, name + ": bad address");
  expect(addresses_.insert(d[2]).second, name + ": address twice");
  const unsigned type = d[3] & 3u;
  const unsigned size = word(d, 4);
  expect((d[3] & 0xfc) == 0, name + ": bmAttributes has reserved bits set");
  if (type == bulk) expect(is_packet_size(size), name + ": bulk packet size is not 8, 16, 32, 64");
  if (type == interrupt) {
    expect(size >= 1 && size <= 64, name + ": interrupt packet size is not 1 to 64");
    expect(d[6] >= 1, name + ": interrupt interval is 0");
  }
  if (type == isochronous || type == control) report(name + ": a serial port has no such type");
  if ((current_->code == 0x0a || is_vendor()) && type == bulk) {
    BulkEndpoints& ends = is_vendor() ? static_cast<BulkEndpoints&>(vendor_) : port_;
    (in ? ends.in : ends.out) = static_cast<std::uint8_t>(number);
    (in ? ends.in_size : ends.out_size) = static_cast<std::uint16_t>(size);
  } else if (is_control() && type == interrupt && in) {
    port_.notify = static_cast<std::uint8_t>(number);
    port_.notify_size = static_cast<std::uint16_t>(size);
    port_.notify_interval_ms = d[6];
  }
}

/// CDC functional descriptors (CDC 1.2, 5.2.3; PSTN 1.2, 5.3).
void ConfigurationReader::functional(Bytes d) {
  if (!current_ || current_->code != 2)
    return report("functional descriptor outside a CDC interface");
  if (d.size() < 3) return report("functional descriptor without subtype");
  switch (d[2]) {
    case 0:
      header_ = true;
      expect(d.size() == 5 && word(d, 3) >= 0x0110, "header functional descriptor is wrong");
      break;
    case 1:
      expect(d.size() == 5, "call management descriptor is not 5 bytes long");
      if (d.size() == 5) call_data_ = d[4];
      break;
    case 2:
      acm_ = true;
      expect(d.size() == 4, "ACM descriptor is not 4 bytes long");
      if (d.size() == 4)
        expect((d[3] & 2) != 0, "ACM descriptor does not announce SET_LINE_CODING");
      break;
    case 6:
      expect(d.size() == 5, "union descriptor is not 5 bytes long");
      if (d.size() == 5) union_ = {d[3], d[4]};
      break;
    default:
      break;
  }
}

void ConfigurationReader::finish() {
  close_interface();
  expect(bytes_[4] == interfaces_.size(), "bNumInterfaces is " + std::to_string(bytes_[4]) + ", " +
                                              std::to_string(interfaces_.size()) + " are there");
  for (unsigned i = 0; i < interfaces_.size(); ++i)
    expect(interfaces_.contains(i), "interface numbers are not 0, 1, ...");
  expect(header_ && acm_ && union_.has_value(),
         "header, ACM or union functional descriptor is missing");
  if (union_)
    expect((*union_)[0] == port_.control_interface && (*union_)[1] == port_.data_interface,
           "union descriptor names other interfaces");
  if (call_data_)
    expect(*call_data_ == port_.data_interface, "call management names another data interface");
  expect(port_.found(), "no data interface with bulk IN and bulk OUT");
  expect(port_.notify != 0, "no interrupt IN endpoint for notifications");
  expect(association_ || device_.device_class == 2,
         "neither an interface association nor class 02 of the device");
}

}  // namespace

DeviceInfo parse_device(Bytes bytes, Violations& violations) {
  const auto expect = [&](bool good, const char* text) {
    if (!good) violations.push_back(std::string("device: ") + text);
  };
  DeviceInfo info;
  expect(bytes.size() == 18, "descriptor is not 18 bytes long");
  if (bytes.size() < 18) return info;
  expect(bytes[0] == 18, "bLength is not 18");
  expect(bytes[1] == descriptor::device, "bDescriptorType is not 1");
  info.version = word(bytes, 2);
  expect(info.version == 0x0110 || info.version == 0x0200 || info.version == 0x0201,
         "bcdUSB is not a known version");
  info.device_class = bytes[4];
  info.device_subclass = bytes[5];
  info.device_protocol = bytes[6];
  const bool by_interface = bytes[4] == 0 && bytes[5] == 0 && bytes[6] == 0;
  const bool cdc = bytes[4] == 2 && bytes[6] == 0;
  const bool associated = bytes[4] == 0xef && bytes[5] == 2 && bytes[6] == 1;
  expect(by_interface || cdc || associated, "class is not 00, CDC (02) or EF/02/01");
  info.max_packet0 = bytes[7];
  expect(is_packet_size(bytes[7]), "bMaxPacketSize0 is not 8, 16, 32 or 64");
  info.vendor = word(bytes, 8);
  info.product = word(bytes, 10);
  info.manufacturer_string = bytes[14];
  info.product_string = bytes[15];
  info.serial_string = bytes[16];
  info.configurations = bytes[17];
  expect(info.configurations >= 1, "bNumConfigurations is 0");
  return info;
}

Configuration parse_configuration(Bytes bytes, const DeviceInfo& device, Violations& violations) {
  return ConfigurationReader(bytes, device, violations).read();
}

std::string parse_string(Bytes bytes, int index, Violations& violations) {
  const std::string name = "string " + std::to_string(index) + ": ";
  if (bytes.size() < 2 || bytes[0] != bytes.size() || bytes[1] != descriptor::string ||
      bytes.size() % 2 != 0) {
    violations.push_back(name + "length or type is wrong");
    return {};
  }
  if (bytes.size() == 2) violations.push_back(name + "is empty");
  std::string text;
  for (std::size_t at = 2; at < bytes.size(); at += 2)
    text += word(bytes, at) < 128 ? static_cast<char>(bytes[at]) : '?';
  return text;
}

}  // namespace lamplock::sim::chip::usb
