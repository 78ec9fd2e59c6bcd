#include <fmt/format.h>
#include <spdlog/logger.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "bare.hpp"
#include "both_sides.hpp"
#include "metier/base/queue.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/records/program_recorder.hpp"
#include "metier/records/recorder.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "recording_switch.hpp"

namespace metier::benchmarks {
namespace {

using std::chrono::steady_clock;

constexpr const char* kStarted = "StartedSkill";
constexpr std::chrono::seconds kPatience{5};

template <typename Answer>
auto orThrow(Answer answer) {
    if (!answer) {
        throw std::runtime_error(answer.error().message);
    }
    return std::move(*answer);
}

skill::Field field(const char* name, skill::Unit unit, skill::Value default_value) {
    skill::Field result;
    result.name = name;
    result.type = skill::typeOf(default_value);
    result.unit = unit;
    result.default_value = std::move(default_value);
    return result;
}

skill::Fields moveParameters() {
    const std::vector<double> zeros(6);
    std::vector<skill::Field> fields{
        field("TargetJointPosition", skill::kRadian, zeros),
        field("MaxVelocity", skill::kRadianPerSecond, zeros),
        field("MaxAcceleration", skill::kRadianPerSecondSquared, zeros),
        field("ToolFrame", skill::kOne, std::string()),
        field("SpeedOverride", skill::kOne, 1.0),
        field("BlendRadius", skill::kMetre, 0.0)};
    fields[4].place = skill::Place::options;
    fields[5].place = skill::Place::options;
    return fields;
}

/// A move with six parameters, with all that the model asks of a skill, and no work to do.
skill::SkillDescription moveDescription(std::string name) {
    static const auto kParameters = moveParameters();
    skill::SkillDescription description;
    description.name = std::move(name);
    description.type = "JointPtpMoveSkillType";
    description.parameters = kParameters;
    return description;
}

/// An OPC UA server with skills that end as soon as they are started.
class SkillServers {
public:
    /// \param recording of executions; null: none
    /// \param work time that an execution keeps the server's thread busy
    SkillServers(std::size_t idle, opcua_skill::NodeStyle style,
                 const RecordingSwitch* recording = nullptr, std::chrono::microseconds work = {})
        : work_(work) {
        auto& nodes = server_->nodes();
        const auto index = orThrow(nodes.namespaceIndex("urn:benchmark"));
        const auto system = orThrow(opcua_skill::publishMotionDeviceSystem(
            nodes, {"Benchmark", "", "metier", "benchmark", {"A1"}, index}));
        publish(system.skills, kStarted, style);
        for (std::size_t i = 0; i < idle; ++i) {
            publish(system.skills, fmt::format("JointPtpMoveSkill{}", i), style);
        }
        if (recording != nullptr) {
            recorder_ = orThrow(
                records::Recorder::create({.url = recording->file(), .server = "urn:benchmark"}));
        }
        orThrow(server_->start().map([] { return true; }));
        if (recording != nullptr) {
            recording_switch_ = recording->serve([this](bool on, std::function<void()> done) {
                server_->post([this, on, done = std::move(done)] {
                    record(on);
                    done();
                });
            });
        }
    }
    /// Observers let go of their Programs between the server's thread and the Programs' end.
    ~SkillServers() {
        recording_switch_ = {};
        server_->stop();
        program_recorders_.clear();
        recorder_.reset();
    }
    SkillServers(const SkillServers&) = delete;
    SkillServers& operator=(const SkillServers&) = delete;
    std::string url() const { return server_->endpointUrl(); }

private:
    static opcua::ServerOptions options() {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier"};
        options.namespaces = {"urn:benchmark"};
        options.logger = std::make_shared<spdlog::logger>("quiet");
        return options;
    }
    void record(bool on) {
        program_recorders_.clear();
        if (!on) {
            return;
        }
        for (auto* program : skills_->programs()) {
            program_recorders_.push_back(std::make_unique<records::ProgramRecorder>(
                *program, *recorder_, nullptr,
                records::ProgramRecorder::Place{"benchmark", "Benchmark", ""}));
        }
    }
    void publish(const opcua::NodeId& folder, std::string name, opcua_skill::NodeStyle style) {
        skill::SkillFunctions functions;
        functions.start = [work = work_](const auto& /*parameters*/, const auto& execution) {
            const auto end = steady_clock::now() + work;
            while (steady_clock::now() < end) {
            }
            execution.finish();
        };
        auto skill = std::make_unique<skill::LambdaSkill>(moveDescription(std::move(name)),
                                                          std::move(functions));
        orThrow(skills_->publish(folder, std::move(skill), {}, style));
    }

