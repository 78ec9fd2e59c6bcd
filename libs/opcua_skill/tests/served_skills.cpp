#include "served_skills.hpp"

#include <atomic>
#include <chrono>
#include <utility>

namespace metier::opcua_skill::testing {

namespace {

constexpr std::chrono::seconds kPatience{30};

std::vector<std::vector<opcua::QualifiedName>> watchedFields(std::uint16_t device) {
    std::vector<std::vector<opcua::QualifiedName>> fields;
    for (const char* name :
         {"EventType", "SourceNode", "SourceName", "Time", "Message", "Severity"}) {
        fields.push_back({{0, name}});
    }
    for (const char* name : {"FromState", "ToState", "Transition"}) {
        fields.push_back({{0, name}});
        fields.push_back({{0, name}, {0, "Id"}});
        fields.push_back({{0, name}, {0, "Number"}});
    }
    fields.push_back({{0, "Transition"}, {0, "TransitionTime"}});
    fields.push_back({{0, "IntermediateResult"}});
    for (const char* name : {"ExecutionId", "Reason", "ReasonText"}) {
        fields.push_back({{device, name}});
    }
    return fields;
}

/// Takes the fields of one event in their order.
class FieldReader {
public:
    explicit FieldReader(const std::vector<opcua::Value>& fields) : fields_(fields) {}
    template <typename T>
    T take() {
        return fields_[next_++].as<T>().value_or(T{});
    }
    std::string text() { return take<opcua::LocalizedText>().text; }
    opcua::Value any() { return fields_[next_++]; }

private:
    const std::vector<opcua::Value>& fields_;
    std::size_t next_ = 0;
};

TransitionWatch::Seen seenFrom(const std::vector<opcua::Value>& values) {
    FieldReader fields(values);
    TransitionWatch::Seen seen;
    seen.event_type = fields.take<opcua::NodeId>();
    seen.source = fields.take<opcua::NodeId>();
    seen.source_name = fields.take<std::string>();
    seen.time = fields.take<UtcTime>();
    seen.message = fields.text();
    seen.severity = fields.take<std::uint16_t>();
    seen.from = fields.text();
    seen.from_id = fields.take<opcua::NodeId>();
    seen.from_number = fields.take<std::uint32_t>();
    seen.to = fields.text();
    seen.to_id = fields.take<opcua::NodeId>();
    seen.to_number = fields.take<std::uint32_t>();
    seen.transition = fields.text();
    seen.transition_id = fields.take<opcua::NodeId>();
    seen.transition_number = fields.take<std::uint32_t>();
    seen.transition_time = fields.take<UtcTime>();
    seen.intermediate_result = fields.any();
    seen.execution_id = fields.take<std::string>();
    seen.reason = fields.take<std::int32_t>();
    seen.reason_text = fields.take<std::string>();
    return seen;
}

/// A logger that writes nowhere.
std::shared_ptr<spdlog::logger> quiet() {
    return std::make_shared<spdlog::logger>("quiet");
}

}  // namespace

TransitionWatch::TransitionWatch(opcua::Client& client, const opcua::NodeId& notifier) {
    const auto device = client.namespaceIndex("https://fortiss.org/UA/Device/");
    EXPECT_TRUE(device);
    opcua::EventFilter filter;
    filter.fields = watchedFields(device.value_or(0));
    filter.of_type =
        opcua::ids::kProgramTransitionEventType;  // the Server raises audit events, too
    auto subscription = client.subscribeEvents(
        notifier, std::move(filter), [this, seen = seen_](const opcua::EventNotice& notice) {
            if (notice.kind == opcua::EventNotice::Kind::event) {
                seen->tryPush(seenFrom(notice.fields));
            } else if (notice.kind == opcua::EventNotice::Kind::overflow) {
                ++overflows_;
            }
        });
    EXPECT_TRUE(subscription) << subscription.error().message;
    if (subscription) {
        subscription_ = std::move(*subscription);
    }
}

std::optional<TransitionWatch::Seen> TransitionWatch::next() {
    return seen_->popUntil(std::chrono::steady_clock::now() + kPatience);
}

std::string TransitionWatch::nextName() {
    const auto seen = next();
    return seen ? seen->transition : "nothing";
}

opcua::NodeId ServedSkill::node(std::string_view path) const {
    return {id.namespaceIndex(), std::get<std::string>(id.identifier()) + "/" + std::string(path)};
}

ServedSkills::ServedSkills() {
    opcua::ServerOptions options;
    options.port = 0;
    options.nodesets = {"device", "robotics", "metier"};
    options.namespaces = {"urn:test"};
    options.logger = quiet();
    auto server = opcua::Server::create(options);
    if (!server) {
        throw std::runtime_error(server.error().message);
    }
    server_ = std::move(*server);
    auto skills = SkillServer::create(*server_, clock_, quiet());
    if (!skills) {
        throw std::runtime_error(skills.error().message);
    }
    skills_ = std::move(*skills);
    auto& nodes = server_->nodes();
    MotionDeviceSystemSpec spec{"Test",       "An arm of the test.",
                                "metier",     "two axes",
                                {"A1", "A2"}, *nodes.namespaceIndex("urn:test")};
    auto system = publishMotionDeviceSystem(nodes, spec);
    if (!system) {
        throw std::runtime_error(system.error().message);
    }
    system_ = std::move(*system);
}

ServedSkill ServedSkills::add(skill::SkillDescription description, skill::ProgramOptions options) {
    ServedSkill served;
    served.hand = std::make_shared<Hand>();
    const std::string name = description.name;
    auto program = skills_->publish(
        system_.skills, std::make_unique<HandDrivenSkill>(std::move(description), served.hand),
        std::move(options));
    if (!program) {
        throw std::runtime_error(program.error().message);
    }
    served.program = *program;
    served.id = opcua::NodeId(system_.skills.namespaceIndex(),
                              std::get<std::string>(system_.skills.identifier()) + "/" + name);
    return served;
}

void ServedSkills::serve() {
    if (auto started = server_->start(); !started) {
        throw std::runtime_error(started.error().message);
    }
}

void ServedSkills::shutDown() {
    skills_.reset();
    server_.reset();
}

std::unique_ptr<opcua::Client> ServedSkills::connect(const std::string& name) {
    opcua::ClientOptions options;
    options.application_name = name;
    auto client = opcua::Client::connect(server_->endpointUrl(), options);
    if (!client) {
        throw std::runtime_error(client.error().message);
    }
    return std::move(*client);
}

std::string call(opcua::Client& client, const ServedSkill& skill, std::string_view method) {
    const auto answer = client.call(skill.id, skill.node(method));
    return answer ? answer->status.name() : answer.error().status.name();
}

std::string write(opcua::Client& client, const ServedSkill& skill, std::string_view path,
                  const opcua::Value& value) {
    const auto answer = client.write(skill.node(path), value);
    return answer ? "Good" : answer.error().status.name();
}

std::string read(opcua::Client& client, const ServedSkill& skill, std::string_view path) {
    const auto answer = client.read(skill.node(path));
    return answer ? answer->toString() : answer.error().status.name();
}

}  // namespace metier::opcua_skill::testing
