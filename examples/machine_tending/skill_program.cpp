#include "skill_program.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string_view>
#include <utility>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/opcua_skill/skill_types.hpp"
#include "metier/server/ready_line.hpp"
#include "metier/skill/control.hpp"
#include "metier/skill/skill_type.hpp"

namespace metier::example {
namespace {

constexpr std::chrono::seconds kLongestBraking{5};

/// The skills of one device at their OPC UA nodes.
class Served {
public:
    Result<void> begin(const Device& device, std::uint16_t port) {
        opcua::ServerOptions options;
        options.application_name = device.name;
        options.application_uri = "urn:example:" + device.name;
        options.port = port;
        options.nodesets = {"device", "robotics", "metier"};
        METIER_ASSIGN(server_, opcua::Server::create(std::move(options)));
        METIER_ASSIGN(skills_, opcua_skill::SkillServer::create(*server_, clock_));
        auto offered = device.skills(skills_->executor());
        METIER_TRY(declare(device, offered));
        METIER_ASSIGN(const auto place, opcua_skill::publishSkillController(
                                            server_->nodes(), device.name, device.description));
        // One client at a time commands the device: all its skills share the control.
        const auto control = std::make_shared<skill::Control>(skills_->executor(), clock_);
        for (auto& one : offered) {
            METIER_TRY(skills_->publish(place.skills, std::move(one.skill), {.control = control}));
        }
        METIER_TRY(skills_->serveControl(place.controller, control));
        return server_->start();
    }

    std::string url() const { return server_->endpointUrl(); }
    /// \return false if something still moves after kLongestBraking
    bool end() { return skills_->comeToRest("the program ends", kLongestBraking); }

private:
    /// Makes the skills' types known; they have the parameters and results of the skills.
    Result<void> declare(const Device& device, const std::vector<Offered>& offered) {
        skill::SkillTypes types{.uri = device.types};
        for (const auto& one : offered) {
            auto type = skill::skillTypeOf(one.skill->description());
            type.terms = one.terms;
            types.types.push_back(std::move(type));
        }
        return opcua_skill::declareTypes(server_->nodes(), types);
    }

    SystemClock clock_;
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua_skill::SkillServer> skills_;  // ends before the server
};

std::optional<std::uint16_t> portOf(int argc, char** argv) {
    if (argc < 2) {
        return 0;
    }
    const std::string_view text = argv[1];
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    return whole && argc == 2 ? std::optional(port) : std::nullopt;
}

}  // namespace

int serve(const Device& device, int argc, char** argv) {
    const link::StopSignal stop;  // before any thread
    const auto port = portOf(argc, argv);
    if (!port) {
        fmt::print(stderr, "usage: {} [PORT], 0 to 65535\n", argv[0]);
        return 2;
    }
    spdlog::set_default_logger(spdlog::stderr_logger_mt(device.name));  // the ready line is alone
    Served served;
    if (const auto begun = served.begin(device, *port); !begun) {
        fmt::print(stderr, "{}: {}\n", device.name, begun.error().message);
        return 1;
    }
    fmt::print("{}\n", server::readyLine(served.url()));
    std::fflush(stdout);
    stop.wait();
    if (!served.end()) {
        fmt::print(stderr, "{}: still moves {} s after it was to brake\n", device.name,
                   kLongestBraking.count());
        return 1;
    }
    return 0;
}

}  // namespace metier::example
