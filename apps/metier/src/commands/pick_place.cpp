#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "metier/client/skill_handle.hpp"
#include "pick_place_run.hpp"
#include "second_try.hpp"
#include "servers.hpp"
#include "side_by_side.hpp"
#include "value_text.hpp"

namespace metier::app {
namespace {

using client::SkillHandle;

constexpr const char* kType = "PickPlaceSkillType";
constexpr std::chrono::seconds kLongestPartReset{5};

/// One PickPlaceSkill with the connection that it is used over.
struct Component {
    std::string name;
    std::string url;
    std::unique_ptr<opcua::Client> client;
    SkillHandle skill;  // ends before its client
};

struct Tally {
    int placed = 0;
    std::vector<std::string> failures;  // "part 3: why"
    std::vector<std::string> retried;   // the same of parts that were tried again
    double time = 0.0;                  // total of all parts [s]
};

Result<std::vector<Component>> findComponents(const CommandIdentity& identity,
                                              const std::vector<std::string>& urls) {
    std::vector<Component> found;
    for (const auto& url : urls) {
        METIER_ASSIGN(auto client, connectTo(identity, url));
        METIER_ASSIGN(const auto skills, client::findSkills(*client));
        auto skill = std::find_if(skills.begin(), skills.end(),
                                  [](const auto& address) { return address.type_name == kType; });
        if (skill == skills.end()) {
            skill = std::find_if(skills.begin(), skills.end(),
                                 [](const auto& address) { return address.servesAs(kType); });
        }
        if (skill == skills.end()) {
            continue;
        }
        METIER_ASSIGN(auto handle, SkillHandle::open(*client, *skill));
        found.push_back({skill->controllerName(), url, std::move(client), std::move(handle)});
    }
    if (found.empty()) {
        return fail(Errc::not_found, fmt::format("no skill of type {} found", kType));
    }
    return found;
}

/// Place of the part with that number, if the first one is at `first`.
Frame placeOf(int part, const Frame& first, const PickPlaceSettings& settings) {
    const double angle = settings.turn * part;
    const double x = first.x + settings.step.x * part;
    const double y = first.y + settings.step.y * part;
    auto frame = first;
    frame.x = std::cos(angle) * x - std::sin(angle) * y;
    frame.y = std::sin(angle) * x + std::cos(angle) * y;
    frame.z += settings.step.z * part;
    frame.c += angle;
    return frame;
}

class Mover {
public:
    /// \param recover resets whatever is Halted, before a part is tried again
    Mover(Component& component, const PickPlaceSettings& settings, const TellRow& tell,
          std::function<void()> recover)
        : component_(component), settings_(settings), tell_(tell), recover_(std::move(recover)) {}

    Tally run() {
        const auto begun = std::chrono::steady_clock::now();
        for (int part = 0; part < settings_.parts && !overruled_ && ready(part); ++part) {
            tell_(static_cast<double>(part) / settings_.parts,
                  fmt::format("part {} of {}", part + 1, settings_.parts));
            for (int tries_left = settings_.second_tries; !move(part, tries_left); --tries_left) {
                recover_();
            }
        }
        tally_.time =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        return std::move(tally_);
    }

private:
    static std::string textOf(int part, const std::string& why) {
        return fmt::format("part {}: {}", part + 1, why);
    }
    void note(int part, const std::string& why) { tally_.failures.push_back(textOf(part, why)); }

    /// Resets what is Halted. \return whether the skill can begin
    bool ready(int part) {
        const auto state = component_.skill.state();
        if (state && *state != skill::State::halted) {
            return true;
        }
        const auto reset = state ? component_.skill.reset() : opcua::Answer<>();
        if (!state || !reset) {
            note(part, !state ? state.error().message : "Reset: " + reset.error().message);
            return false;
        }
        return true;
    }

    /// \return false if the part is to be tried again
    bool move(int part, int tries_left) {
        const skill::ValueMap parameters{{"PickPose", placeOf(part, settings_.pick, settings_)},
                                         {"PlacePose", placeOf(part, settings_.place, settings_)},
                                         {"ApproachDistance", settings_.approach},
                                         {"GraspForce", settings_.force}};
        const auto deadline = std::chrono::steady_clock::now() + settings_.timeout;
        const auto result = component_.skill.runWith({"", parameters}, deadline);
        if (result) {
            ++tally_.placed;
            return true;
        }
        overruled_ = result.error().code == Errc::cancelled;
        if (!overruled_ && tries_left > 0) {
            tally_.retried.push_back(textOf(part, result.error().message));
            return false;
        }
        note(part, result.error().message);
        return true;
    }

