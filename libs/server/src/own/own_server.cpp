#include "metier/server/own_server.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <optional>
#include <utility>

#include "host/skill_host.hpp"
#include "metier/link/start_watch.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/opcua_skill/skill_types.hpp"
#include "metier/server/identity.hpp"
#include "metier/server/ready_line.hpp"
#include "metier/server/server.hpp"
#include "metier/server/state_choice.hpp"
#include "metier/skill/skill_type.hpp"

namespace metier::server {
namespace {

// Longest time from the signal to the end of the process; what moves brakes within 2 s of it.
constexpr std::chrono::seconds kLongestEndOfProgram{10};

/// Executor of a program whose server could not be made: nothing will run.
class DroppingExecutor final : public skill::Executor {
public:
    void post(std::function<void()> /*work*/) override {}
    skill::Timer after(std::chrono::nanoseconds /*delay*/,
                       std::function<void()> /*work*/) override {
        return {};
    }
};

/// Arguments of the command line of an OwnServer.
struct OwnCommandLine {
    cell::ServerConfig config;
    Security security;
    StateChoice state;
};

OwnCommandLine presetOf(const OwnServerOptions& options) {
    OwnCommandLine line;
    line.config.name = options.name;
    line.config.port = options.port;
    line.config.address = "127.0.0.1";
    line.config.kind = cell::CompositionServer();  // the kind of a server without a driver
    return line;
}

/// \return exit status, if the program ends here: with a help text, or with a mistake that was
///         reported
std::optional<int> readArguments(int argc, const char* const* argv, const std::string& about,
                                 OwnCommandLine& line) {
    CLI::App app(about, line.config.name);
    app.add_option("--port", line.config.port, "TCP port; 0: a free one")->capture_default_str();
    app.add_option("--address", line.config.address, "Address to listen on")->capture_default_str();
    app.add_flag("--insecure-lab", line.security.insecure_lab,
                 "No encryption, no certificates, no users, on this machine alone: for trials");
    app.add_option("--security", line.security.folder,
                   "Folder of certificates, keys and users [~/.config/metier]");
    app.add_option("--state", line.state.folder,
                   "Folder for what outlives the server: names of executions, records, audit log. "
                   "Else that of the user, and none with --port 0");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    return std::nullopt;
}

/// Log of a program: its standard output belongs to the ready line and to its skills.
void logToStandardError(const std::string& name) {
    auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    auto logger = std::make_shared<spdlog::logger>(name, std::move(sink));
    logger->set_level(spdlog::level::warn);
    spdlog::set_default_logger(std::move(logger));
}

}  // namespace

struct OwnServer::State {
    struct Offered {
        std::unique_ptr<skill::Skill> skill;
        OfferOptions options;
    };

    explicit State(OwnServerOptions own_options) : options(std::move(own_options)) {}

    Result<void> make(OwnCommandLine& line);
    skill::SkillTypes newTypes();
    Result<void> publish();
    Result<void> begin();
    int end(int status, const std::string& message);

    const link::StopSignal stop;  // before any thread
    const OwnServerOptions options;
    std::optional<int> exit_status;  // once it is known that nothing is served any more
    std::optional<Identity> identity;
    std::unique_ptr<SkillHost> host;            // refers to the identity; null before and after
    std::shared_ptr<skill::Executor> executor;  // shared with skills and their devices
    std::vector<Offered> offered;
};

Result<void> OwnServer::State::make(OwnCommandLine& line) {
    chooseState(line.config, line.state);
    METIER_ASSIGN(identity, identityOf(line.config, line.security));
    METIER_ASSIGN(host, SkillHost::create(line.config, *identity, {}));
    executor = host->skills().executor();
    return {};
}

/// Types of the skills that the server does not know yet; further terms for those that it knows.
skill::SkillTypes OwnServer::State::newTypes() {
    skill::SkillTypes types{.uri = options.types.empty() ? "urn:metier:own:" + options.name
                                                         : options.types};
    for (const auto& one : offered) {
        auto type = skill::skillTypeOf(one.skill->description());
        const bool declared =
            std::any_of(types.types.begin(), types.types.end(),
                        [&](const auto& other) { return other.name == type.name; });
        if (opcua_skill::hasSkillType(host->nodes(), type.name)) {
            type = {.name = type.name, .extends = true};
        }
        type.terms = one.options.terms;
        if (!declared && !(type.extends && type.terms.empty())) {
            types.types.push_back(std::move(type));
        }
    }
    return types;
}

Result<void> OwnServer::State::publish() {
    auto& nodes = host->nodes();
    const auto types = newTypes();
    METIER_TRY(types.types.empty() ? Result<void>() : opcua_skill::declareTypes(nodes, types));
    METIER_ASSIGN(const auto place,
                  opcua_skill::publishSkillController(nodes, options.name, options.description));
    std::vector<std::string> names;
    std::vector<DeviceSkill> skills;
    for (auto& one : offered) {
        names.push_back(one.skill->description().name);
        skills.push_back({std::move(one.skill), one.options.resource});
    }
    offered.clear();
    METIER_TRY(host->offerSkills(place.skills, names, std::move(skills)));
    return host->offerControl(place.controller);
}

/// Errors: also those that a Program throws for a skill that is described wrongly.
Result<void> OwnServer::State::begin() {
    const link::StartWatch starting(stop);
    try {
        METIER_TRY(publish());
    } catch (const std::exception& error) {
        return fail(Errc::invalid_argument, error.what());
    }
    return host->start();
}

/// Ends the server with its skills, whatever these refer to is still there.
int OwnServer::State::end(int status, const std::string& message) {
    if (!message.empty()) {
        fmt::print(stderr, "{}: {}\n", options.name, message);
    }
    host.reset();
    offered.clear();
    exit_status = status;
    return status;
}

OwnServer::OwnServer(int argc, const char* const* argv, OwnServerOptions options)
    : state_(std::make_unique<State>(std::move(options))) {
    link::StopSignal::outliveOutput();
    logToStandardError(state_->options.name);
    state_->executor = std::make_shared<DroppingExecutor>();
    auto line = presetOf(state_->options);
    state_->exit_status = readArguments(argc, argv, state_->options.description, line);
    if (state_->exit_status) {
        return;
    }
    if (const auto made = state_->make(line); !made) {
        state_->end(1, made.error().message);
    }
}

OwnServer::~OwnServer() = default;

std::shared_ptr<skill::Executor> OwnServer::executor() const {
    return state_->executor;
}

void OwnServer::offer(skill::SkillDescription description, skill::SkillFunctions functions,
                      OfferOptions options) {
    offer(std::make_unique<skill::LambdaSkill>(std::move(description), std::move(functions)),
          std::move(options));
}

void OwnServer::offer(std::unique_ptr<skill::Skill> skill, OfferOptions options) {
    state_->offered.push_back({std::move(skill), std::move(options)});
}

int OwnServer::run() {
    if (state_->exit_status) {
        return *state_->exit_status;
    }
    if (const auto begun = state_->begin(); !begun) {
        return state_->end(1, begun.error().message);
    }
    fmt::print("{}\n", readyLine(state_->host->url()));
    std::fflush(stdout);
    state_->stop.wait();
    link::StopSignal::endWithin(kLongestEndOfProgram);
    return state_->end(0, "");
}

}  // namespace metier::server
