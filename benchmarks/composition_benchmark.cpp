// Cost of composition, over OPC UA on loopback; every server has a thread of its own, in one
// process.
//
// - per child step: a composed skill of 100 steps that run a skill of another server which does
//   nothing, its time by 100, beside the same client running that skill directly (StartWith, event,
//   GetExecution), in turns. Goal: at most 1 ms more (p50).
// - three levels: 2 x 5 x 10 steps that do nothing, three composed skills on three servers above
//   the one that does nothing. Goal: 0.5 s.
// - per step of a foreign skill, a Program without anything that metier adds: a composed skill of
//   100 steps, its time by 100, beside open62541 alone that writes the parameter,
//   calls Start and reads the result, in turns; it need not wait for the end. Goal: at most 0.3 ms
//   more (p50).
//
// composition_benchmark [ROUNDS]
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "bare.hpp"
#include "metier/base/queue.hpp"
#include "metier/client/remote_server.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/composition/definition_file.hpp"
#include "metier/composition/sequence_skill.hpp"
#include "metier/opcua/event_emitter.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/skill/lambda_skill.hpp"

namespace metier::benchmarks {
namespace {

using std::chrono::steady_clock;

template <typename Answer>
auto orThrow(Answer answer) {
    if (!answer) {
        throw std::runtime_error(answer.error().message);
    }
    if constexpr (!std::is_void_v<typename Answer::value_type>) {
        return std::move(*answer);
    }
}

/// A server with one skill.
class OneSkillServer {
public:
    explicit OneSkillServer(const std::string& name) : name_(name) {
        skills_ = orThrow(opcua_skill::SkillServer::create(*server_, clock_));
        place_ = orThrow(
            opcua_skill::publishSkillController(server_->nodes(), name, "Of the benchmark."));
    }

    void serve(std::unique_ptr<skill::Skill> skill) {
        orThrow(skills_->publish(place_.skills, std::move(skill)));
        orThrow(server_->start());
    }
    /// A composed skill whose only used skill is that of the server at `below`.
    void serveAbove(const std::string& below, const std::string& text) {
        below_ = orThrow(
            client::RemoteServer::connect({.url = below, .name = "below"}, skills_->executor()));
        auto child = orThrow(below_->use(orThrow(below_->skills()).front(), name_));
        auto composed = orThrow(composition::compose(
            orThrow(composition::parseDefinition(text, name_)), {{"inner", child->description()}}));
        std::map<std::string, std::unique_ptr<composition::UsedSkill>> children;
        children.emplace("inner", std::move(child));
        serve(std::make_unique<composition::SequenceSkill>(
            std::move(composed), std::move(children),
            composition::SequenceSkill::Host{skills_->executor(), clock_, name_}));
    }
    std::string url() const { return server_->endpointUrl(); }

private:
    static opcua::ServerOptions serverOptions() {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier"};
        return options;
    }

