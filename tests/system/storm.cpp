#include "storm.hpp"

#include <fmt/format.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include "metier/base/clock.hpp"
#include "metier/base/queue.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/skill/lambda_skill.hpp"

namespace metier::system_tests {
namespace {

using std::chrono::steady_clock;

constexpr const char* kDevice = "https://fortiss.org/UA/Device/";
constexpr std::chrono::seconds kPatience{30};
constexpr unsigned kOneHaltIn = 16;  // calls

/// The transitions of one skill in their order, folded into a few numbers.
class Stream {
public:
    void add(std::uint32_t number, std::string_view execution_id) {
        ++count_;
        fold(number);
        for (const char letter : execution_id) {
            fold(static_cast<unsigned char>(letter));
        }
    }
    std::uint64_t count() const { return count_; }
    bool operator==(const Stream&) const = default;

private:
    void fold(std::uint64_t value) { hash_ = (hash_ ^ value) * 1'099'511'628'211U; }

    std::uint64_t count_ = 0;
    std::uint64_t hash_ = 14'695'981'039'346'656'037U;
};

/// Transitions of one skill as the server counts them.
class ServerCount final : public skill::ProgramObserver {
public:
    explicit ServerCount(std::atomic<std::uint64_t>& total) : total_(total) {}
    void onTransition(const skill::TransitionEvent& event) override {
        stream_.add(static_cast<std::uint32_t>(event.number), event.execution_id);
        ++total_;
    }

    /// The server's thread.
    const Stream& stream() const { return stream_; }

private:
    std::atomic<std::uint64_t>& total_;
    Stream stream_;
};

/// The server with its skills, and the thread that finishes half of them.
class StormServer {
public:
    static Result<std::unique_ptr<StormServer>> start(std::size_t skills) {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier"};
        options.namespaces = {"urn:storm"};
        options.logger = std::make_shared<spdlog::logger>("quiet");
        auto server = opcua::Server::create(options);
        if (!server) {
            return fail(server.error());
        }
        std::unique_ptr<StormServer> storm(new StormServer(std::move(*server)));
        if (auto served = storm->serve(skills, options.logger); !served) {
            return fail(served.error());
        }
        return storm;
    }

    ~StormServer() {
        finishing_.close();
        finisher_ = {};
        skills_.reset();
    }
    StormServer(const StormServer&) = delete;
    StormServer& operator=(const StormServer&) = delete;

    std::string url() const { return server_->endpointUrl(); }
    std::uint64_t total() const { return total_; }

    /// Waits until nothing is Running any more; the transitions of each skill, by name.
    Result<std::vector<Stream>> finalStreams() {
        finishing_.close();
        finisher_ = {};
        return server_->call([this] {
            std::vector<Stream> streams;
            for (const auto& count : counts_) {
                streams.push_back(count->stream());
            }
            return streams;
        });
    }

private:
    explicit StormServer(std::unique_ptr<opcua::Server> server) : server_(std::move(server)) {}

    Result<void> serve(std::size_t count, const std::shared_ptr<spdlog::logger>& logger) {
        auto made = opcua_skill::SkillServer::create(*server_, clock_, logger);
        if (!made) {
            return fail(made.error());
        }
        skills_ = std::move(*made);
        auto& nodes = server_->nodes();
        const auto index = nodes.namespaceIndex("urn:storm");
        auto system = opcua_skill::publishMotionDeviceSystem(
            nodes, {"Storm", "Nothing that moves.", "metier", "storm", {"A1"}, index.value_or(1)});
        if (!system) {
            return fail(system.error());
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (auto added = addSkill(system->skills, i); !added) {
                return added;
            }
        }
        return server_->start();
    }

    Result<void> addSkill(const opcua::NodeId& skills, std::size_t number) {
        skill::SkillDescription description;
        description.name = fmt::format("NoOp{}", number);
        description.type = "PositionStreamSkillType";
        skill::SkillFunctions functions;
        if (number % 2 == 1) {
            functions.start = [this](const skill::ValueMap&,
                                     const skill::ExecutionHandle& execution) {
                finishing_.tryPush(execution);
            };
        }
        auto program = skills_->publish(skills, std::make_unique<skill::LambdaSkill>(
                                                    std::move(description), std::move(functions)));
        if (!program) {
            return fail(program.error());
        }
        counts_.push_back(std::make_unique<ServerCount>(total_));
        (*program)->attach(*counts_.back());
        return {};
    }

