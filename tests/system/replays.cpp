#include "replays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <random>
#include <stdexcept>
#include <utility>

#include "bench_server.hpp"
#include "hostile/raw_socket.hpp"
#include "metier/skill/execution_names.hpp"
#include "tcp_relay.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr const char* kSkill = "Replayed";
constexpr const char* kMetierUri = "urn:metier:skills";
constexpr std::size_t kKept = 32;  // of each kind of recorded bytes
constexpr std::uint32_t kLeaseMs = 3'600'000;

/// Sends bytes to a server as a client of its own would, and reads until the server closes.
/// \return what it answered within half a minute
std::string sendAlone(std::uint16_t port, const std::string& bytes) {
    constexpr auto patience = 30s;
    hostile::RawSocket socket;
    if (!socket.connect(port)) {
        throw std::runtime_error("nobody listens for the replayed connection");
    }
    socket.send(bytes, patience);
    socket.endSending();
    std::string answer;
    const auto deadline = steady_clock::now() + patience;
    while (socket.isOpen() && steady_clock::now() < deadline) {
        socket.receive(answer, 1s);
    }
    return answer;
}

/// Something that a client once sent, and that must not count again.
struct Spoils {
    std::uint64_t boot = 0;
    std::string name{};
    std::uint64_t epoch = 0;
    std::string connection{};  ///< all of it, from its first byte to the command
    std::string command{};     ///< the command alone
};

/// One life of the server, with a client through a relay and one without.
class Boot {
public:
    explicit Boot(const std::filesystem::path& names)
        : bench_({.names = orThrow(skill::ExecutionNames::open(names))}) {
        skill::SkillFunctions functions;
        functions.start = [this](const skill::ValueMap&, const skill::ExecutionHandle& execution) {
            ++starts_;
            execution.finish();
        };
        bench_.addSkill(benchDescription(kSkill), std::move(functions));
        acquire_ = bench_.controllerNode(kMetierUri, {"AcquireControl"});
        heartbeat_ = bench_.controllerNode(kMetierUri, {"Heartbeat"});
        release_ = bench_.controllerNode(kMetierUri, {"ReleaseControl"});
        bench_.serve();
        relay_ = std::make_unique<testing::TcpRelay>(bench_.port());
        direct_ = connectAs(bench_.url(), "bob");
        reconnect();
    }

    void reconnect() {
        relayed_.reset();
        relayed_ = connectAs(relay_->url(), "alice");
    }
    opcua::Client& direct() { return *direct_; }
    opcua::Client& relayed() { return *relayed_; }
    testing::TcpRelay& relay() { return *relay_; }
    std::uint16_t port() const { return bench_.port(); }

    struct Start {
        std::string name{};
        std::uint64_t epoch = 0;
        UtcTime deadline{};
    };
    /// The StatusCode's name.
    std::string startWith(opcua::Client& client, const Start& start) {
        const std::vector<opcua::KeyValue> pairs{{{0, "TargetJointPosition"}, target()}};
        const auto status =
            statusOf(client.call(bench_.node(kSkill), bench_.node(kSkill, "StartWith"),
                                 {opcua::Value::of(start.name), opcua::Value::of(pairs),
                                  opcua::Value::of(std::int32_t{0}), opcua::Value::of(start.epoch),
                                  opcua::Value::of(start.deadline)}));
        awaitReady();  // a named one begins once its name is on disk
        return status;
    }
    std::string start(opcua::Client& client) {
        return statusOf(client.call(bench_.node(kSkill), bench_.node(kSkill, "Start")));
    }
    std::string write(opcua::Client& client) {
        const auto written =
            client.write(bench_.node(kSkill, "ParameterSet/TargetJointPosition"), target());
        return written ? "Good" : written.error().status.name();
    }
    std::uint64_t acquire(opcua::Client& client) {
        const auto answer =
            orThrow(client.call(bench_.system().controller, acquire_,
                                {opcua::Value::of(kLeaseMs), opcua::Value::of(std::int32_t{0})}));
        return answer.outputs.at(0).as<std::uint64_t>().value();
    }
    std::string heartbeat(opcua::Client& client, std::uint64_t epoch) {
        return statusOf(
            client.call(bench_.system().controller, heartbeat_, {opcua::Value::of(epoch)}));
    }
    std::string release(opcua::Client& client, std::uint64_t epoch) {
        return statusOf(
            client.call(bench_.system().controller, release_, {opcua::Value::of(epoch)}));
    }
    bool answers(opcua::Client& client) {
        return client.read(bench_.node(kSkill, "CurrentState")).has_value();
    }
    /// Number of starts of the skill, once all that was sent is done; it is Ready again then.
    std::uint64_t starts() {
        awaitReady();
        bench_.onServer([] {});
        return starts_;
    }

private:
    /// Waits until nothing runs, for 10 s at most.
    void awaitReady() {
        constexpr std::uint32_t kReady = 12;
        const auto deadline = steady_clock::now() + 10s;
        const auto node = bench_.node(kSkill, "CurrentState/Number");
        while (steady_clock::now() < deadline) {
            const auto number = direct_->read(node);
            if (number && number->as<std::uint32_t>() == kReady) {
                return;
            }
        }
    }
    static opcua::Value target() { return opcua::Value::of(std::vector{0.5, 0.5}); }
    static std::string statusOf(const opcua::Answer<opcua::CallResult>& answer) {
        return answer ? "Good" : answer.error().status.name();
    }

