// The test program as the processes of a cell: `serve CELL NAME` and `virtual CELL NAME` say that
// they are ready, write down what becomes of them, and behave as their name says.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace metier::server {
namespace {

using Arguments = std::vector<std::string>;

std::string valueOf(const Arguments& arguments, std::string_view option) {
    const auto found = std::find(arguments.begin(), arguments.end(), option);
    return found == arguments.end() || found + 1 == arguments.end() ? "" : *(found + 1);
}

/// Appends a line to the diary, which lies beside the cell file.
void note(const std::string& cell, const std::string& line) {
    const int file = open((cell + ".diary").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    const auto text = line + "\n";
    [[maybe_unused]] const auto count = write(file, text.data(), text.size());
    close(file);
}

void say(const std::string& line) {
    std::puts(line.c_str());
    std::fflush(stdout);
}

int awaitEnd() {
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    int signal = 0;
    sigwait(&ends, &signal);
    return signal;
}

int serve(const Arguments& arguments) {
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    sigprocmask(SIG_BLOCK, &ends, nullptr);
    const auto& cell = arguments.at(1);
    const auto& name = arguments.at(2);
    const auto again = valueOf(arguments, "--again-at");
    note(cell, name + " starts" + (again.empty() ? "" : " at " + again));
    if (name == "refused") {
        say("this is no ready line");
    } else if (name == "failing" || (name == "once" && !again.empty())) {
        return 3;
    } else if (name != "slow") {
        say("ready opc.tcp://127.0.0.1:" +
            (again.empty() ? std::to_string(20'000 + getpid() % 40'000) : again));
    }
    awaitEnd();
    note(cell, name + " ends");
    return 0;
}

int runVirtual(const Arguments& arguments) {
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    sigprocmask(SIG_BLOCK, &ends, nullptr);
    const auto& cell = arguments.at(1);
    const auto& name = arguments.at(2);
    say("ready virtual " + name + ":7400");
    awaitEnd();
    note(cell, name + " ends");
    return 0;
}

}  // namespace
}  // namespace metier::server

int main(int argc, char** argv) {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    if (!arguments.empty() && arguments.front() == "serve") {
        return metier::server::serve(arguments);
    }
    if (!arguments.empty() && arguments.front() == "virtual") {
        return metier::server::runVirtual(arguments);
    }
    ::testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