    std::string name_;
    SystemClock clock_;
    std::unique_ptr<opcua::Server> server_ = orThrow(opcua::Server::create(serverOptions()));
    std::unique_ptr<client::RemoteServer> below_;
    std::unique_ptr<opcua_skill::SkillServer> skills_;  // ends before what it uses
    opcua_skill::SkillController place_;
};

/// A skill that is done as soon as it has begun.
std::unique_ptr<skill::Skill> idleSkill() {
    skill::SkillFunctions functions;
    functions.start = [](const skill::ValueMap&, const skill::ExecutionHandle& execution) {
        execution.finish({{"Number", 1.0}});
    };
    return std::make_unique<skill::LambdaSkill>(
        skill::SkillDescription{.name = "IdleSkill",
                                .type = "IdleSkillType",
                                .results = {{.name = "Number",
                                             .type = skill::ValueType::number,
                                             .place = skill::Place::final_result}},
                                .steps = {"nothing"}},
        std::move(functions));
}

/// A server of another maker: a Program with a parameter and a result, done as soon as it has
/// begun.
class ForeignServer {
public:
    ForeignServer() {
        const auto parameters = object("ParameterSet");
        const auto level =
            variable(parameters, {1, "Level"}, opcua::Value::of(0.0), opcua::Access::read_write);
        const auto reached = variable(object("FinalResultData"), {1, "Reached"},
                                      opcua::Value::of(0.0), opcua::Access::read);
        const auto state =
            variable(program_, {0, "CurrentState"},
                     opcua::Value::of(opcua::LocalizedText{"", "Ready"}), opcua::Access::read);
        const auto state_id =
            variable(state, {0, "Id"}, opcua::Value::of(kReady), opcua::Access::read);
        orThrow(nodes().addMethod(
            {.node = {{}, program_, opcua::ids::kHasComponent, {0, "Start"}},
             .handler = [this, level, reached, state_id](
                            const auto&, auto) -> Result<std::vector<opcua::Value>> {
                 METIER_TRY(nodes().write(state_id, opcua::Value::of(kRunning)));
                 METIER_TRY(raise());
                 METIER_ASSIGN(const auto wanted, nodes().read(level));
                 METIER_TRY(nodes().write(reached, wanted.value));
                 METIER_TRY(nodes().write(state_id, opcua::Value::of(kReady)));
                 METIER_TRY(raise());
                 return std::vector<opcua::Value>{};
             }}));
        orThrow(server_->start());
    }

    std::string url() const { return server_->endpointUrl(); }

private:
    // Ids of the states of Programs (OPC 10000-10).
    static inline const opcua::NodeId kReady{0, 2400U};
    static inline const opcua::NodeId kRunning{0, 2402U};

    static opcua::ServerOptions options() {
        opcua::ServerOptions options;
        options.port = 0;
        return options;
    }
    opcua::AddressSpace& nodes() { return server_->nodes(); }
    opcua::NodeId object(const std::string& name) {
        return orThrow(
            nodes().addObject({.node = {{}, program_, opcua::ids::kHasComponent, {1, name}}}));
    }
    opcua::NodeId variable(const opcua::NodeId& parent, const opcua::QualifiedName& name,
                           const opcua::Value& value, opcua::Access access) {
        return orThrow(nodes().addVariable({.node = {{}, parent, opcua::ids::kHasComponent, name},
                                            .value = value,
                                            .access = access}));
    }
    Result<> raise() {
        METIER_TRY(emitter_.emit({.source = program_,
                                  .source_name = "Weld",
                                  .time = std::chrono::system_clock::now(),
                                  .severity = 100,
                                  .message = {"", "Weld"},
                                  .fields = {}}));
        return {};
    }

    std::unique_ptr<opcua::Server> server_ = orThrow(opcua::Server::create(options()));
    opcua::NodeId program_ = orThrow(nodes().addObject(
        {.node = {{}, opcua::ids::kObjectsFolder, opcua::ids::kOrganizes, {1, "Weld"}},
         .type = opcua::ids::kProgramStateMachineType,
         .event_notifier = opcua::EventNotifier::subscribable,
         .children = opcua::Children::none}));
    opcua::EventEmitter emitter_ =
        orThrow(opcua::EventEmitter::create(*server_, opcua::ids::kProgramTransitionEventType, {}));
};

/// The same skill as a client of open62541 alone runs it.
class BareRunner {
public:
    explicit BareRunner(const std::string& url) : client_(url) {}

    /// [ms]
    double run() {
        const auto begin = steady_clock::now();
        client_.write("ns=1;s=Weld.ParameterSet.Level", kLevel);
        client_.call("ns=1;s=Weld", "ns=1;s=Weld.Start");
        if (client_.read("ns=1;s=Weld.FinalResultData.Reached") != kLevel) {
            throw std::runtime_error("another result than the level");
        }
        return std::chrono::duration<double, std::milli>(steady_clock::now() - begin).count();
    }

private:
    static constexpr double kLevel = 0.5;

