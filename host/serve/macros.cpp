#include "host/serve/macros.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/link/program_lines.hpp"
#include "host/serve/refusal.hpp"

namespace lamplock::serve {
namespace {

/// As they are sent to a board, without blank lines.
std::vector<std::string> lines_to_send(const std::string& name, const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    const std::string sent =
        link::line_to_send(line, fmt::format("macro {}, line {}", name, ++number), "remove it");
    if (!sent.empty()) lines.push_back(sent);
  }
  return lines;
}

}  // namespace

std::map<std::string, std::string> Macros::all() const {
  if (!std::filesystem::exists(file_)) return {};
  try {
    return nlohmann::json::parse(read_file(file_.string()));
  } catch (const nlohmann::json::exception&) {
    throw Error(Exit::bad_input, file_.string(), "is not a file of macros", "remove it");
  }
}

std::vector<std::string> Macros::lines_of(const std::string& name) const {
  const auto macros = all();
  const auto found = macros.find(name);
  if (found == macros.end()) throw Refusal(Exit::bad_input, "no-macro", {{"name", name}});
  return lines_to_send(name, found->second);
}

void Macros::set(const std::string& name, const std::string& lines) const {
  const std::size_t count = lines_to_send(name, lines).size();
  if (count == 0 || count > max_lines)
    throw Refusal(Exit::bad_input, "macro-lines",
                  {{"name", name},
                   {"lines", fmt::format("{}", count)},
                   {"max", fmt::format("{}", max_lines)}});
  auto macros = all();
  macros[name] = lines;
  if (macros.size() > max_macros)
    throw Refusal(Exit::bad_input, "many-macros",
                  {{"name", name}, {"max", fmt::format("{}", max_macros)}});
  write(macros);
}

void Macros::remove(const std::string& name) const {
  auto macros = all();
  if (macros.erase(name) == 0) throw Refusal(Exit::bad_input, "no-macro", {{"name", name}});
  write(macros);
}

void Macros::write(const std::map<std::string, std::string>& macros) const {
  write_whole(file_, nlohmann::json(macros).dump(2) + "\n");
}

}  // namespace lamplock::serve
