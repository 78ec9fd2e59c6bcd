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
#include "wiring.hpp"

namespace metier::opcua_skill {

namespace {

constexpr std::chrono::milliseconds kLookForRest{5};

}  // namespace

class SkillServer::State {
public:
    State(opcua::Server& server, const Clock& clock, SkillContext context,
          std::shared_ptr<skill::Executor> executor)
        : server_(server),
          clock_(clock),
          server_executor_(std::make_shared<ServerExecutor>(server)),
          executor_(executor ? std::move(executor) : server_executor_),
          context_(std::move(context)),
          factory_(server.nodes(), context_.ids) {
        server.onSessionClosed([this](const opcua::Session& session) { sessionClosed(session); });
    }

    ~State() {
        server_.stop();
        server_executor_->close();
        // A skill may use those before it.
        while (!skills_.empty()) {
            skills_.pop_back();
        }
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    std::shared_ptr<skill::Executor> executor() const { return executor_; }

    Result<skill::Program*> bind(const opcua::NodeId& skill_object,
                                 std::unique_ptr<skill::Skill> skill,
                                 skill::ProgramOptions options) {
        if (bound_.contains(skill_object)) {
            return fail(Errc::already_exists, skill_object.toString() + " has a skill already");
        }
        auto& nodes = server_.nodes();
        METIER_ASSIGN(auto instance, wireExisting(nodes, skill_object, skill->description()));
        METIER_TRY(nodes.setEventNotifier(skill_object, opcua::EventNotifier::subscribable));
        return serve(instance, std::move(skill), std::move(options));
    }

    Result<skill::Program*> publish(const opcua::NodeId& skills,
                                    std::unique_ptr<skill::Skill> skill,
                                    skill::ProgramOptions options, NodeStyle style) {
        METIER_ASSIGN(auto instance, factory_.make(skills, skill->description(), style));
        return serve(instance, std::move(skill), std::move(options));
    }

    Result<void> serveControl(const opcua::NodeId& controller,
                              std::shared_ptr<skill::Control> control) {
        controls_.push_back(
            std::make_unique<ControlNode>(std::move(control), server_, context_.log));
        return controls_.back()->bind(server_.nodes(), controller);
    }

    Result<void> publishRecords() {
        for (const auto& skill : skills_) {
            METIER_TRY(publishExecutionRecords(server_.nodes(), skill->id(), skill->program()));
        }
        return {};
    }

    std::vector<skill::Program*> programs() const {
        std::vector<skill::Program*> programs;
        for (const auto& skill : skills_) {
            programs.push_back(&skill->program());
        }
        return programs;
    }

    bool comeToRest(const std::string& why, std::chrono::milliseconds longest) {
        const auto deadline = std::chrono::steady_clock::now() + longest;
        while (std::chrono::steady_clock::now() < deadline) {
            const auto rests = server_.call([this, why] { return brakeAll(why); }, longest);
            if (!rests || *rests) {
                return rests.has_value();
            }
            std::this_thread::sleep_for(kLookForRest);
        }
        return false;
    }

private:
    /// \return whether all rest
    bool brakeAll(const std::string& why) {
        bool rests = true;
        for (auto* program : programs()) {
            program->deviceStopped(why);
            rests = rests && program->state() != skill::State::running;
        }
        return rests;
    }

    Result<skill::Program*> serve(const SkillInstance& instance,
                                  std::unique_ptr<skill::Skill> skill,
                                  skill::ProgramOptions options) {
        auto program = std::make_unique<skill::Program>(std::move(options), std::move(skill),
                                                        executor_, clock_);
        // Kept even if a node refuses, since others lead to it by then.
        skills_.push_back(std::make_unique<SkillNode>(instance.id, std::move(program), context_));
        auto& node = *skills_.back();
        bound_.insert(instance.id);
        auto bound = node.bind(server_.nodes(), instance.nodes);
        if (bound && !node.program().description().suspendable) {
            bound = tellNotSuspendable(instance.id);
        }
        if (!bound) {
            return fail(std::move(bound.error()));
        }
        return &node.program();
    }

    /// Its Suspend is there all the same, since every Program has one, and refuses.
    Result<void> tellNotSuspendable(const opcua::NodeId& skill) {
        auto& nodes = server_.nodes();
        METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
        opcua::VariableSpec spec;
        spec.node.parent = skill;
        spec.node.reference = opcua::ids::kHasProperty;
        spec.node.browse_name = {metier, "Suspendable"};
        spec.node.description = {"en", "False: Suspend is refused, whatever the skill is doing."};
        spec.type = opcua::ids::kPropertyType;
        spec.data_type = opcua::ids::kBoolean;
        spec.value = opcua::Value::of(false);
        const auto added = nodes.addVariable(spec);
        return added ? Result<void>() : fail(added.error());
    }

    void sessionClosed(const opcua::Session& session) {
        context_.refusals.sessionClosed(session);
        for (const auto& control : controls_) {
            control->sessionClosed(session);
        }
        for (const auto& skill : skills_) {
            skill->sessionClosed(session);
        }
    }

    opcua::Server& server_;
    const Clock& clock_;
    // Shared with the Executions, which may outlive the Programs.
    std::shared_ptr<ServerExecutor> server_executor_;
    std::shared_ptr<skill::Executor> executor_;
    SkillContext context_;
    SkillFactory factory_;
    std::vector<std::unique_ptr<SkillNode>> skills_;
    std::set<opcua::NodeId> bound_;
    std::vector<std::unique_ptr<ControlNode>> controls_;
};

Result<std::unique_ptr<SkillServer>> SkillServer::create(
    opcua::Server& server, const Clock& clock, std::shared_ptr<spdlog::logger> logger,
    std::shared_ptr<skill::Executor> executor) {
    METIER_ASSIGN(auto ids, ModelIds::of(server.nodes()));
    METIER_ASSIGN(auto emitter, opcua::EventEmitter::create(server, ids.transition_event_type,
                                                            transitionFields(ids)));
    METIER_ASSIGN(auto stopping, opcua::EventEmitter::create(
                                     server, opcua::NodeId(ids.metier, kStoppingEventTypeId),
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
    return state_->executor();
}

Result<skill::Program*> SkillServer::bind(const opcua::NodeId& skill_object,
                                          std::unique_ptr<skill::Skill> skill,
                                          skill::ProgramOptions options) {
    return state_->bind(skill_object, std::move(skill), std::move(options));
}

Result<skill::Program*> SkillServer::publish(const opcua::NodeId& skills,
                                             std::unique_ptr<skill::Skill> skill,
                                             skill::ProgramOptions options, NodeStyle style) {
    return state_->publish(skills, std::move(skill), std::move(options), style);
}

Result<void> SkillServer::serveControl(const opcua::NodeId& controller,
                                       std::shared_ptr<skill::Control> control) {
    return state_->serveControl(controller, std::move(control));
}

Result<void> SkillServer::publishRecords() {
    return state_->publishRecords();
}

bool SkillServer::comeToRest(const std::string& why, std::chrono::milliseconds longest) {
    return state_->comeToRest(why, longest);
}

std::vector<skill::Program*> SkillServer::programs() const {
    return state_->programs();
}

}  // namespace metier::opcua_skill