    void finishAll() {
        while (const auto execution = finishing_.popUntil(SteadyTime::max())) {
            execution->finish();
        }
    }

    SystemClock clock_;
    std::atomic<std::uint64_t> total_{0};
    std::vector<std::unique_ptr<ServerCount>> counts_;
    Queue<skill::ExecutionHandle> finishing_{1'000};
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua_skill::SkillServer> skills_;
    std::jthread finisher_{[this] { finishAll(); }};
};

/// One skill as a client sees it.
struct SeenSkill {
    opcua::NodeId object;
    opcua::NodeId start;
    opcua::NodeId halt;
    opcua::NodeId reset;
    Stream stream;
    std::uint32_t state = static_cast<std::uint32_t>(skill::State::ready);
};

/// A client that storms, and checks the events that it gets.
class StormClient {
public:
    static Result<std::unique_ptr<StormClient>> connect(const std::string& url) {
        auto client = opcua::Client::connect(url);
        if (!client) {
            return fail(client.error());
        }
        std::unique_ptr<StormClient> storm(new StormClient(std::move(*client)));
        if (auto ready = storm->subscribeAll(); !ready) {
            return fail(ready.error());
        }
        return storm;
    }

    /// Calls until the server has made `goal` transitions.
    void work(const StormServer& server, std::uint64_t goal, std::uint32_t seed) {
        std::mt19937 random(seed);
        while (server.total() < goal && healthy_) {
            const auto& skill = skills_[random() % skills_.size()];
            if (random() % kOneHaltIn == 0) {
                call(skill.object, skill.halt);
            } else if (!call(skill.object, skill.start)) {
                // Refused because it runs, or because another client halted it: then any client
                // resets it.
                call(skill.object, skill.reset);
            }
        }
    }

    /// Waits for the events that are still on their way; compares them with the server's.
    void compare(const std::vector<Stream>& expected, SteadyTime deadline) {
        std::unique_lock lock(mutex_);
        changed_.wait_until(lock, deadline, [&] { return received(expected); });
        for (std::size_t i = 0; i < skills_.size(); ++i) {
            const auto& stream = skills_[i].stream;
            if (stream != expected[i]) {
                defects_.push_back(
                    fmt::format("NoOp{}: {} events for {} transitions{}", i, stream.count(),
                                expected[i].count(),
                                stream.count() == expected[i].count() ? ", not the same" : ""));
            }
        }
    }

    std::uint64_t events() const {
        std::uint64_t events = 0;
        for (const auto& skill : skills_) {
            events += skill.stream.count();
        }
        return events;
    }
    const std::vector<std::string>& defects() const { return defects_; }

private:
    explicit StormClient(std::unique_ptr<opcua::Client> client) : client_(std::move(client)) {}

    Result<void> subscribeAll() {
        auto found = client::findSkills(*client_);
        const auto device = client_->namespaceIndex(kDevice);
        if (!found || !device) {
            return fail(found ? device.error() : found.error());
        }
        std::sort(found->begin(), found->end(),
                  [](const auto& left, const auto& right) { return left.name < right.name; });
        skills_.resize(found->size());
        for (std::size_t i = 0; i < found->size(); ++i) {
            if (auto subscribed = subscribe((*found)[i].node, skills_[i], *device); !subscribed) {
                return subscribed;
            }
        }
        return {};
    }

