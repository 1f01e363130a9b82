#include "host/cli/parameter_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <variant>

#include "host/cli/command_line.hpp"
#include "host/cli/validators.hpp"

namespace lamplock::cli {
namespace {

using glass::Parameter;
using glass::Triple;

/// What the help says instead of a value.
std::string kind_of_value(const Parameter& parameter) {
  if (parameter.names.empty()) return parameter.unit;
  return fmt::format("{}", fmt::join(parameter.names, "|"));
}

Check text_for(const Parameter& parameter) {
  if (!parameter.names.empty()) return one_of(parameter.names);
  return {parameter.check == nullptr ? nullptr : Check{parameter.check}.refusal};
}

/// Describes an option by the kind of its value.
struct Describe {
  Option& option;
  const Parameter& p;

  void operator()(const bool*) const {}
  void operator()(const std::optional<bool>*) const {}
  void operator()(const double*) const { option.check(number_in(p.range)).show_default(); }
  void operator()(const int*) const { option.check(number_in(p.range)).show_default(); }
  void operator()(const std::optional<int>*) const { option.check(number_in(p.range)); }
  void operator()(const std::optional<double>*) const { option.check(number_in(p.range)); }
  void operator()(const std::optional<Triple>*) const {
    option.check(number_in(p.range)).count({3, 3});
  }
  void operator()(const std::string*) const { option.check(text_for(p)).show_default(); }
  void operator()(const std::optional<std::string>*) const { option.check(text_for(p)); }
  void operator()(const std::vector<std::string>*) const { option.check(text_for(p)); }
};

}  // namespace

std::vector<Option*> add_parameters(Command& app, const std::vector<Parameter>& parameters,
                                    const std::string& group) {
  std::vector<Option*> options;
  options.reserve(parameters.size());
  for (const Parameter& parameter : parameters) {
    const Target target = std::visit([](auto* place) { return Target(place); }, parameter.place);
    Option& option = app.add_option(parameter.option, target, parameter.about);
    option.value_name(kind_of_value(parameter)).group(group);
    if (parameter.is_file) option.file(FileUse::read);
    std::visit(Describe{option, parameter}, parameter.place);
    options.push_back(&option);
  }
  return options;
}

}  // namespace lamplock::cli
