#include "host/usb/sysfs.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

namespace lamplock::usb {
namespace {

namespace fs = std::filesystem;

/// Entries of a folder; none if it does not exist.
std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code failure;
  for (fs::directory_iterator at(folder, failure), end; !failure && at != end;
       at.increment(failure))
    found.push_back(at->path());
  std::sort(found.begin(), found.end());
  return found;
}

/// Folders of the interfaces of a device: "1-4.2:1.0".
std::vector<fs::path> interface_folders(const fs::path& root, const std::string& place) {
  std::vector<fs::path> found;
  for (const fs::path& entry : entries(root / place))
    if (entry.filename().string().starts_with(place + ":")) found.push_back(entry);
  return found;
}

void add_nodes(const fs::path& folder, std::vector<std::string>& nodes) {
  for (const fs::path& entry : entries(folder))
    nodes.push_back("/dev/" + entry.filename().string());
}

std::string first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

}  // namespace

fs::path device_node(const fs::path& name) {
  constexpr int max_links = 40;  // as the kernel follows
  fs::path node = name;
  std::error_code failure;
  for (int i = 0; i < max_links && fs::is_symlink(node, failure); ++i)
    node = (node.parent_path() / fs::read_symlink(node, failure)).lexically_normal();
  return node;
}

std::string manufacturer_of_port(const std::string& port, const fs::path& root) {
  // The interface; its parent is the device.
  const fs::path interface = root / device_node(port).filename() / "device";
  return first_line(interface / ".." / "manufacturer");
}

std::string Sysfs::text(const std::string& place, const std::string& attribute) const {
  return first_line(root_ / place / attribute);
}

std::vector<std::string> Sysfs::serial_ports(const std::string& place) const {
  std::vector<std::string> nodes;
  for (const fs::path& interface : interface_folders(root_, place))
    add_nodes(interface / "tty", nodes);
  return nodes;
}

std::vector<std::string> Sysfs::hid_nodes(const std::string& place) const {
  std::vector<std::string> nodes;
  for (const fs::path& interface : interface_folders(root_, place))
    for (const fs::path& device : entries(interface)) add_nodes(device / "hidraw", nodes);
  return nodes;
}

}  // namespace lamplock::usb
