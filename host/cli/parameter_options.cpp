#include "host/cli/parameter_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <variant>

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

CLI::Validator text_for(const Parameter& parameter) {
  if (!parameter.names.empty()) return one_of(parameter.names);
  const auto check = parameter.check;
  return {[check](const std::string& text) { return check == nullptr ? "" : check(text); }, ""};
}

/// Makes one option, by the kind of its value.
class OptionMaker {
 public:
  OptionMaker(CLI::App& app, const Parameter& parameter) : app_(app), p_(parameter) {}

  CLI::Option* make() const {
    return std::visit([this](auto* place) { return option(*place); }, p_.place);
  }

 private:
  template <class Value>
  CLI::Option* add(Value& value, const CLI::Validator& check) const {
    return app_.add_option(p_.option, value, p_.about)->check(check)->type_name(kind_of_value(p_));
  }

  CLI::Option* option(double& value) const {
    return add(value, number_in(p_.range))->capture_default_str();
  }
  CLI::Option* option(std::optional<double>& value) const {
    return add(value, number_in(p_.range));
  }
  CLI::Option* option(int& value) const {
    return add(value, number_in(p_.range))->capture_default_str();
  }
  CLI::Option* option(bool& value) const { return app_.add_flag(p_.option, value, p_.about); }
  CLI::Option* option(std::optional<bool>& value) const {
    const std::string both = fmt::format("{},!--no-{}", p_.option, p_.option.substr(2));
    return app_.add_flag_function(
        both, [&value](std::int64_t count) { value = count > 0; }, p_.about);
  }
  CLI::Option* option(std::string& value) const {
    CLI::Option* made = add(value, text_for(p_));
    return value.empty() ? made : made->capture_default_str();
  }
  CLI::Option* option(std::optional<std::string>& value) const { return add(value, text_for(p_)); }
  CLI::Option* option(std::optional<Triple>& value) const {
    const std::string& name = p_.option;
    const auto take = [&value, name](const std::vector<double>& numbers) {
      Triple three{};
      if (numbers.size() != three.size())
        throw CLI::ArgumentMismatch(name + ": give three numbers, X,Y,Z");
      std::copy(numbers.begin(), numbers.end(), three.begin());
      value = three;
    };
    return app_.add_option_function<std::vector<double>>(name, take, p_.about)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(number_in(p_.range))
        ->type_name(kind_of_value(p_));
  }
  CLI::Option* option(std::vector<std::string>& value) const {
    return add(value, text_for(p_))->allow_extra_args(false);
  }

  CLI::App& app_;
  const Parameter& p_;
};

}  // namespace

std::vector<CLI::Option*> add_parameters(CLI::App& app, const std::vector<Parameter>& parameters,
                                         const std::string& group) {
  std::vector<CLI::Option*> options;
  options.reserve(parameters.size());
  for (const Parameter& parameter : parameters)
    options.push_back(OptionMaker(app, parameter).make()->group(group));
  return options;
}

}  // namespace lamplock::cli
