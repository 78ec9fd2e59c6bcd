// The server that is attacked, as a process: `metier_hostile_target [FOLDER]`. With a folder it is
// closed, with what security.hpp there says. It prints its address, and serves until it is ended.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "closed_server.hpp"

namespace {

using namespace metier;
using namespace metier::system_tests;

skill::SkillFunctions suspendable() {
    skill::SkillFunctions functions;
    functions.start = [](const skill::ValueMap&, const skill::ExecutionHandle&) {};
    functions.suspend = [](const skill::ExecutionHandle&) { return Result<void>(); };
    functions.resume = [](const skill::ExecutionHandle&) { return Result<void>(); };
    return functions;
}

/// A skill that nobody can reset once it is halted.
skill::SkillFunctions guarded() {
    skill::SkillFunctions functions;
    functions.reset = []() -> Result<void> {
        return fail(Errc::device_fault, "the arm stays where it is");
    };
    return functions;
}

void serve(int argc, char** argv) {
    BenchOptions options;
    options.limits.session_timeout = std::chrono::seconds(5);
    options.limits.subscriptions = 60;
    options.limits.monitored_items = 600;
    options.limits.event_queue = 100;
    if (argc > 1) {
        options.security = hostile::securityIn(argv[1]);
    }
    BenchServer server(std::move(options));
    server.addSkill(benchDescription("Brief"), {});
    server.addSkill(benchDescription("Long"), suspendable());
    server.addSkill(benchDescription("Guarded"), guarded());
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &ends, nullptr);
    server.serve();
    fmt::print("ready {}\n", server.url());
    std::fflush(stdout);
    int signal = 0;
    sigwait(&ends, &signal);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        serve(argc, argv);
        return EXIT_SUCCESS;
    } catch (const std::exception& error) {
        fmt::print(stderr, "hostile target: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
