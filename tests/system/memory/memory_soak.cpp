// Memory that a server keeps of finished executions and of killed clients: none.
//
// metier_memory [CYCLES] [CRASHES]: a server in a process of its own gets so many executions, then
// so many clients that start a skill and are killed.
//
// Ends with status 1 if its memory grows by more than 1 MB per 100,000 executions, or by more than
// 1 MB over the clients, after a warm-up; or if it has more open files at the end.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "../bench_server.hpp"
#include "../hostile/target_process.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/link/child_process.hpp"

namespace {

using namespace metier;
using namespace std::chrono_literals;
using client::SkillHandle;
using hostile::TargetProcess;
using system_tests::orThrow;

constexpr double kLimit = 1'024.0;      // [kB]
constexpr double kPerExecutions = 1e5;  // grow by kLimit at most
constexpr auto kPatience = 60s;
constexpr const char* kClient = "--client";

SkillHandle openSkill(opcua::Client& client, const std::string& name) {
    return orThrow(SkillHandle::open(client, orThrow(client::findSkill(client, name))));
}

const skill::ValueMap kTarget{{"TargetJointPosition", std::vector<double>{0.1, 0.2}}};

/// Starts the long skill, which the one before may have left in any state, or throws.
std::string startLong(SkillHandle& skill) {
    static_cast<void>(skill.halt());
    static_cast<void>(skill.reset());
    const auto started = skill.startWith({.parameters = kTarget});
    return started ? "started" : started.error().message;
}

/// The client that is killed: it has started a skill, and receives its transitions. Sessions and
/// Subscriptions of earlier clients may have to run out first.
int runClient(const std::string& url) {
    std::string problem;
    for (const auto deadline = std::chrono::steady_clock::now() + kPatience;
         std::chrono::steady_clock::now() < deadline;) {
        try {
            const auto client = orThrow(opcua::Client::connect(url));
            auto skill = openSkill(*client, "Long");
            fmt::print("{}\n", startLong(skill));
            std::fflush(stdout);
            pause();
        } catch (const std::exception& error) {
            problem = error.what();
        }
    }
    throw std::runtime_error(problem);
}

/// A tenth, or what it takes to have as many Subscriptions at once as the server allows.
std::size_t warmUp(std::size_t steps) {
    return std::max(steps / 10, std::min<std::size_t>(80, steps / 2));
}

/// Kilobytes of the server by now, and what becomes of it.
class Memory {
public:
    Memory(const char* what, TargetProcess& target, std::size_t steps)
        : what_(what), target_(target), steps_(steps) {}

    void note(std::size_t step) {
        if (step == warmUp(steps_)) {
            warm_ = target_.residentKilobytes();
            warm_files_ = target_.descriptors();
        }
    }
    /// \param limit [kB]
    bool judge(double limit) {
        const auto end = target_.residentKilobytes();
        const auto grown = static_cast<double>(end) - static_cast<double>(warm_);
        const auto files = awaitFiles();
        const bool good = grown <= limit && files <= warm_files_ && target_.lives();
        fmt::print(
            "{} {}: {} kB when warm, {} kB at the end, grown {:.0f} kB of {:.0f} kB; "
            "{} and {} open files: {}\n",
            steps_, what_, warm_, end, grown, limit, warm_files_, files,
            good ? "bounded" : "NOT BOUNDED");
        return good;
    }

private:
    /// The server closes its end of a connection a moment after the client does.
    std::size_t awaitFiles() const {
        const auto deadline = std::chrono::steady_clock::now() + kPatience;
        while (target_.descriptors() > warm_files_ && std::chrono::steady_clock::now() < deadline) {
        }
        return target_.descriptors();
    }

    const char* what_;
    TargetProcess& target_;
    std::size_t steps_;
    std::size_t warm_ = 0;
    std::size_t warm_files_ = 0;
};

bool runExecutions(TargetProcess& target, std::size_t count) {
    const auto client = orThrow(opcua::Client::connect(target.url()));
    auto skill = openSkill(*client, "Brief");
    Memory memory("executions", target, count);
    for (std::size_t i = 0; i < count; ++i) {
        orThrow(skill.run(kTarget, std::chrono::steady_clock::now() + kPatience));
        memory.note(i);
    }
    return memory.judge(std::max(kLimit, kLimit * static_cast<double>(count) / kPerExecutions));
}

/// All sessions of those who were killed are over.
void awaitSilence(TargetProcess& target) {
    const auto client = orThrow(opcua::Client::connect(target.url()));
    const opcua::NodeId current_sessions(0, 2277U);
    while (orThrow(client->read(current_sessions)) != opcua::Value::of(std::uint32_t{1})) {
    }
}

bool runCrashes(TargetProcess& target, std::size_t count) {
    const auto self = std::filesystem::read_symlink("/proc/self/exe").string();
    Memory memory("killed clients", target, count);
    std::size_t started = 0;
    for (std::size_t i = 0; i < count; ++i) {
        auto client = orThrow(link::ChildProcess::start({self, kClient, target.url()}));
        const auto line = orThrow(client.readLine(std::chrono::steady_clock::now() + kPatience));
        client.signal(SIGKILL);
        started += line == "started" ? 1 : 0;
        if (i == warmUp(count)) {
            awaitSilence(target);
        }
        memory.note(i);
    }
    awaitSilence(target);
    fmt::print("{} of {} had started the skill\n", started, count);
    return memory.judge(kLimit) && started > count / 2;
}

int run(const std::vector<std::string>& arguments) {
    if (arguments.size() == 2 && arguments[0] == kClient) {
        return runClient(arguments[1]);
    }
    TargetProcess target;
    const auto count = [&](std::size_t at, std::size_t otherwise) {
        return arguments.size() > at ? std::stoull(arguments[at]) : otherwise;
    };
    const bool executions = runExecutions(target, count(0, 1'000'000));
    const bool crashes = runCrashes(target, count(1, 10'000));
    return executions && crashes ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run({argv + 1, argv + argc});
    } catch (const std::exception& error) {
        fmt::print(stderr, "metier_memory: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
