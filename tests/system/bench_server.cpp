#include "bench_server.hpp"

#include <spdlog/logger.h>

#include <stdexcept>
#include <utility>

namespace metier::system_tests {

namespace {

constexpr const char* kNamespace = "urn:bench";

skill::Field field(std::string name, skill::ValueType type, skill::Value default_value) {
    skill::Field result;
    result.name = std::move(name);
    result.type = type;
    result.default_value = std::move(default_value);
    return result;
}

}  // namespace

BenchServer::BenchServer(BenchOptions options) : options_(std::move(options)) {
    opcua::ServerOptions server_options;
    server_options.application_name = options_.application_name;
    server_options.port = options_.port;
    server_options.limits = options_.limits;
    server_options.application_uri = options_.application_uri;
    server_options.security = options_.security;
    server_options.nodesets = {"device", "robotics", "metier"};
    server_options.namespaces = {kNamespace};
    server_options.logger = std::make_shared<spdlog::logger>("quiet");
    server_ = orThrow(opcua::Server::create(server_options));
    const Clock& clock = options_.clock == nullptr ? system_clock_ : *options_.clock;
    skills_ = orThrow(opcua_skill::SkillServer::create(
        *server_, clock, server_options.logger,
        options_.executor ? options_.executor(*server_) : nullptr));
    control_ = std::make_shared<skill::Control>(skills_->executor(), clock);
    auto& nodes = server_->nodes();
    system_ = orThrow(
        opcua_skill::publishMotionDeviceSystem(nodes, {"Bench",
                                                       "Nothing that moves.",
                                                       "metier",
                                                       "bench",
                                                       {"A1", "A2"},
                                                       orThrow(nodes.namespaceIndex(kNamespace))}));
    orThrow(skills_->serveControl(system_.controller, control_));
}

BenchServer::~BenchServer() = default;

skill::Program& BenchServer::addSkill(skill::SkillDescription description,
                                      skill::SkillFunctions functions,
                                      skill::ProgramOptions options) {
    options.control = control_;
    options.names = options_.names;
    return *orThrow(skills_->publish(
        system_.skills,
        std::make_unique<skill::LambdaSkill>(std::move(description), std::move(functions)),
        std::move(options)));
}

void BenchServer::serve() {
    orThrow(server_->start());
}

opcua::NodeId BenchServer::node(std::string_view skill, std::string_view path) const {
    std::string id = std::get<std::string>(system_.skills.identifier());
    id.append("/").append(skill);
    if (!path.empty()) {
        id.append("/").append(path);
    }
    return {system_.skills.namespaceIndex(), id};
}

opcua::NodeId BenchServer::controllerNode(std::string_view uri, std::vector<std::string> path) {
    const auto index = orThrow(server_->nodes().namespaceIndex(uri));
    opcua::BrowsePath names;
    for (auto& name : path) {
        names.push_back({index, std::move(name)});
    }
    return orThrow(server_->nodes().find(system_.controller, names));
}

std::unique_ptr<opcua::Client> connectAs(const std::string& url, const std::string& name) {
    opcua::ClientOptions options;
    options.application_name = name;
    options.session_timeout = std::chrono::hours(24);
    // Nothing here is about time: a machine that is busy with other tests may take its own.
    options.connect_timeout = std::chrono::minutes(2);
    options.call_timeout = std::chrono::minutes(2);
    return orThrow(opcua::Client::connect(url, options));
}

skill::SkillDescription benchDescription(std::string name) {
    skill::SkillDescription description;
    description.name = std::move(name);
    description.type = "JointPtpMoveSkillType";
    description.on_owner_loss = skill::OwnerLossAction::halt;
    auto target = field("TargetJointPosition", skill::ValueType::numbers, {});
    target.unit = skill::kRadian;
    target.range = skill::Range{-100, 100};
    target.length = skill::LengthLimit{2, 2};
    auto velocity = field("MaxVelocity", skill::ValueType::numbers, std::vector{0.0, 0.0});
    velocity.unit = skill::kRadianPerSecond;
    auto speed = field("SpeedOverride", skill::ValueType::number, 0.5);
    speed.range = skill::Range{0, 1};
    speed.place = skill::Place::options;
    description.parameters = {target, velocity,
                              field("ToolFrame", skill::ValueType::text, std::string()), speed};
    auto duration = field("Duration", skill::ValueType::number, {});
    duration.unit = skill::kSecond;
    auto reached = field("ReachedJointPosition", skill::ValueType::numbers, {});
    reached.unit = skill::kRadian;
    for (auto* result : {&duration, &reached}) {
        result->place = skill::Place::final_result;
    }
    description.results = {duration, reached};
    return description;
}

}  // namespace metier::system_tests
