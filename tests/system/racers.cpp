#include "racers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <chrono>
#include <mutex>
#include <optional>
#include <random>
#include <stdexcept>
#include <thread>
#include <utility>

#include "bench_server.hpp"

namespace metier::system_tests {
namespace {

using std::chrono::steady_clock;

constexpr const char* kSkill = "Echo";
constexpr std::array kPaths{"ParameterSet/TargetJointPosition", "ParameterSet/MaxVelocity",
                            "ParameterSet/ToolFrame"};
constexpr std::array kNames{"TargetJointPosition", "MaxVelocity", "ToolFrame"};
constexpr std::size_t kValues = kPaths.size();

/// One parameter set: each of its values is made of one number; 0 is the default.
using Set = std::array<std::int64_t, kValues>;

std::string toText(const Set& set) {
    return fmt::format("[{}, {}, {}]", set[0], set[1], set[2]);
}

opcua::Value valueOf(std::size_t which, std::int64_t number) {
    if (which == kValues - 1) {
        return opcua::Value::of(number == 0 ? std::string() : std::to_string(number));
    }
    // 1e-6: within the range of the target for more rounds than anybody waits for.
    return opcua::Value::of(std::vector(2, static_cast<double>(number) * 1e-6));
}

std::int64_t numberIn(const std::vector<double>& values) {
    const bool alike = values.size() == 2 && values[0] == values[1];
    return alike ? std::llround(values[0] * 1e6) : -1;
}

std::int64_t numberIn(const std::string& text) {
    return text.empty() ? 0 : std::stoll(text);
}

/// The nodes that clients race for.
struct Track {
    opcua::NodeId object;
    std::array<opcua::NodeId, kValues> values;
    opcua::NodeId start;
    opcua::NodeId start_with;  ///< null: has none
};

/// A skill that keeps what it was started with, until the round is over.
class EchoSkill {
public:
    explicit EchoSkill(BenchServer& bench) : bench_(bench) {
        skill::SkillFunctions functions;
        functions.start = [this](const skill::ValueMap& given,
                                 const skill::ExecutionHandle& execution) {
            starts_.push_back(
                {numberIn(std::get<std::vector<double>>(given.at("TargetJointPosition"))),
                 numberIn(std::get<std::vector<double>>(given.at("MaxVelocity"))),
                 numberIn(std::get<std::string>(given.at("ToolFrame")))});
            execution_ = execution;
        };
        bench.addSkill(benchDescription(kSkill), std::move(functions));
        track_.object = bench.node(kSkill);
        for (std::size_t i = 0; i < kValues; ++i) {
            track_.values[i] = bench.node(kSkill, kPaths[i]);
        }
        track_.start = bench.node(kSkill, "Start");
        track_.start_with = bench.node(kSkill, "StartWith");
    }

    const Track& track() const { return track_; }

    /// Values with which the skill was started since the last call; ends it with these values as
    /// result.
    std::vector<Set> endRound() {
        std::vector<Set> starts;
        bench_.onServer([&] {
            starts = std::exchange(starts_, {});
            if (!starts.empty()) {
                const auto [target, velocity, tool] = starts.back();
                execution_.finish(
                    {{"ReachedJointPosition", std::vector(2, static_cast<double>(target) * 1e-6)},
                     {"Duration", static_cast<double>(velocity)}});
            }
        });
        return starts;
    }

    /// The result as clients see it; nothing of the tool in it.
    Set resultSeenBy(opcua::Client& client) const {
        const auto reached =
            orThrow(client.read(bench_.node(kSkill, "FinalResultData/ReachedJointPosition")));
        const auto duration = orThrow(client.read(bench_.node(kSkill, "FinalResultData/Duration")));
        return {numberIn(reached.as<std::vector<double>>().value_or(std::vector<double>{})),
                std::llround(duration.as<double>().value_or(-1)), 0};
    }

private:
    BenchServer& bench_;
    Track track_;
    // The server's thread:
    std::vector<Set> starts_;
    skill::ExecutionHandle execution_;
};

/// A Program as OPC 10000-10 has it: Variables that everybody writes, a Start that reads them.
class PlainProgram {
public:
    explicit PlainProgram(BenchServer& bench) : bench_(bench) {
        auto& nodes = bench.server().nodes();
        const auto index = bench.system().skills.namespaceIndex();
        opcua::ObjectSpec object;
        object.node.parent = bench.system().skills;
        object.node.browse_name = {index, "Plain"};
        track_.object = orThrow(nodes.addObject(object));
        for (std::size_t i = 0; i < kValues; ++i) {
            opcua::VariableSpec variable;
            variable.node.parent = track_.object;
            variable.node.browse_name = {index, kNames[i]};
            variable.value = valueOf(i, 0);
            variable.data_type = variable.value.dataType();
            if (variable.value.isArray()) {
                variable.value_rank = 1;
                variable.array_dimensions = {0};
            }
            variable.access = opcua::Access::read_write;
            track_.values[i] = orThrow(nodes.addVariable(variable));
        }
        opcua::MethodSpec start;
        start.node.parent = track_.object;
        start.node.browse_name = {index, "Start"};
        start.handler = [this](const opcua::CallContext&, std::span<const opcua::Value>) {
            return begin();
        };
        track_.start = orThrow(nodes.addMethod(start));
    }

