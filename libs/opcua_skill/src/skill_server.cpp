#include "metier/opcua_skill/skill_server.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <set>
#include <thread>
#include <utility>

#include "control_node.hpp"
#include "execution_records.hpp"
#include "metier/opcua_skill/server_executor.hpp"
#include "model_ids.hpp"
#include "skill_factory.hpp"
#include "skill_node.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::NodeId;

constexpr std::chrono::milliseconds kLookForRest{5};

}  // namespace

struct SkillServer::State {
    State(opcua::Server& its_server, const Clock& its_clock, SkillContext its_context,
          std::shared_ptr<skill::Executor> given_executor)
        : server(its_server),
          clock(its_clock),
          server_executor(std::make_shared<ServerExecutor>(its_server)),
          executor(given_executor ? std::move(given_executor) : server_executor),
          context(std::move(its_context)),
          factory(its_server.nodes(), context.ids) {
        server.onSessionClosed([this](const opcua::Session& session) { sessionClosed(session); });
    }

    ~State() {
        server.stop();
        server_executor->close();
        // A skill may use those before it.
        while (!skills.empty()) {
            skills.pop_back();
        }
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    Result<skill::Program*> serve(const SkillInstance& instance,
                                  std::unique_ptr<skill::Skill> skill,
                                  skill::ProgramOptions options) {
        auto program =
            std::make_unique<skill::Program>(std::move(options), std::move(skill), executor, clock);
        // Kept even if a node refuses, since others lead to it by then.
        skills.push_back(std::make_unique<SkillNode>(instance.id, std::move(program), context));
        auto& node = *skills.back();
        bound.insert(instance.id);
        METIER_TRY(node.bind(server.nodes(), instance.nodes));
        if (!node.program().description().suspendable) {
            METIER_TRY(tellNotSuspendable(instance.id));
        }
        return &node.program();
    }

    /// Its Suspend is there all the same, since every Program has one, and refuses.
    Result<NodeId> tellNotSuspendable(const NodeId& skill) {
        METIER_ASSIGN(const auto metier, server.nodes().namespaceIndex(kMetierUri));
        return server.nodes().addVariable(
            {.node = {.parent = skill,
                      .reference = opcua::ids::kHasProperty,
                      .browse_name = {metier, "Suspendable"},
                      .description = {"en",
                                      "False: Suspend is refused, whatever the skill is doing."}},
             .type = opcua::ids::kPropertyType,
             .data_type = opcua::ids::kBoolean,
             .value = opcua::Value::of(false)});
    }

    /// \return whether all rest
    bool brakeAll(const std::string& why) {
        bool rests = true;
        for (const auto& skill : skills) {
            auto& program = skill->program();
            program.deviceStopped(why);
            rests = rests && program.state() != skill::State::running;
        }
        return rests;
    }

    void sessionClosed(const opcua::Session& session) {
        context.refusals.sessionClosed(session);
        for (const auto& control : controls) {
            control->sessionClosed(session);
        }
        for (const auto& skill : skills) {
            skill->sessionClosed(session);
        }
    }

    opcua::Server& server;
    const Clock& clock;
    // Shared with the Executions, which may outlive the Programs.
    std::shared_ptr<ServerExecutor> server_executor;
    std::shared_ptr<skill::Executor> executor;
    SkillContext context;
    SkillFactory factory;
    std::vector<std::unique_ptr<SkillNode>> skills;
    std::set<NodeId> bound;
    std::vector<std::unique_ptr<ControlNode>> controls;
};

Result<std::unique_ptr<SkillServer>> SkillServer::create(
    opcua::Server& server, const Clock& clock, std::shared_ptr<spdlog::logger> logger,
    std::shared_ptr<skill::Executor> executor) {
    METIER_ASSIGN(auto ids, ModelIds::of(server.nodes()));
    METIER_ASSIGN(auto emitter, opcua::EventEmitter::create(server, ids.transition_event_type,
                                                            transitionFields(ids)));
    METIER_ASSIGN(auto stopping,
                  opcua::EventEmitter::create(server, NodeId(ids.metier, kStoppingEventTypeId),
                                              stoppingFields(ids)));
    SkillContext context{std::move(ids),
                         std::move(emitter),
                         std::move(stopping),
                         {},
                         server,
                         logger ? std::move(logger) : spdlog::default_logger()};
    return std::unique_ptr<SkillServer>(new SkillServer(
        std::make_unique<State>(server, clock, std::move(context), std::move(executor))));
}

SkillServer::SkillServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

SkillServer::~SkillServer() = default;

std::shared_ptr<skill::Executor> SkillServer::executor() const {
    return state_->executor;
}

Result<skill::Program*> SkillServer::bind(const NodeId& skill_object,
                                          std::unique_ptr<skill::Skill> skill,
                                          skill::ProgramOptions options) {
    if (state_->bound.contains(skill_object)) {
        return fail(Errc::already_exists, skill_object.toString() + " has a skill already");
    }
    auto& nodes = state_->server.nodes();
    METIER_ASSIGN(auto instance, wireExisting(nodes, skill_object, skill->description()));
    METIER_TRY(nodes.setEventNotifier(skill_object, opcua::EventNotifier::subscribable));
    return state_->serve(instance, std::move(skill), std::move(options));
}

Result<skill::Program*> SkillServer::publish(const NodeId& skills,
                                             std::unique_ptr<skill::Skill> skill,
                                             skill::ProgramOptions options, NodeStyle style) {
    METIER_ASSIGN(auto instance, state_->factory.make(skills, skill->description(), style));
    return state_->serve(instance, std::move(skill), std::move(options));
}

Result<void> SkillServer::serveControl(const NodeId& controller,
                                       std::shared_ptr<skill::Control> control) {
    auto& server = state_->server;
    auto& node = state_->controls.emplace_back(
        std::make_unique<ControlNode>(std::move(control), server, state_->context.log));
    return node->bind(server.nodes(), controller);
}

Result<void> SkillServer::publishRecords() {
    for (const auto& skill : state_->skills) {
        METIER_TRY(publishExecutionRecords(state_->server.nodes(), skill->id(), skill->program()));
    }
    return {};
}

bool SkillServer::comeToRest(const std::string& why, std::chrono::milliseconds longest) {
    const auto deadline = std::chrono::steady_clock::now() + longest;
    while (std::chrono::steady_clock::now() < deadline) {
        const auto rests = state_->server.call(
            [state = state_.get(), why] { return state->brakeAll(why); }, longest);
        if (!rests || *rests) {
            return rests.has_value();
        }
        std::this_thread::sleep_for(kLookForRest);
    }
    return false;
}

std::vector<skill::Program*> SkillServer::programs() const {
    std::vector<skill::Program*> programs;
    for (const auto& skill : state_->skills) {
        programs.push_back(&skill->program());
    }
    return programs;
}

}  // namespace metier::opcua_skill
