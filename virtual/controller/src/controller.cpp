#include "metier/virtual_controller/controller.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace metier::virtual_controller {

std::function<Result<void>(const std::string& value)> always(std::function<void()> act) {
    return [act = std::move(act)](const std::string&) {
        act();
        return Result<void>();
    };
}

Result<void> performOneOf(const std::vector<InjectionHelp>& known, const Injection& injection) {
    const auto found = std::ranges::find(known, injection.name, &InjectionHelp::name);
    if (found != known.end() && found->perform) {
        return found->perform(injection.value);
    }
    std::vector<std::string> names;
    std::ranges::transform(known, std::back_inserter(names), &InjectionHelp::name);
    return fail(Errc::not_found,
                fmt::format("nothing called \"{}\" can be injected here; there are: {}",
                            injection.name, fmt::join(names, ", ")));
}

}  // namespace metier::virtual_controller
