#include "host/skill_host.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "host/port_lock.hpp"
#include "host/recorded_used_skill.hpp"
#include "host/server_limits.hpp"
#include "metier/composition/skill_type_file.hpp"
#include "metier/opcua_skill/base_placement.hpp"
#include "metier/opcua_skill/live_figures.hpp"
#include "metier/opcua_skill/skill_dictionary.hpp"
#include "metier/opcua_skill/skill_types.hpp"
#include "metier/server/kinematics_conversion.hpp"

namespace metier::server {
namespace {

constexpr std::chrono::seconds kLongestBraking{2};

/// Checks that every skill object of the NodeSet gets a skill.
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
    METIER_ASSIGN(auto port_lock, lockPort(config));
    std::unique_ptr<SkillHost> host(new SkillHost(config, identity));
    host->port_lock_ = std::move(port_lock);
    METIER_TRY(host->makeServer(std::move(nodesets)));
    METIER_ASSIGN(host->skills_, opcua_skill::SkillServer::create(*host->server_, host->clock_));
    METIER_TRY(host->audit_ == nullptr
                   ? Result<void>()
                   : host->audit_->follow(*host->server_, host->skills_->executor()));
    METIER_ASSIGN(host->records_, ServerRecords::open(config, host->application_uri_));
    METIER_TRY(host->records_ == nullptr
                   ? Result<void>()
                   : host->records_->follow(*host->server_, host->skills_->executor()));
    METIER_TRY(opcua_skill::publishDictionary(host->nodes()));
    for (const auto& file : config.types) {
        METIER_TRY(composition::loadSkillTypes(file).and_then(
            [&](const auto& types) { return opcua_skill::declareTypes(host->nodes(), types); }));
    }
    host->control_ = std::make_shared<skill::Control>(host->skills_->executor(), host->clock_);
    host->names_ = std::move(names);
    if (host->names_ == nullptr) {
        METIER_TRY(host->keepNames(config));
    }
    return host;
}

/// A server is the same one after a restart if it has the same name, address and port.
Result<void> SkillHost::keepNames(const cell::ServerConfig& config) {
    if (config.state_folder.empty()) {
        names_ = std::make_shared<skill::ExecutionNames>();
        return {};
    }
    METIER_ASSIGN(names_, skill::ExecutionNames::open(
                              config.state_folder / fmt::format("{}-{}-{}.executions", config.name,
                                                                config.address, config.port)));
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
    options.nodeset_files = config_.nodesets;
    options.event_publishing = config_.publish_at_once ? opcua::EventPublishing::at_once
                                                       : opcua::EventPublishing::at_interval;
    options.limits = limitsOf(config_.limits);
    options.application_uri = applicationUriOf(config_);
    METIER_ASSIGN(access_, secureServer(options, identity_, clock_));
    application_uri_ = options.application_uri;
    METIER_ASSIGN(audit_, ServerAudit::open(config_, options));
    METIER_ASSIGN(server_, opcua::Server::create(std::move(options)));
    if (access_ != nullptr) {
        access_->follow(*server_);
    }
    return {};
}

/// All watchers of the Programs are removed between the end of the server's thread and the end of
/// the Programs. A hanging disk is waited for only after the Programs have stopped their device.
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

std::unique_ptr<composition::UsedSkill> SkillHost::recorded(
    std::unique_ptr<composition::UsedSkill> used, ForeignPlace place) const {
    return records_ == nullptr
               ? std::move(used)
               : server::recorded(std::move(used), records_->foreign(), std::move(place));
}

Result<void> SkillHost::start() {
    METIER_TRY(watchPrograms());
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
    METIER_TRY(skills_->publishRecords());
    const auto programs = skills_->programs();
    if (records_ != nullptr) {
        records_->record(programs, controller_, moved_);
    }
    if (!config_.metrics) {
        return {};
    }
    METIER_ASSIGN(metrics_,
                  ServerMetrics::start(
                      config_, {.server = *server_,
                                .control = *control_,
                                .programs = programs,
                                .arm = moved_.arm,
                                .gripper = gripper_,
                                .recorder = records_ == nullptr ? nullptr : &records_->recorder(),
                                .audit = audit_.get()}));
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
    METIER_TRY(opcua_skill::publishKinematics(server_->nodes(), system, data,
                                              [shown] { return stateOf(shown); }));
    METIER_TRY(opcua_skill::serveBasePlacement(*server_, system));
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
    METIER_ASSIGN(const auto name, server_->nodes().browseNameOf(controller));
    controller_ = name.name;
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
    METIER_ASSIGN(const auto nodes, server_->nodes().browse(folder));
    METIER_TRY(checkAllWanted(nodes, wanted));
    for (const auto& name : wanted) {
        const auto found = std::find_if(skills.begin(), skills.end(), [&](const auto& one) {
            return one.skill && one.skill->description().name == name;
        });
        if (found == skills.end()) {
            return fail(Errc::not_supported, fmt::format("no skill '{}' for this device", name));
        }
        const auto node = std::find_if(nodes.begin(), nodes.end(), [&](const auto& reference) {
            return reference.browse_name.name == name;
        });
        const skill::ProgramOptions options{
            .resource = found->resource, .control = control_, .names = names_};
        METIER_TRY(node == nodes.end()
                       ? skills_->publish(folder, std::move(found->skill), options)
                       : skills_->bind(node->target, std::move(found->skill), options));
    }
    return {};
}

}  // namespace metier::server
