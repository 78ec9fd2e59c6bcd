#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "metier/client/control_handle.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/link/stop_signal.hpp"
#include "owner_options.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

using client::ControlHandle;

constexpr std::chrono::milliseconds kLook{100};
constexpr std::chrono::milliseconds kDefaultLease{1'000};

struct OwnOptions {
    std::string url;
    OwnerOptions owner;
};

/// The controllers of a server's skills, each once.
Result<std::vector<client::SkillAddress::Above>> controllersOf(opcua::Client& client) {
    METIER_ASSIGN(const auto skills, client::findSkills(client));
    std::vector<client::SkillAddress::Above> controllers;
    for (const auto& skill : skills) {
        const auto* controller = skill.controller();
        const bool known = controller == nullptr ||
                           std::any_of(controllers.begin(), controllers.end(),
                                       [&](const auto& c) { return c.node == controller->node; });
        if (!known) {
            controllers.push_back(*controller);
        }
    }
    if (controllers.empty()) {
        return fail(Errc::not_found, "the server has no controller with skills");
    }
    return controllers;
}

Result<Exit> runOwn(const OwnOptions& options, const CommandIdentity& identity) {
    const link::StopSignal signal;
    METIER_ASSIGN(const auto client, connectTo(identity, options.url));
    METIER_ASSIGN(const auto controllers, controllersOf(*client));
    const auto lease = options.owner.lease_ms == 0 ? kDefaultLease : options.owner.lease();
    std::vector<ControlHandle> controls;
    for (const auto& controller : controllers) {
        METIER_ASSIGN(auto control,
                      ControlHandle::acquire(*client, controller.node,
                                             {.lease = lease, .on_loss = options.owner.action()}));
        fmt::print("control of {} taken, epoch {}\n", controller.name, control.epoch());
        control.onLost([name = controller.name](const opcua::Failure& why) {
            fmt::print(stderr, "metier: control of {} is lost: {}\n", name, why.message);
        });
        controls.push_back(std::move(control));
    }
    fmt::print("Ctrl-C gives it back\n");
    static_cast<void>(std::fflush(stdout));
    while (!signal.waitUntil(std::chrono::steady_clock::now() + kLook)) {
        const bool lost = std::any_of(controls.begin(), controls.end(),
                                      [](const ControlHandle& control) { return !control.held(); });
        if (lost) {
            return report({Errc::locked, "control is lost, and is not taken again by itself"});
        }
    }
    return Exit::success;
}

}  // namespace

void addOwn(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<OwnOptions>();
    auto* command = app.add_subcommand(
        "own", "Take control of a server's arms and keep it: nobody else may command but Halt");
    command->add_option("url", options->url, "Address of the server: opc.tcp://host:port")
        ->required();
    addOwnerOptions(*command, options->owner,
                    "Control is lost after so long without a heartbeat, such as 300ms [1s]");
    command->callback(
        [options, &context] { context.exit = exitOf(runOwn(*options, context.identity)); });
}

}  // namespace metier::app
