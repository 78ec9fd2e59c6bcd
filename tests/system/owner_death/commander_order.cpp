#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sstream>
#include <stdexcept>

#include "commander.hpp"

namespace metier::system_tests {
namespace {

constexpr std::size_t kFixedArguments = 6;

std::string textOf(const skill::Value& value) {
    const auto* list = std::get_if<std::vector<double>>(&value);
    return list != nullptr ? fmt::format("[{}", fmt::join(*list, ","))
                           : fmt::format("{}", std::get<double>(value));
}

skill::Value valueOf(const std::string& text) {
    if (!text.starts_with('[')) {
        return std::stod(text);
    }
    std::vector<double> list;
    std::istringstream parts(text.substr(1));
    for (std::string part; std::getline(parts, part, ',');) {
        list.push_back(std::stod(part));
    }
    return list;
}

}  // namespace

std::vector<std::string> argumentsOf(const CommanderOrder& order) {
    std::vector<std::string> arguments{order.url,
                                       order.skill,
                                       std::to_string(order.lease.count()),
                                       std::to_string(static_cast<int>(order.on_loss)),
                                       std::to_string(static_cast<int>(order.at)),
                                       std::to_string(order.delay.count())};
    for (const auto& [name, value] : order.parameters) {
        arguments.push_back(fmt::format("{}={}", name, textOf(value)));
    }
    return arguments;
}

CommanderOrder orderFrom(const std::vector<std::string>& arguments) {
    if (arguments.size() < kFixedArguments) {
        throw std::invalid_argument("URL SKILL LEASE_MS ON_LOSS STATE DELAY_MS NAME=VALUE...");
    }
    CommanderOrder order;
    order.url = arguments[0];
    order.skill = arguments[1];
    order.lease = std::chrono::milliseconds(std::stol(arguments[2]));
    order.on_loss = static_cast<skill::OwnerLossAction>(std::stoi(arguments[3]));
    order.at = static_cast<AtFault>(std::stoi(arguments[4]));
    order.delay = std::chrono::milliseconds(std::stol(arguments[5]));
    for (std::size_t i = kFixedArguments; i < arguments.size(); ++i) {
        const auto equals = arguments[i].find('=');
        order.parameters.emplace(arguments[i].substr(0, equals),
                                 valueOf(arguments[i].substr(equals + 1)));
    }
    return order;
}

}  // namespace metier::system_tests