    opcua::bare::Client client_;
};

std::string repeated(const std::string& name, const std::string& inner, int times) {
    return fmt::format(
        "name = \"{}\"\n[results.Number]\ntype = \"number\"\nfrom = \"go.Number\"\n"
        "[uses.inner]\ntype = \"{}\"\n[[step]]\nname = \"all\"\ntimes = {}\n[[step.repeat]]\n"
        "name = \"go\"\nrun = \"inner\"\n",
        name, inner, times);
}

constexpr const char* kHundredWelds = R"(
name = "WeldsSkill"
[results.Number]
type = "number"
from = "go.Reached"
[uses.inner]
type = "WeldType"
[[step]]
name = "all"
times = 100
[[step.repeat]]
name = "go"
run = "inner"
with.Level = 0.5
)";

/// A skill as a client runs it; one that waits as little as possible.
class Runner {
public:
    explicit Runner(const std::string& url)
        : client_(orThrow(opcua::Client::connect(url))),
          skill_(orThrow(client::SkillHandle::open(
              *client_, orThrow(client::findSkills(*client_)).front()))) {}

    /// [ms]
    double run() {
        const auto begin = steady_clock::now();
        orThrow(skill_.runWith({.execution_id = fmt::format("{}", ++count_)},
                               begin + std::chrono::seconds(60)));
        return std::chrono::duration<double, std::milli>(steady_clock::now() - begin).count();
    }

private:
    std::unique_ptr<opcua::Client> client_;
    client::SkillHandle skill_;
    std::uint64_t count_ = 0;
};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

void run(int rounds) {
    OneSkillServer idle("idle");
    idle.serve(idleSkill());
    OneSkillServer hundred("hundred");
    hundred.serveAbove(idle.url(), repeated("HundredSkill", "IdleSkillType", 100));
    OneSkillServer inner("inner");
    inner.serveAbove(idle.url(), repeated("InnerSkill", "IdleSkillType", 10));
    OneSkillServer middle("middle");
    middle.serveAbove(inner.url(), repeated("MiddleSkill", "InnerSkillType", 5));
    OneSkillServer outer("outer");
    outer.serveAbove(middle.url(), repeated("OuterSkill", "MiddleSkillType", 2));

    const ForeignServer foreign;
    OneSkillServer welds("welds");
    welds.serveAbove(foreign.url(), kHundredWelds);

    Runner direct(idle.url());
    Runner composed(hundred.url());
    Runner stacked(outer.url());
    BareRunner bare(foreign.url());
    Runner welding(welds.url());
    std::vector<double> alone;
    std::vector<double> step;
    std::vector<double> whole;
    std::vector<double> bare_runs;
    std::vector<double> weld;
    for (int round = 0; round < rounds; ++round) {
        for (int i = 0; i < 100; ++i) {
            alone.push_back(direct.run());
            bare_runs.push_back(bare.run());
        }
        weld.push_back(welding.run() / 100);
        step.push_back(composed.run() / 100);
        whole.push_back(stacked.run());
    }
    fmt::print("{} rounds, p50:\n", rounds);
    fmt::print("a skill run directly             {:8.3f} ms\n", median(alone));
    fmt::print("a step of a composed skill       {:8.3f} ms\n", median(step));
    fmt::print("composing costs, of 1 ms         {:8.3f} ms\n", median(step) - median(alone));
    fmt::print("a foreign skill, open62541 alone {:8.3f} ms\n", median(bare_runs));
    fmt::print("a step of a foreign skill        {:8.3f} ms\n", median(weld));
    fmt::print("the adapter costs, of 0.3 ms     {:8.3f} ms, {:.2f} times\n",
               median(weld) - median(bare_runs), median(weld) / median(bare_runs));
    fmt::print("three levels, 100 steps, of 500 ms {:6.1f} ms\n", median(whole));
}

}  // namespace
}  // namespace metier::benchmarks

int main(int argc, char** argv) {
    constexpr int kRounds = 20;
    spdlog::set_level(spdlog::level::err);
    try {
        metier::benchmarks::run(argc > 1 ? std::stoi(argv[1]) : kRounds);
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "composition_benchmark: {}\n", error.what());
        return 1;
    }
}
