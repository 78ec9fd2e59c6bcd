// A client of any skill: finds it, sets its parameters, starts it, follows its states and prints
// its result. Halts it at Ctrl-C, and when it takes too long.
#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/opcua/client.hpp"
#include "metier/skill/json.hpp"
#include "metier/skill/values.hpp"

using namespace metier;
using namespace std::chrono_literals;

namespace {

/// Arguments of the command line.
struct Order {
    std::string url;
    std::string skill;
    std::chrono::seconds longest{};
    std::vector<std::string> settings;  // Name=value
};

/// Errors: invalid_argument, if the command line is wrong.
Result<Order> readOrder(const std::vector<std::string>& arguments) {
    constexpr std::size_t kFirstSetting = 3;
    if (arguments.size() < kFirstSetting) {
        return fail(
            Errc::invalid_argument,
            "usage: run_skill URL SKILL SECONDS [NAME=VALUE]...\n"
            "A VALUE is as in JSON: 0.5, true, [0.2, 0.5], \"text\". SECONDS is the longest "
            "time that the skill may take.");
    }
    const auto& seconds = arguments[2];
    unsigned longest = 0;
    const auto* const end = seconds.data() + seconds.size();
    if (const auto read = std::from_chars(seconds.data(), end, longest);
        read.ec != std::errc() || read.ptr != end || longest == 0) {
        return fail(Errc::invalid_argument,
                    fmt::format("'{}' is not a number of seconds, 1 or more", seconds));
    }
    return Order{arguments[0],
                 arguments[1],
                 std::chrono::seconds(longest),
                 {arguments.begin() + kFirstSetting, arguments.end()}};
}

/// The parameter of a text "Name=value", of the type that the server names.
/// Errors: not_found (no such parameter), type_mismatch (a value of another type),
/// invalid_argument.
Result<skill::Value> valueOf(const client::SkillHandle& skill, const std::string& name,
                             const std::string& text) {
    const auto* const field = skill::findField(skill.parameters(), name);
    if (field == nullptr) {
        return fail(Errc::not_found,
                    fmt::format("{} has no parameter '{}'", skill.address().name, name));
    }
    const auto json = nlohmann::json::parse(text, nullptr, false);
    return json.is_discarded()
               ? fail(Errc::invalid_argument, fmt::format("{}: '{}' is no JSON value", name, text))
               : skill::valueFrom(json, field->type, name);
}

Result<skill::ValueMap> parametersOf(const client::SkillHandle& skill,
                                     const std::vector<std::string>& settings) {
    skill::ValueMap values;
    for (const auto& setting : settings) {
        const auto equals = setting.find('=');
        const auto name = setting.substr(0, equals);
        const auto text = equals == std::string::npos ? std::string() : setting.substr(equals + 1);
        METIER_ASSIGN(values[name], valueOf(skill, name, text));
    }
    return values;
}

/// Halts the skill and waits until it stands still.
/// \return the error with which this program ends
Error haltBecause(client::SkillHandle& skill, const std::string& why) {
    auto rest = skill.halt().and_then(
        [&] { return skill.awaitRest(std::chrono::steady_clock::now() + 10s); });
    return {Errc::cancelled,
            rest ? fmt::format("{}: it is {} now", why, skill::toString(*rest))
                 : fmt::format("{}, and it may still run: {}", why, rest.error().message)};
}

/// Waits for the end of the execution that was started. Halts it at Ctrl-C and at the deadline.
/// Errors: also if it ended Halted, with the server's reason.
Result<void> follow(client::SkillHandle& skill, const link::StopSignal& stop, SteadyTime deadline) {
    constexpr auto kLook = 100ms;  // how soon Ctrl-C is noticed
    while (std::chrono::steady_clock::now() < deadline) {
        if (stop.came()) {
            return fail(haltBecause(skill, "halted by Ctrl-C"));
        }
        const auto end = skill.awaitEnd(std::chrono::steady_clock::now() + kLook);
        if (end) {
            return end->to == skill::State::ready ? Result<void>()
                                                  : fail(Errc::device_fault, end->message);
        }
        if (end.error().code != Errc::timeout) {
            return fail(end.error().code, end.error().message);
        }
    }
    return fail(haltBecause(skill, "halted, since it takes too long"));
}

void printTransition(const skill::TransitionEvent& event) {
    fmt::print("{} to {}{}{}\n", skill::toString(event.from), skill::toString(event.to),
               event.reason_text.empty() ? "" : ": ", event.reason_text);
}

/// Each call has a deadline: 5 s unless ClientOptions say otherwise.
Result<void> run(const Order& order, const link::StopSignal& stop) {
    const opcua::ClientOptions options{.application_name = "run_skill"};
    METIER_ASSIGN(const auto connection, opcua::Client::connect(order.url, options));
    METIER_ASSIGN(auto address, client::findSkill(*connection, order.skill));
    METIER_ASSIGN(auto skill, client::SkillHandle::open(*connection, std::move(address)));
    METIER_ASSIGN(auto parameters, parametersOf(skill, order.settings));
    skill.onTransition(printTransition);
    METIER_TRY(skill.startWith({.parameters = std::move(parameters)}));
    METIER_TRY(follow(skill, stop, std::chrono::steady_clock::now() + order.longest));
    METIER_ASSIGN(const auto result, skill.result());
    fmt::print("{}\n", skill::jsonOf(result));
    return {};
}

}  // namespace

int main(int argc, char** argv) {
    const link::StopSignal stop;  // before any thread
    const auto order = readOrder({argv + 1, argv + argc});
    const auto ended = order ? run(*order, stop) : fail(order.error());
    if (!ended) {
        fmt::print(stderr, "run_skill: {}\n", ended.error().message);
        return order ? 1 : 2;
    }
    return 0;
}