    BenchServer bench_;
    std::atomic<std::uint64_t> starts_{0};
    opcua::NodeId acquire_;
    opcua::NodeId heartbeat_;
    opcua::NodeId release_;
    std::unique_ptr<testing::TcpRelay> relay_;
    std::unique_ptr<opcua::Client> direct_;
    std::unique_ptr<opcua::Client> relayed_;
};

class Replays {
public:
    explicit Replays(const ReplayOptions& options) : options_(options), random_(options.seed) {
        std::filesystem::remove_all(options.folder);
    }

    ReplayReport run() {
        const auto begin = steady_clock::now();
        while (report_.rounds < options_.rounds) {
            ++report_.boots;
            Boot boot(options_.folder / "replays.executions");
            meant_ = 0;
            plunder(boot);
            for (std::uint64_t i = 0; i < options_.rounds_per_boot; ++i) {
                round(boot);
            }
        }
        report_.seconds = std::chrono::duration<double>(steady_clock::now() - begin).count();
        std::filesystem::remove_all(options_.folder);
        return std::move(report_);
    }

private:
    /// Allowed answers to a late command.
    using Allowed = std::vector<std::string>;

    /// Starts the skill in every way, and keeps what was sent.
    void plunder(Boot& boot) {
        Spoils named{.boot = report_.boots, .name = newName()};
        named.epoch = boot.acquire(boot.relayed());
        expectGood(boot.startWith(boot.relayed(), {named.name, named.epoch, {}}));
        expectGood(boot.release(boot.relayed(), named.epoch));
        keep(std::move(named), names_);
        Spoils timed{.boot = report_.boots, .name = newName()};
        expectGood(boot.startWith(boot.direct(), {timed.name, 0, inAnHour()}));
        keep(std::move(timed), names_);
        record(boot, [&] { expectGood(boot.startWith(boot.relayed(), {})); });
        expectGood(boot.write(boot.relayed()));
        record(boot, [&] { expectGood(boot.start(boot.relayed())); });
        constexpr std::uint64_t starts = 4;
        meant_ += starts;
        report_.starts += starts;
        checkNothingElse(boot, "a start that was meant");
    }

    /// Keeps the bytes of what `command` sends over the relay.
    template <typename Command>
    void record(Boot& boot, Command command) {
        const auto before = boot.relay().sent().size();
        command();
        Spoils spoils{.boot = report_.boots, .connection = boot.relay().sent()};
        spoils.command = spoils.connection.substr(before);
        keep(std::move(spoils), bytes_);
    }

    void round(Boot& boot) {
        using Attempt = void (Replays::*)(Boot&);
        constexpr std::array<Attempt, 8> attempts{
            &Replays::sameName,       &Replays::staleEpoch,
            &Replays::staleHeartbeat, &Replays::passedDeadline,
            &Replays::sameBytes,      &Replays::sameConnection,
            &Replays::epochOfAnother, &Replays::startOfAnotherSession};
        ++report_.rounds;
        (this->*attempts.at(random_() % attempts.size()))(boot);
    }