    const std::chrono::microseconds work_;
    SystemClock clock_;
    std::unique_ptr<opcua::Server> server_ = orThrow(opcua::Server::create(options()));
    std::unique_ptr<opcua_skill::SkillServer> skills_ = orThrow(opcua_skill::SkillServer::create(
        *server_, clock_, std::make_shared<spdlog::logger>("quiet")));
    std::unique_ptr<records::Recorder> recorder_;
    std::vector<std::unique_ptr<records::ProgramRecorder>> program_recorders_;
    RecordingSwitch::Serving recording_switch_;
};

class MetierCaller final : public Caller {
public:
    explicit MetierCaller(const std::string& url) : client_(connect(url)) {
        skill_ = orThrow(client::findSkill(*client_, kStarted)).node;
        start_ = orThrow(client_->translate(skill_, {{0, "Start"}}));
    }

    /// Another client's execution may just run: then it is asked again.
    void call() override {
        auto answer = client_->call(skill_, start_);
        while (!answer && answer.error().status == opcua::status::kBadInvalidState) {
            answer = client_->call(skill_, start_);
        }
        orThrow(std::move(answer));
    }
    void start() override { call(); }

    void subscribe() override {
        opcua::EventFilter filter;
        filter.fields = {{{0, "Transition"}, {0, "Number"}}};
        subscription_ = orThrow(client_->subscribeEvents(
            skill_, filter, [this](const opcua::EventNotice& notice) { heard(notice); }));
    }

    std::chrono::nanoseconds startUntilRunning() override {
        while (seen_.popUntil(steady_clock::time_point{})) {
        }
        watching_ = true;
        const auto begin = steady_clock::now();
        start();
        const auto running = seen_.popUntil(begin + kPatience);
        const auto ready = seen_.popUntil(begin + kPatience);
        watching_ = false;
        if (!running || !ready) {
            throw std::runtime_error("no event came");
        }
        return *running - begin;
    }

    void idleUntil(steady_clock::time_point end) override { std::this_thread::sleep_until(end); }

private:
    static std::unique_ptr<opcua::Client> connect(const std::string& url) {
        opcua::ClientOptions options;
        options.publishing_interval = kPublishingInterval;
        return orThrow(opcua::Client::connect(url, options));
    }
    void heard(const opcua::EventNotice& notice) {
        if (watching_ && notice.kind == opcua::EventNotice::Kind::event) {
            seen_.tryPush(steady_clock::now());
        }
    }

    Queue<steady_clock::time_point> seen_{1'000};
    std::atomic<bool> watching_{false};
    opcua::NodeId skill_;
    opcua::NodeId start_;
    std::unique_ptr<opcua::Client> client_;
    opcua::Subscription subscription_;
};

/// A client that knows nothing of metier but where Start is.
class BareCallerOfMetier final : public Caller {
public:
    explicit BareCallerOfMetier(const std::string& url) : client_(url) {
        const auto finder = orThrow(opcua::Client::connect(url, {}));
        const auto skill = orThrow(client::findSkill(*finder, kStarted)).node;
        skill_ = skill.toString();
        start_ = orThrow(finder->translate(skill, {{0, "Start"}})).toString();
    }

    void call() override { client_.call(skill_, start_); }
    void start() override { call(); }
    void subscribe() override { throw std::logic_error("only calls"); }
    std::chrono::nanoseconds startUntilRunning() override { throw std::logic_error("only calls"); }
    void idleUntil(steady_clock::time_point /*end*/) override {}

private:
    opcua::bare::Client client_;
    std::string skill_;
    std::string start_;
};

}  // namespace

Side metierServerBareClient() {
    auto side = metierSide();
    side.connect = [](const std::string& url) { return std::make_unique<BareCallerOfMetier>(url); };
    return side;
}

Side metierSide(opcua_skill::NodeStyle style) {
    return {[style](std::size_t idle) {
                const auto server = std::make_shared<SkillServers>(idle, style);
                return Served{server->url(), server};
            },
            [](const std::string& url) { return std::make_unique<MetierCaller>(url); }};
}

Side recordingSide(const RecordingSwitch& recording, std::chrono::microseconds work) {
    auto side = metierSide();
    side.serve = [&recording, work](std::size_t idle) {
        const auto server = std::make_shared<SkillServers>(idle, opcua_skill::NodeStyle::readable,
                                                           &recording, work);
        return Served{server->url(), server};
    };
    return side;
}

}  // namespace metier::benchmarks
