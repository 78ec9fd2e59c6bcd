#include "host/skill_host.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "host/port_lock.hpp"
#include "host/server_limits.hpp"
#include "metier/opcua_skill/base_placement.hpp"
#include "metier/opcua_skill/live_figures.hpp"
#include "metier/opcua_skill/skill_dictionary.hpp"
#include "metier/server/kinematics_conversion.hpp"

namespace metier::server {
namespace {

constexpr std::chrono::seconds kLongestBraking{2};

/// Skill objects of the NodeSet that nobody wants would stay without a skill.
Result<void> checkAllWanted(const std::vector<opcua::Reference>& nodes,
                            const std::vector<std::string>& wanted) {
    for (const auto& node : nodes) {
        const auto& name = node.browse_name.name;
        if (std::find(wanted.begin(), wanted.end(), name) == wanted.end()) {
            return fail(Errc::invalid_argument,
                        fmt::format("skills = [{}], but the NodeSet also has {}",
                                    fmt::join(wanted, ", "), name));
        }
    }
    return {};
}

}  // namespace

Result<std::unique_ptr<SkillHost>> SkillHost::create(const cell::ServerConfig& config,
                                                     const Identity& identity,
                                                     std::vector<std::string> nodesets,
                                                     std::shared_ptr<skill::ExecutionNames> names) {
    auto port_lock = lockPort(config);
    if (!port_lock) {
        return fail(port_lock.error());
    }
    std::unique_ptr<SkillHost> host(new SkillHost(config, identity));
    host->port_lock_ = std::move(*port_lock);
    if (auto made = host->makeServer(std::move(nodesets)); !made) {
        return fail(made.error());
    }
    auto skills = opcua_skill::SkillServer::create(*host->server_, host->clock_);
    if (!skills) {
        return fail(skills.error());
    }
    host->skills_ = std::move(*skills);
    if (auto followed = host->audit_ == nullptr
                            ? Result<void>()
                            : host->audit_->follow(*host->server_, host->skills_->executor());
        !followed) {
        return fail(followed.error());
    }
    auto records = ServerRecords::open(config, host->application_uri_);
    if (!records) {
        return fail(records.error());
    }
    host->records_ = std::move(*records);
    if (auto followed = host->records_ == nullptr
                            ? Result<void>()
                            : host->records_->follow(*host->server_, host->skills_->executor());
        !followed) {
        return fail(followed.error());
    }
    if (auto published = opcua_skill::publishDictionary(host->nodes()); !published) {
        return fail(published.error());
    }
    host->control_ = std::make_shared<skill::Control>(host->skills_->executor(), host->clock_);
    host->names_ = std::move(names);
    if (host->names_ != nullptr) {
        return host;
    }
    if (auto kept = host->keepNames(config); !kept) {
        return fail(kept.error());
    }
    return host;
}

/// A server is the same one after a restart if it has the same name, address and port.
Result<void> SkillHost::keepNames(const cell::ServerConfig& config) {
    if (config.state_folder.empty()) {
        names_ = std::make_shared<skill::ExecutionNames>();
        return {};
    }
    auto names = skill::ExecutionNames::open(
        config.state_folder /
        fmt::format("{}-{}-{}.executions", config.name, config.address, config.port));
    if (!names) {
        return fail(names.error());
    }
    names_ = std::move(*names);
    return {};
}

SkillHost::SkillHost(cell::ServerConfig config, const Identity& identity)
    : config_(std::move(config)), identity_(identity) {}

Result<void> SkillHost::makeServer(std::vector<std::string> nodesets) {
    opcua::ServerOptions options;
    options.application_name = "metier " + config_.name;
    options.port = config_.port;
    options.bind_addresses = {config_.address};
    options.nodesets = std::move(nodesets);
    options.nodesets.insert(options.nodesets.begin(), {"device", "robotics", "metier"});
    options.event_publishing = config_.publish_at_once ? opcua::EventPublishing::at_once
                                                       : opcua::EventPublishing::at_interval;
    options.limits = limitsOf(config_.limits);
    options.application_uri = applicationUriOf(config_);
    auto access = secureServer(options, identity_, clock_);
    if (!access) {
        return fail(access.error());
    }
    access_ = std::move(*access);
    application_uri_ = options.application_uri;
    auto audit = ServerAudit::open(config_, options);
    if (!audit) {
        return fail(audit.error());
    }
    audit_ = std::move(*audit);
    auto server = opcua::Server::create(std::move(options));
    if (!server) {
        return fail(server.error());
    }
    server_ = std::move(*server);
    if (access_ != nullptr) {
        access_->follow(*server_);
    }
    return {};
}

/// Whatever watches the Programs lets go of them between the server's thread and their end. A disk
/// that hangs is waited for once they have stopped their device.
SkillHost::~SkillHost() {
    if (announcement_ && !skills_->comeToRest("the server is ended", kLongestBraking)) {
        spdlog::error("{}: something still moves {} s after it was to brake: its device stops it",
                      config_.name, kLongestBraking.count());
    }
    announcement_.reset();
    stall_watch_.reset();
    device_watch_.reset();
    if (server_ != nullptr) {
        server_->stop();
    }
    metrics_.reset();
    if (records_ != nullptr) {
        records_->letGo();
    }
}

Result<void> SkillHost::start() {
    if (auto watched = watchPrograms(); !watched) {
        return watched;
    }
    watchStalls();
    auto started = server_->start();
    if (started && access_ == nullptr) {
        identity_.security().noteServedOpen(url());
    }
    if (started) {
        announcement_.emplace(config_, identity_, application_uri_, url());
    }
    return started;
}

Result<void> SkillHost::watchPrograms() {
    if (auto published = skills_->publishRecords(); !published) {
        return published;
    }
    const auto programs = skills_->programs();
    if (records_ != nullptr) {
        records_->record(programs, controller_, moved_);
    }
    if (!config_.metrics) {
        return {};
    }
    auto metrics = ServerMetrics::start(
        config_, {.server = *server_,
                  .control = *control_,
                  .programs = programs,
                  .arm = moved_.arm,
                  .gripper = gripper_,
                  .recorder = records_ == nullptr ? nullptr : &records_->recorder(),
                  .audit = audit_.get()});
    if (!metrics) {
        return fail(metrics.error());
    }
    metrics_ = std::move(*metrics);
    return {};
}

void SkillHost::watchStalls() {
    const std::chrono::duration<double> stall_limit(config_.stall_limit);
    std::function<void()> stop_all;
    if (!stops_.empty()) {
        stop_all = [this] {
            for (const auto& stop : stops_) {
                stop();
            }
        };
    }
    stall_watch_.emplace(
        robot_skills::StallWatch::Setup{
            .name = config_.name,
            .limit = std::chrono::duration_cast<std::chrono::nanoseconds>(stall_limit),
            .stop = std::move(stop_all),
            .log = [](const std::string& line) { spdlog::error("{}", line); }},
        skills_->executor(), skills_->programs(), clock_);
}

Result<void> SkillHost::publishArm(const opcua_skill::MotionDeviceSystem& system,
                                   const ShownArm& shown) {
    moved_ = {&shown.arm, shown.sensor, shown.arm.info().name};
    auto data = toKinematicsData(shown.model);
    data.payload = shown.payload;
    auto published = opcua_skill::publishKinematics(server_->nodes(), system, data,
                                                    [shown] { return stateOf(shown); });
    if (!published) {
        return published;
    }
    if (auto served = opcua_skill::serveBasePlacement(*server_, system); !served) {
        return served;
    }
    return opcua_skill::publishArmFigures(server_->nodes(), system.kinematics,
                                          figuresOf(shown, clock_));
}

Result<void> SkillHost::publishGripper(const opcua::NodeId& parent,
                                       const device::Gripper& gripper) {
    gripper_ = &gripper;
    if (moved_.name.empty()) {
        moved_.name = gripper.info().name;
    }
    const auto& kind = gripper.info();
    return opcua_skill::publishGripperFigures(
        server_->nodes(), parent, {kind.stroke, kind.max_force > 0.0},
        [&gripper]() -> std::optional<opcua_skill::GripperFigures> {
            const auto state = gripper.state();
            if (state.safety == device::SafetyState::disconnected) {
                return std::nullopt;
            }
            return opcua_skill::GripperFigures{state.width, state.force, state.part_held};
        });
}

Result<void> SkillHost::offerControl(const opcua::NodeId& controller) {
    const auto name = server_->nodes().browseNameOf(controller);
    if (!name) {
        return fail(name.error());
    }
    controller_ = name->name;
    return skills_->serveControl(controller, control_);
}

std::vector<DeviceSkill> sharing(const std::shared_ptr<skill::Resource>& resource,
                                 std::vector<std::unique_ptr<skill::Skill>> skills) {
    std::vector<DeviceSkill> all;
    for (auto& skill : skills) {
        all.push_back({std::move(skill), resource});
    }
    return all;
}

Result<void> SkillHost::offerSkills(const opcua::NodeId& folder,
                                    const std::vector<std::string>& wanted,
                                    std::vector<DeviceSkill> skills) {
    const auto nodes = server_->nodes().browse(folder);
    if (!nodes) {
        return fail(nodes.error());
    }
    if (auto all_wanted = checkAllWanted(*nodes, wanted); !all_wanted) {
        return all_wanted;
    }
    for (const auto& name : wanted) {
        const auto found = std::find_if(skills.begin(), skills.end(), [&](const auto& one) {
            return one.skill && one.skill->description().name == name;
        });
        if (found == skills.end()) {
            return fail(Errc::not_supported, fmt::format("no skill '{}' for this device", name));
        }
        const auto node = std::find_if(nodes->begin(), nodes->end(), [&](const auto& reference) {
            return reference.browse_name.name == name;
        });
        const skill::ProgramOptions options{
            .resource = found->resource, .control = control_, .names = names_};
        const auto offered = node == nodes->end()
                                 ? skills_->publish(folder, std::move(found->skill), options)
                                 : skills_->bind(node->target, std::move(found->skill), options);
        if (!offered) {
            return fail(offered.error());
        }
    }
    return {};
}

}  // namespace metier::server
