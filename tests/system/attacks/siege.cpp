#include "siege.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <sstream>
#include <stdexcept>

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 60s;
constexpr std::size_t kSkills = 8;

link::ChildProcess started(const Cable& cable, const std::string& url, AttackOrder order) {
    const auto address = Cable::addressOf(url);
    const auto host = address.find("//") + 2;
    const auto colon = address.rfind(':');
    order.host = address.substr(host, colon - host);
    order.port = static_cast<std::uint16_t>(std::stoul(address.substr(colon + 1)));
    std::vector<std::string> command{METIER_ATTACKER};
    const auto arguments = argumentsOf(order);
    command.insert(command.end(), arguments.begin(), arguments.end());
    return orThrow(link::ChildProcess::start(cable.atFarEnd(std::move(command))));
}

SteadyTime patience() {
    return std::chrono::steady_clock::now() + kPatience;
}

}  // namespace

Attacker::Attacker(const Cable& cable, const std::string& url, AttackOrder order)
    : process_(started(cable, url, std::move(order))) {
    if (orThrow(process_.readLine(patience())) != kAttacking) {
        throw std::runtime_error("the attacker does not attack");
    }
}

AttackCount Attacker::end() {
    process_.signal(SIGTERM);
    std::istringstream line(orThrow(process_.readLine(patience())));
    std::string word;
    AttackCount count;
    line >> word >> count.connections >> count.refused >> count.cut >> count.requests;
    if (word != kAttacked || !line) {
        throw std::runtime_error("the attacker does not say what it did");
    }
    return count;
}

Siege::Siege(Cable& cable, const opcua::ServerLimits& limits, HaltBounds bounds)
    : cable_(cable), bounds_(bounds), server_({.limits = limits}), operator_(server_) {
    for (std::size_t i = 0; i < kSkills; ++i) {
        skill::SkillDescription description;
        description.name = fmt::format("Disturbed{}", i);
        description.type = "PositionStreamSkillType";
        skill::SkillFunctions functions;
        functions.start = [](const skill::ValueMap&, const skill::ExecutionHandle&) {};
        const auto name = description.name;
        server_.addSkill(std::move(description), std::move(functions));
        skills_.push_back(std::get<std::string>(server_.node(name).identifier()));
    }
    server_.serve();
    operator_.connect();
}

SiegeOutcome Siege::run(Attack attack, std::chrono::milliseconds time) {
    SiegeOutcome outcome;
    outcome.quiet = operator_.measure(time / 4);
    Attacker attacker(cable_, server_.url(),
                      {.attack = attack,
                       .time = std::chrono::duration_cast<std::chrono::seconds>(time + kPatience),
                       .name_space = server_.system().skills.namespaceIndex(),
                       .skills = skills_});
    if (attack == Attack::subscriber) {
        cable_.dropEverything();
    }
    load_.takeLongest();
    outcome.during = operator_.measure(time);
    outcome.load_ms = std::chrono::duration<double, std::milli>(load_.takeLongest()).count();
    outcome.attack = attacker.end();
    if (attack == Attack::subscriber) {
        cable_.restore();
    }
    outcome.defect = judge(outcome);
    return outcome;
}

std::string Siege::judge(const SiegeOutcome& outcome) const {
    const auto& halts = outcome.during;
    if (!outcome.quiet.defect.empty() || !halts.defect.empty()) {
        return outcome.quiet.defect + halts.defect;
    }
    // A Halt takes three threads, each of which may be late.
    const bool strict = bounds_ == HaltBounds::strict;
    const double p99 =
        kHaltP99Ms + (strict ? 0.0 : 2 * outcome.quiet.answered.p99_ms + outcome.load_ms);
    const double most =
        kHaltMaxMs + (strict ? 0.0 : outcome.quiet.answered.max_ms + 3 * outcome.load_ms);
    if (halts.answered.p99_ms > p99 || halts.answered.max_ms > most) {
        return fmt::format(
            "Halt took {:.1f} ms (p99 of {}) and {:.1f} ms at most, over {:.1f} ms or {:.1f} ms",
            halts.answered.p99_ms, halts.answered.count, halts.answered.max_ms, p99, most);
    }
    return {};
}

}  // namespace metier::system_tests