    void sameName(Boot& boot) {
        const auto& spoils = any(names_);
        const bool same_life = spoils.boot == report_.boots;
        const auto answer = boot.startWith(
            eitherOf(boot), {spoils.name, 0, random_() % 2 == 0 ? inAnHour() : UtcTime{}});
        judge(boot, same_life ? "same name, same life" : "same name, later life", answer,
              {same_life ? "Good" : "BadNodeIdExists"});
    }
    void staleEpoch(Boot& boot) {
        const auto& spoils = withEpoch();
        judge(boot, "stale epoch",
              boot.startWith(eitherOf(boot), {newName(), spoils.epoch, UtcTime{}}), {"BadLocked"});
    }
    void staleHeartbeat(Boot& boot) {
        judge(boot, "stale heartbeat", boot.heartbeat(eitherOf(boot), withEpoch().epoch),
              {"BadLocked"});
    }
    void passedDeadline(Boot& boot) {
        const auto late = std::chrono::milliseconds(1 + random_() % 10'000);
        judge(
            boot, "passed deadline",
            boot.startWith(eitherOf(boot), {newName(), 0, std::chrono::system_clock::now() - late}),
            {"BadTimeout"});
    }
    /// The very bytes once more, over the connection that is open now.
    void sameBytes(Boot& boot) {
        const auto& spoils = any(bytes_);
        boot.relay().inject(spoils.command);
        const bool alive = boot.answers(boot.relayed());
        judge(boot,
              spoils.boot == report_.boots ? "same bytes, same life" : "same bytes, later life",
              alive ? "connection goes on" : "connection closed", {"connection closed"});
        boot.reconnect();
    }
    /// A whole connection once more, from its first byte.
    void sameConnection(Boot& boot) {
        const auto& spoils = any(bytes_);
        const auto answer = sendAlone(boot.port(), spoils.connection);
        judge(boot,
              spoils.boot == report_.boots ? "same connection, same life"
                                           : "same connection, later life",
              answer.empty() ? "nothing" : "something", {"something"});
    }
    void epochOfAnother(Boot& boot) {
        const auto epoch = boot.acquire(boot.relayed());
        judge(boot, "epoch of another", boot.startWith(boot.direct(), {newName(), epoch, {}}),
              {"BadLocked"});
        expectGood(boot.release(boot.relayed(), epoch));
    }
    /// Acts as a client library that keeps a Start for its next session.
    void startOfAnotherSession(Boot& boot) {
        expectGood(boot.write(boot.relayed()));
        static_cast<void>(boot.relayed().close());
        boot.reconnect();
        judge(boot, "Start of another session", boot.start(boot.relayed()), {"BadInvalidArgument"});
    }

    void judge(Boot& boot, const std::string& kind, const std::string& answer,
               const Allowed& allowed) {
        ++report_.answers[kind + ": " + answer];
        if (std::find(allowed.begin(), allowed.end(), answer) == allowed.end()) {
            report_.defects.push_back(
                fmt::format("round {}: {}: {}", report_.rounds, kind, answer));
        }
        checkNothingElse(boot, kind);
    }

    void checkNothingElse(Boot& boot, const std::string& kind) {
        if (const auto starts = boot.starts(); starts != meant_) {
            report_.defects.push_back(fmt::format("round {}: {} starts, {} were meant, after: {}",
                                                  report_.rounds, starts, meant_, kind));
            meant_ = starts;
        }
    }

    static void expectGood(const std::string& answer) {
        if (answer != "Good") {
            throw std::runtime_error("a start that was meant: " + answer);
        }
    }
    static UtcTime inAnHour() { return std::chrono::system_clock::now() + 1h; }
    std::string newName() { return fmt::format("start {}", ++named_); }
    opcua::Client& eitherOf(Boot& boot) {
        return random_() % 2 == 0 ? boot.direct() : boot.relayed();
    }
    const Spoils& any(const std::vector<Spoils>& spoils) {
        return spoils.at(random_() % spoils.size());
    }
    const Spoils& withEpoch() {
        while (true) {
            if (const auto& spoils = any(names_); spoils.epoch != 0) {
                return spoils;
            }
        }
    }
    static void keep(Spoils spoils, std::vector<Spoils>& all) {
        if (all.size() == kKept) {
            all.erase(all.begin());
        }
        all.push_back(std::move(spoils));
    }

    ReplayOptions options_;
    std::mt19937 random_;
    ReplayReport report_;
    std::vector<Spoils> names_;
    std::vector<Spoils> bytes_;
    std::uint64_t named_ = 0;
    std::uint64_t meant_ = 0;  ///< starts of this life
};

}  // namespace

Result<ReplayReport> runReplays(const ReplayOptions& options) {
    try {
        return Replays(options).run();
    } catch (const std::exception& error) {
        return fail(Errc::internal, error.what());
    }
}

}  // namespace metier::system_tests