    const Track& track() const { return track_; }

    std::vector<Set> endRound() {
        std::vector<Set> starts;
        bench_.onServer([&] {
            starts = std::exchange(starts_, {});
            for (std::size_t i = 0; i < kValues; ++i) {
                orThrow(bench_.server().nodes().write(track_.values[i], valueOf(i, 0)));
            }
        });
        return starts;
    }

private:
    Result<std::vector<opcua::Value>> begin() {
        if (!starts_.empty()) {
            return fail(Errc::invalid_state, "it runs");
        }
        const auto& nodes = bench_.server().nodes();
        const auto at = [&](std::size_t i) { return orThrow(nodes.read(track_.values[i])).value; };
        starts_.push_back({numberIn(orThrow(at(0).as<std::vector<double>>())),
                           numberIn(orThrow(at(1).as<std::vector<double>>())),
                           numberIn(orThrow(at(2).as<std::string>()))});
        return std::vector<opcua::Value>();
    }

    BenchServer& bench_;
    Track track_;
    std::vector<Set> starts_;  // the server's thread
};

/// Behaviour of a client in one round.
enum class Role { writes_all, writes_some, starts_with, only_starts };

/// Actions of one client in one round.
struct Attempt {
    Role role = Role::writes_all;
    Set given{};
    bool started = false;
    std::string defect{};
};

class Racer {
public:
    Racer(std::unique_ptr<opcua::Client> client, std::uint32_t seed)
        : client_(std::move(client)), random_(seed) {}

    /// \param own     number that no other client uses, nor this one in another round
    /// \param meeting called once, after the first write if there is one
    template <typename Meeting>
    void race(const Track& track, std::int64_t own, Meeting meeting) {
        attempt_ = {};
        attempt_.role = chooseRole(track);
        if (attempt_.role == Role::starts_with) {
            attempt_.given.fill(own);
            meeting();
            take(client_->call(track.object, track.start_with, startWithInputs(own)));
            return;
        }
        if (attempt_.role == Role::only_starts) {
            meeting();
        } else {
            write(track, own, meeting);
        }
        take(client_->call(track.object, track.start));
    }

    const Attempt& attempt() const { return attempt_; }
    opcua::Client& client() { return *client_; }

private:
    Role chooseRole(const Track& track) {
        const auto role = static_cast<Role>(random_() % 4);
        return role == Role::starts_with && track.start_with == opcua::NodeId() ? Role::writes_all
                                                                                : role;
    }

    /// Writes in any order; a client that was refused goes on, as a careless one does.
    template <typename Meeting>
    void write(const Track& track, std::int64_t own, Meeting meeting) {
        std::array<std::size_t, kValues> order{0, 1, 2};
        std::shuffle(order.begin(), order.end(), random_);
        const std::size_t left_out = 1 + random_() % (kValues - 1);
        bool met = false;
        for (const auto which : order) {
            if (attempt_.role == Role::writes_some && which == left_out) {
                continue;
            }
            attempt_.given.at(which) = own;
            const auto written = client_->write(track.values.at(which), valueOf(which, own));
            check(written ? opcua::status::kGood : written.error().status);
            if (!std::exchange(met, true)) {
                meeting();
            }
        }
    }

    static std::vector<opcua::Value> startWithInputs(std::int64_t own) {
        std::vector<opcua::KeyValue> pairs;
        for (std::size_t i = 0; i < kValues; ++i) {
            pairs.push_back({{0, kNames.at(i)}, valueOf(i, own)});
        }
        return {opcua::Value::of(std::string()), opcua::Value::of(pairs),
                opcua::Value::of(std::int32_t{0}), opcua::Value::of(std::uint64_t{0}),
                opcua::Value::of(UtcTime{})};
    }