    Result<void> subscribe(const opcua::NodeId& object, SeenSkill& skill, std::uint16_t device) {
        skill.object = object;
        const auto methods = client_->translateMany(
            {{object, {{0, "Start"}}}, {object, {{0, "Halt"}}}, {object, {{0, "Reset"}}}});
        if (!methods) {
            return fail(methods.error());
        }
        skill.start = (*methods)[0].value_or(opcua::NodeId());
        skill.halt = (*methods)[1].value_or(opcua::NodeId());
        skill.reset = (*methods)[2].value_or(opcua::NodeId());
        opcua::EventFilter filter;
        filter.fields = {{{0, "Transition"}, {0, "Number"}}, {{device, "ExecutionId"}}};
        filter.of_type = opcua::ids::kProgramTransitionEventType;
        auto subscription = client_->subscribeEvents(
            object, filter,
            [this, &skill](const opcua::EventNotice& notice) { heard(skill, notice); });
        if (!subscription) {
            return fail(subscription.error());
        }
        subscriptions_.push_back(std::move(*subscription));
        return {};
    }

    void heard(SeenSkill& skill, const opcua::EventNotice& notice) {
        {
            const std::lock_guard lock(mutex_);
            if (notice.kind == opcua::EventNotice::Kind::event) {
                take(skill, notice.fields);
            } else {
                defect("events were lost, or the subscription ended");
            }
        }
        changed_.notify_one();
    }

    void take(SeenSkill& skill, const std::vector<opcua::Value>& fields) {
        const auto number = fields[0].as<std::uint32_t>().value_or(0);
        const auto transition = static_cast<skill::TransitionNumber>(number);
        if (number < 1 || number > 9 ||
            static_cast<std::uint32_t>(skill::fromState(transition)) != skill.state) {
            defect(fmt::format("{}: transition {} in state {} after {} events",
                               skill.object.toString(), number, skill.state, skill.stream.count()));
            return;
        }
        skill.state = static_cast<std::uint32_t>(skill::toState(transition));
        skill.stream.add(number, fields[1].as<std::string>().value_or(""));
    }

    bool received(const std::vector<Stream>& expected) const {
        return std::equal(skills_.begin(), skills_.end(), expected.begin(), expected.end(),
                          [](const auto& skill, const auto& stream) {
                              return skill.stream.count() >= stream.count();
                          });
    }

    bool call(const opcua::NodeId& object, const opcua::NodeId& method) {
        const auto answer = client_->call(object, method);
        if (!answer && answer.error().status != opcua::status::kBadInvalidState) {
            const std::lock_guard lock(mutex_);
            defect(answer.error().message);
        }
        return answer.has_value();
    }

    /// With the mutex held.
    void defect(std::string what) {
        healthy_ = false;
        defects_.push_back(std::move(what));
    }

    std::vector<SeenSkill> skills_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::atomic<bool> healthy_{true};
    std::vector<std::string> defects_;
    std::unique_ptr<opcua::Client> client_;
    std::vector<opcua::Subscription> subscriptions_;
};

using Clients = std::vector<std::unique_ptr<StormClient>>;

Result<Clients> connectAll(const std::string& url, std::size_t count) {
    Clients clients;
    for (std::size_t i = 0; i < count; ++i) {
        auto client = StormClient::connect(url);
        if (!client) {
            return fail(client.error());
        }
        clients.push_back(std::move(*client));
    }
    return clients;
}

void storm(const StormServer& server, const Clients& clients, const StormOptions& options) {
    std::vector<std::jthread> threads;
    auto seed = options.seed;
    for (const auto& client : clients) {
        threads.emplace_back([&, seed] { client->work(server, options.transitions, seed); });
        ++seed;
    }
}

}  // namespace

Result<StormReport> runStorm(const StormOptions& options) {
    const auto server = StormServer::start(options.skills);
    if (!server) {
        return fail(server.error());
    }
    const auto clients = connectAll((*server)->url(), options.clients);
    if (!clients) {
        return fail(clients.error());
    }
    const auto begin = steady_clock::now();
    storm(**server, *clients, options);
    const auto expected = (*server)->finalStreams();
    if (!expected) {
        return fail(expected.error());
    }
    StormReport report;
    for (const auto& client : *clients) {
        client->compare(*expected, steady_clock::now() + kPatience);
        report.events += client->events();
        report.defects.insert(report.defects.end(), client->defects().begin(),
                              client->defects().end());
    }
    report.seconds = std::chrono::duration<double>(steady_clock::now() - begin).count();
    report.transitions = (*server)->total();
    return report;
}

}  // namespace metier::system_tests
