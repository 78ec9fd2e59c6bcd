#include "step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <sstream>

namespace metier::system_tests {

namespace {

struct ActRow {
    std::string_view name;
    std::uint32_t weight;  ///< frequency, so that every state is reached
};

/// In the order of Act.
constexpr std::array<ActRow, kActs> kRows{{
    {"write_target", 8},   {"write_speed", 4},    {"write_badly", 1}, {"write_wrong_type", 1},
    {"write_null", 1},     {"start", 8},          {"start_with", 12}, {"check", 2},
    {"suspend", 7},        {"resume", 6},         {"halt", 3},        {"reset", 10},
    {"acquire", 3},        {"heartbeat", 3},      {"release", 2},     {"init_lock", 1},
    {"renew_lock", 1},     {"exit_lock", 2},      {"break_lock", 1},  {"get_execution", 2},
    {"close_session", 1},  {"cut_connection", 1}, {"at_rest", 10},    {"finish", 6},
    {"force_exceeded", 1}, {"device_lost", 1},    {"fault_stays", 1}, {"fault_is_gone", 2},
    {"wait", 6},
}};
constexpr std::array<std::string_view, kClients> kClientNames{"alice", "bob", "carol"};
constexpr std::array<std::string_view, kSkills> kSkillNames{"first", "second"};

template <typename Names>
std::size_t indexOf(const Names& names, std::string_view name) {
    return static_cast<std::size_t>(
        std::distance(names.begin(), std::find(names.begin(), names.end(), name)));
}

/// Takes a choice out of a value.
std::uint32_t take(std::uint32_t& value, std::uint32_t choices) {
    const auto choice = value % choices;
    value /= choices;
    return choice;
}

}  // namespace

StartChoice::StartChoice(std::uint32_t value) {
    constexpr std::uint32_t names = 16;
    constexpr std::uint32_t unnamed = 4;
    const auto chosen_name = take(value, names);
    name = chosen_name < unnamed ? 0 : chosen_name;
    const auto chosen_epoch = take(value, 4);
    epoch = chosen_epoch < 2 ? Epoch::none : chosen_epoch == 2 ? Epoch::own : Epoch::others;
    const auto chosen_deadline = take(value, 4);
    deadline = chosen_deadline < 2    ? Deadline::none
               : chosen_deadline == 2 ? Deadline::to_come
                                      : Deadline::passed;
    const auto chosen_action = take(value, 4);
    on_owner_loss = chosen_action;
    constexpr std::uint32_t speeds = 8;
    const auto chosen_speed = take(value, speeds);
    with_target = chosen_speed != speeds - 1;
    speed = chosen_speed == speeds - 2 ? 1.5 : 0.125 * chosen_speed;
}

std::string_view clientName(std::size_t client) {
    return kClientNames.at(client);
}

std::string_view skillName(std::size_t skill) {
    return kSkillNames.at(skill);
}

std::string toString(const Step& step) {
    return fmt::format("{} {} {} {}", kRows.at(static_cast<std::size_t>(step.act)).name,
                       clientName(step.client), skillName(step.skill), step.value);
}

std::string toString(const History& history) {
    std::string text;
    for (const auto& step : history) {
        text += toString(step) + "\n";
    }
    return text;
}

Result<History> historyFrom(std::string_view text) {
    std::istringstream lines{std::string(text)};
    History history;
    std::string line;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string act;
        std::string client;
        std::string skill;
        Step step;
        words >> act >> client >> skill >> step.value;
        const auto* row = std::find_if(kRows.begin(), kRows.end(),
                                       [&](const ActRow& known) { return known.name == act; });
        step.act = static_cast<Act>(std::distance(kRows.begin(), row));
        step.client = indexOf(kClientNames, client);
        step.skill = indexOf(kSkillNames, skill);
        if (!words || row == kRows.end() || step.client == kClients || step.skill == kSkills ||
            step.value >= kValues) {
            return fail(Errc::invalid_argument, fmt::format("no step: \"{}\"", line));
        }
        history.push_back(step);
    }
    return history;
}

History RandomSteps::history(std::size_t length) {
    History history(length);
    std::generate(history.begin(), history.end(), [this] { return next(); });
    return history;
}

Step RandomSteps::next() {
    static const auto sum_of_weights =
        std::accumulate(kRows.begin(), kRows.end(), 0U,
                        [](std::uint32_t sum, const ActRow& row) { return sum + row.weight; });
    auto place = below(sum_of_weights);
    std::size_t act = 0;
    while (place >= kRows.at(act).weight) {
        place -= kRows.at(act).weight;
        ++act;
    }
    Step step{static_cast<Act>(act), below(kClients), below(kSkills), below(kValues)};
    if (step.act == Act::cut_connection) {
        step.client = kClients - 1;
    }
    return step;
}

}  // namespace metier::system_tests