    Component& component_;
    const PickPlaceSettings& settings_;
    const TellRow& tell_;
    std::function<void()> recover_;
    Tally tally_;
    bool overruled_ = false;  // another client has halted it, so it is not begun again
};

/// All components at the same time.
/// \param recover as Mover takes it
std::vector<Tally> moveAll(std::vector<Component>& components, const PickPlaceSettings& settings,
                           const std::function<void()>& recover) {
    std::vector<std::string> names;
    for (const auto& component : components) {
        names.push_back(component.name);
    }
    std::vector<Tally> tallies(components.size());
    runSideBySide(names, settings.timeout * settings.parts,
                  [&](std::size_t row, const TellRow& tell) {
                      tallies[row] = Mover(components[row], settings, tell, recover).run();
                      return tallies[row].failures.empty();
                  });
    return tallies;
}

std::string tableOf(const std::vector<Component>& components, const std::vector<Tally>& tallies) {
    auto table =
        fmt::format("{:<16} {:>6} {:>6} {:>8}\n", "component", "placed", "failed", "time/s");
    for (std::size_t i = 0; i < components.size(); ++i) {
        table += fmt::format("{:<16} {:>6} {:>6} {:>8.2f}\n", components[i].name, tallies[i].placed,
                             tallies[i].failures.size(), tallies[i].time);
        for (const auto& failure : tallies[i].failures) {
            table += fmt::format("  {}\n", failure);
        }
        for (const auto& retried : tallies[i].retried) {
            table += fmt::format("  tried again: {}\n", retried);
        }
    }
    return table;
}

std::string jsonOf(const std::vector<Component>& components, const std::vector<Tally>& tallies) {
    auto json = nlohmann::json::array();
    for (std::size_t i = 0; i < components.size(); ++i) {
        json.push_back({{"component", components[i].name},
                        {"url", components[i].url},
                        {"placed", tallies[i].placed},
                        {"failures", tallies[i].failures},
                        {"retried", tallies[i].retried},
                        {"time_s", tallies[i].time}});
    }
    return json.dump(2) + "\n";
}

struct PickPlaceOptions {
    ServerChoice servers;
    PickPlaceSettings settings;
};

Result<Exit> runPickPlace(const PickPlaceOptions& options, const CommandIdentity& identity) {
    METIER_ASSIGN(const auto urls, addressesOf(options.servers));
    return pickAndPlace(identity, urls, options.settings);
}

/// An option that is a frame or a vector, as "0.3,-0.1,0.2,3.14,0,0".
template <typename T>
void addNumbers(CLI::App& command, const std::string& name, T& target,
                const std::string& description) {
    constexpr auto kNotation =
        std::is_same_v<T, Frame> ? skill::ValueType::frame : skill::ValueType::vector3;
    command.add_option_function<std::string>(
        name,
        [&target, name](const std::string& text) {
            const auto value = parseValue(kNotation, text);
            if (!value) {
                throw CLI::ValidationError(name, value.error().message);
            }
            target = std::get<T>(*value);
        },
        description);
}

void addPickPlaceOptions(CLI::App& command, PickPlaceSettings& settings) {
    addNumbers(command, "--pick", settings.pick,
               "Where the first part is grasped: x,y,z,a,b,c in the robot base frame [m, rad]");
    addNumbers(command, "--place", settings.place, "Where the first part goes");
    addNumbers(command, "--step", settings.step, "From one part to the next: x,y,z [m]");
    within(command.add_option("--turn", settings.turn,
                              "From one part to the next, about z of the robot base [rad]"),
           -3.15, 3.15);
    within(command.add_option("--parts", settings.parts, "How many parts"), 1, 100'000);
    within(command.add_option("--approach", settings.approach, "Distance to come in and leave [m]"),
           0.0, 0.5);
    within(command.add_option("--force", settings.force,
                              "Force to hold a part with [N]; 0: the gripper's"),
           0.0, 1000.0);
    command.add_flag("--json", settings.json, "Print the result as JSON");
}

}  // namespace

Result<Exit> pickAndPlace(const CommandIdentity& identity, const std::vector<std::string>& urls,
                          const PickPlaceSettings& settings) {
    METIER_ASSIGN(auto components, findComponents(identity, urls));
    const auto tallies =
        moveAll(components, settings, [&] { resetAllHalted(identity, urls, kLongestPartReset); });
    fmt::print("{}", settings.json ? jsonOf(components, tallies) : tableOf(components, tallies));
    const bool all_placed = std::all_of(tallies.begin(), tallies.end(), [&](const auto& one) {
        return one.placed == settings.parts;
    });
    return all_placed ? Exit::success : Exit::failed;
}

void addPickPlace(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<PickPlaceOptions>();
    auto* command = app.add_subcommand(
        "pick-place", "Have every PickPlaceSkill of some servers move a row of parts");
    command->footer(
        "A part that fails is reported with the reason; the skill is Reset and takes the next.\n"
        "A skill that somebody else halts is left alone, with the parts that remain.\n"
        "Exit status 1 if a part was not placed.");
    addServerChoice(*command, options->servers);
    addServerSearch(*command, options->servers);
    addPickPlaceOptions(*command, options->settings);
    command->callback(
        [options, &context] { context.exit = exitOf(runPickPlace(*options, context.identity)); });
}

}  // namespace metier::app