    void take(const opcua::Answer<opcua::CallResult>& answer) {
        attempt_.started = answer.has_value();
        check(answer ? opcua::status::kGood : answer.error().status);
    }

    void check(opcua::StatusCode status) {
        constexpr std::array allowed{opcua::status::kGood, opcua::status::kBadLocked,
                                     opcua::status::kBadInvalidState,
                                     opcua::status::kBadInvalidArgument};
        if (std::find(allowed.begin(), allowed.end(), status) == allowed.end()) {
            attempt_.defect = "unexpected answer " + status.name();
        }
    }

    std::unique_ptr<opcua::Client> client_;
    std::mt19937 random_;
    Attempt attempt_;
};

class Race {
public:
    explicit Race(const RaceOptions& options) : options_(options), echo_(bench_), plain_(bench_) {
        bench_.serve();
        for (std::size_t i = 0; i < options.clients; ++i) {
            racers_.push_back(
                std::make_unique<Racer>(connectAs(bench_.url(), fmt::format("racer {}", i + 1)),
                                        options.seed * 1'000 + static_cast<std::uint32_t>(i)));
        }
    }

    RaceReport run() {
        const auto begin = steady_clock::now();
        runRounds(plain_, options_.baseline_rounds, report_.baseline);
        runRounds(echo_, options_.rounds, report_.skill);
        report_.seconds = std::chrono::duration<double>(steady_clock::now() - begin).count();
        return std::move(report_);
    }

private:
    template <typename Raced>
    void runRounds(Raced& raced, std::uint64_t rounds, RaceCount& count) {
        const auto clients = static_cast<std::ptrdiff_t>(racers_.size());
        std::barrier<> gate(clients + 1);
        std::barrier<> meeting(clients);
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < racers_.size(); ++i) {
            threads.emplace_back([&, i] {
                for (std::uint64_t round = 0; round < rounds; ++round) {
                    gate.arrive_and_wait();
                    raceOnce(raced.track(), i, round, meeting);
                    gate.arrive_and_wait();
                }
            });
        }
        for (std::uint64_t round = 0; round < rounds; ++round) {
            gate.arrive_and_wait();
            gate.arrive_and_wait();
            judge(raced, count);
        }
    }

    void raceOnce(const Track& track, std::size_t racer, std::uint64_t round,
                  std::barrier<>& meeting) {
        const auto own = static_cast<std::int64_t>(round * racers_.size() + racer + 1);
        racers_[racer]->race(track, own, [&] {
            if (round % 2 == 1) {
                meeting.arrive_and_wait();
            }
        });
    }

    template <typename Raced>
    void judge(Raced& raced, RaceCount& count) {
        ++count.rounds;
        const auto starts = raced.endRound();
        const Attempt* winner = nullptr;
        bool entitled = false;
        for (const auto& racer : racers_) {
            const auto& attempt = racer->attempt();
            noteIf(!attempt.defect.empty(), attempt.defect);
            noteIf(attempt.started && winner != nullptr, "two starts were accepted");
            winner = attempt.started ? &attempt : winner;
            entitled = entitled || attempt.role != Role::only_starts;
        }
        noteIf(starts.size() != (winner == nullptr ? 0U : 1U), "starts and answers differ");
        if (winner == nullptr || starts.empty()) {
            noteIf(entitled, "nobody could start");
            return;
        }
        ++count.started;
        count.mixed += starts.front() == winner->given ? 0 : 1;
        if constexpr (std::is_same_v<Raced, EchoSkill>) {
            checkResult(starts.front(), count.rounds);
        }
    }

    /// Some client, each in its turn, sees the echo of what was started.
    void checkResult(Set expected, std::uint64_t round) {
        expected.back() = 0;
        const auto seen = echo_.resultSeenBy(racers_[round % racers_.size()]->client());
        noteIf(seen != expected, fmt::format("result {} of {}", toText(seen), toText(expected)));
    }

    void noteIf(bool wrong, std::string what) {
        if (wrong) {
            report_.defects.push_back(std::move(what));
        }
    }

    RaceOptions options_;
    BenchServer bench_;
    EchoSkill echo_;
    PlainProgram plain_;
    std::vector<std::unique_ptr<Racer>> racers_;
    RaceReport report_;
};

}  // namespace

Result<RaceReport> runRace(const RaceOptions& options) {
    try {
        return Race(options).run();
    } catch (const std::exception& error) {
        return fail(Errc::internal, error.what());
    }
}

}  // namespace metier::system_tests
