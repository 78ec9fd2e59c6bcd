// End of a cell: by a signal, with its terminal, when `metier up` is killed, while it starts, and
// the consequences when one of its processes ends.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <utility>
#include <vector>

#include "metier/cell/cell.hpp"
#include "metier/link/tcp_link.hpp"
#include "metier_program.hpp"
#include "running_cell.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::State;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// A process that is watched until it ends, even if its parent changes.
class WatchedProcess {
public:
    explicit WatchedProcess(pid_t pid)
        : pid_(pid), handle_(static_cast<int>(syscall(SYS_pidfd_open, pid, 0))) {}
    WatchedProcess(WatchedProcess&& other) noexcept
        : pid_(other.pid_), handle_(std::exchange(other.handle_, -1)) {}
    WatchedProcess& operator=(WatchedProcess&&) = delete;
    ~WatchedProcess() {
        if (handle_ >= 0) {
            close(handle_);
        }
    }
    bool endsWithin(std::chrono::milliseconds longest) const {
        pollfd request{handle_, POLLIN, 0};
        return handle_ >= 0 && poll(&request, 1, static_cast<int>(longest.count())) == 1;
    }
    pid_t pid() const { return pid_; }

private:
    pid_t pid_;
    int handle_;
};

/// Every process below one, the guards of the servers included.
void addDescendants(pid_t pid, std::vector<WatchedProcess>& found) {
    const auto tasks = fmt::format("/proc/{}/task", pid);
    for (const auto& task : std::filesystem::directory_iterator(tasks)) {
        std::ifstream children(task.path() / "children");
        for (pid_t child = 0; children >> child;) {
            found.emplace_back(child);
            addDescendants(child, found);
        }
    }
}

std::vector<WatchedProcess> descendants(pid_t pid) {
    std::vector<WatchedProcess> found;
    addDescendants(pid, found);
    return found;
}

std::filesystem::path deathCell(const std::string& arm) {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "deaths" /
           (arm + ".toml");
}

/// A move of some seconds that is under way.
void startLongMove(Watched& move) {
    const auto home = jointPosition(move.client(), *move);
    auto target = home;
    target.front() += 0.6;
    ASSERT_TRUE(move->set("TargetJointPosition", target));
    ASSERT_TRUE(move->set("SpeedOverride", 0.05));
    const auto started = move->start();
    ASSERT_TRUE(started) << started.error().message;
    awaitMotion(move.client(), *move, home);
}

struct EndCase {
    const char* arm;
    int signal;  ///< sent to `metier up`
};

void PrintTo(const EndCase& end, std::ostream* out) {
    *out << end.arm << " " << end.signal;
}

std::string nameOf(const ::testing::TestParamInfo<EndCase>& info) {
    return fmt::format("{}_SIG{}", info.param.arm, sigabbrev_np(info.param.signal));
}

class CellEnd : public ::testing::TestWithParam<EndCase> {};

// The terminal's end and kill -9 of `metier up` killed every server, and its arm with it.
TEST_P(CellEnd, BrakesWhatMovesAndLeavesNoProcess) {
    RunningCell cell(deathCell(GetParam().arm));
    Watched move(cell.url("arm"), "JointPtpMoveSkill");
    startLongMove(move);
    if (HasFatalFailure()) {
        return;
    }
    const auto processes = descendants(cell.process().pid());
    const bool guarded = std::string_view(GetParam().arm) == "iiwa";
    EXPECT_THAT(processes, SizeIs(cell.size() + (guarded ? 1 : 0)));
    cell.process().signal(GetParam().signal);
    const auto halted = move.awaitEvent(State::halted);
    EXPECT_EQ(halted.reason, skill::Reason::error);
    EXPECT_EQ(halted.reason_text, "the server is ended") << "its controller ended before it";
    for (const auto& process : processes) {
        EXPECT_TRUE(process.endsWithin(10s)) << process.pid();
    }
    const auto status = cell.process().waitUntil(inAMinute());
    EXPECT_EQ(status, GetParam().signal == SIGKILL ? 128 + SIGKILL : 0);
}

INSTANTIATE_TEST_SUITE_P(Signals, CellEnd,
                         ::testing::Values(EndCase{"iiwa", SIGTERM}, EndCase{"iiwa", SIGHUP},
                                           EndCase{"iiwa", SIGKILL}, EndCase{"edo", SIGHUP},
                                           EndCase{"edo", SIGKILL}),
                         nameOf);

TEST(ServerEnd, BrakesWhenItsTerminalCloses) {
    ServerProcess robot("iiwa");
    Watched move(robot.url(), "JointPtpMoveSkill");
    startLongMove(move);
    robot.signal(SIGHUP);
    EXPECT_EQ(move.awaitEvent(State::halted).reason_text, "the server is ended");
}

/// `metier up` with its log, which a test reads.
class LoggedCell {
public:
    explicit LoggedCell(const std::filesystem::path& file,
                        const std::vector<std::string>& more = {})
        : process_(link::ChildProcess::start(commandFor(file, more), link::ErrorOutput::with_output)
                       .value()) {
        said_ = readTo("the cell is up");
    }
    link::ChildProcess& process() { return process_; }
    /// All lines until it was up.
    const std::string& said() const { return said_; }
    /// The address of a server, as it was printed.
    std::string url(const std::string& server) const {
        const auto line = said_.find("\n" + server + " ");
        const auto begin = said_.find("opc.tcp://", line);
        return said_.substr(begin, said_.find('\n', begin) - begin);
    }
    /// Lines up to one with that text.
    std::string readTo(const std::string& text) {
        std::string seen = "\n";
        for (auto line = process_.readLine(inAMinute()); line;
             line = process_.readLine(inAMinute())) {
            seen += *line + "\n";
            if (line->find(text) != std::string::npos) {
                return seen;
            }
        }
        throw std::runtime_error("no '" + text + "' in: " + seen);
    }
    std::string readToEnd() {
        std::string seen;
        for (auto line = process_.readLine(inAMinute()); line;
             line = process_.readLine(inAMinute())) {
            seen += *line + "\n";
        }
        return seen;
    }
    /// The process that serves there.
    pid_t pidOf(const std::string& server) {
        for (const auto& process : descendants(process_.pid())) {
            std::ifstream file(fmt::format("/proc/{}/cmdline", process.pid()));
            const std::string line{std::istreambuf_iterator<char>(file), {}};
            const std::string option("--server\0", 9);
            if (line.find(option + server + '\0') != std::string::npos) {
                return process.pid();
            }
        }
        throw std::runtime_error("no process of " + server);
    }

private:
    static std::vector<std::string> commandFor(const std::filesystem::path& file,
                                               const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"up", file.string(), "--free-ports"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return metierCommand(arguments);
    }

    link::ChildProcess process_;
    std::string said_;
};

// It warned of a link that it cut itself, and of the lab once for every server.
TEST(CellEnd, SaysNothingOfLinksThatItCutsItself) {
    LoggedCell cell(deathCell("edo"));
    const std::string lab = "INSECURE LAB";
    const auto first = cell.said().find(lab);
    ASSERT_NE(first, std::string::npos);
    EXPECT_EQ(cell.said().find(lab, first + 1), std::string::npos) << cell.said();
    cell.process().signal(SIGTERM);
    EXPECT_EQ(cell.readToEnd(), "");
    EXPECT_EQ(cell.process().waitUntil(inAMinute()), 0);
}

// It went down as a whole when one server died.
TEST(CellRestart, StartsAServerAgainAndNothingMovesByItself) {
    LoggedCell cell(deathCell("iiwa"));
    const auto url = cell.url("arm");
    std::vector<double> before;
    {
        Watched move(url, "JointPtpMoveSkill");
        startLongMove(move);
    }
    const auto controller = descendants(cell.process().pid()).front().pid();
    ASSERT_EQ(kill(cell.pidOf("arm"), SIGKILL), 0);
    EXPECT_THAT(cell.readTo("'arm'"),
                HasSubstr("metier: 'arm' was ended by signal 9 (Killed); it is started again in "
                          "0.5 s"));
    EXPECT_THAT(cell.readTo("is back"), HasSubstr("metier: 'arm' is back at " + url));
    Watched move(url, "JointPtpMoveSkill");
    ASSERT_TRUE(move->awaitState(State::ready, inAMinute())) << move->reasonText();
    const auto resting = jointPosition(move.client(), *move);
    auto target = resting;
    target.back() += 0.1;
    const auto moved = move->run({{"TargetJointPosition", target}}, inAMinute());
    ASSERT_TRUE(moved) << moved.error().message;
    for (std::size_t axis = 0; axis + 1 < resting.size(); ++axis) {
        EXPECT_NEAR(jointPosition(move.client(), *move)[axis], resting[axis], 1e-3)
            << "the killed move went on in axis " << axis + 1;
    }
    EXPECT_EQ(descendants(cell.process().pid()).front().pid(), controller) << "the others stay";
}

TEST(CellRestart, WaitsLongerAfterEveryEnd) {
    LoggedCell cell(deathCell("iiwa"));
    for (const auto* pause : {"0.5 s", "1 s", "2 s"}) {
        ASSERT_EQ(kill(cell.pidOf("arm"), SIGKILL), 0);
        EXPECT_THAT(cell.readTo("'arm' was ended"), HasSubstr(std::string("again in ") + pause));
        cell.readTo("'arm' is back");
    }
}

// The component of the iiwa and its gripper alone was taken for dead after 0.25 s.
TEST(DemoCells, AllowEveryServerOfABusyComputerASecond) {
    for (const auto* file : {"demo.toml", "pick_and_place.toml"}) {
        const auto cell = cell::loadCell(std::filesystem::path(METIER_SOURCE_DIR) / "cells" / file);
        ASSERT_TRUE(cell) << cell.error().message;
        for (const auto& server : cell->servers) {
            EXPECT_EQ(server.stall_limit, 1.0) << file << ": " << server.name;
        }
    }
}

/// A peer for which a program waits when it gets its signal: it takes connections and never says
/// a word.
struct SilentPeer {
    explicit SilentPeer(std::uint16_t port)
        : address(fmt::format("127.{}.{}.1", 1 + getpid() / 250 % 250, 1 + getpid() % 250)),
          listener(link::TcpListener::listen(address, port).value()) {}
    /// Waits until a client has connected.
    link::TcpLink awaitCaller() { return listener.accept(inAMinute()).value(); }

    std::string address;
    link::TcpListener listener;
};

/// A program that waits for `peer` ends at SIGTERM, which takes much less than a second on a
/// machine that does nothing else.
void expectPromptEnd(const std::vector<std::string>& arguments, SilentPeer& peer) {
    auto program =
        link::ChildProcess::start(metierCommand(arguments), link::ErrorOutput::with_output).value();
    const auto caller = peer.awaitCaller();
    const auto processes = descendants(program.pid());
    const auto told = std::chrono::steady_clock::now();
    program.signal(SIGTERM);
    EXPECT_EQ(program.waitUntil(inAMinute()), 1);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - told;
    EXPECT_LT(took.count(), 10.0) << "it waits for 30 s otherwise";
    for (const auto& process : processes) {
        EXPECT_TRUE(process.endsWithin(10s)) << process.pid();
    }
    std::string said;
    for (auto line = program.readLine(inAMinute()); line; line = program.readLine(inAMinute())) {
        said += *line;
    }
    EXPECT_THAT(said, HasSubstr("stopped before"));
}

// They waited for up to 30 s with the signal blocked.
TEST(StopWhileStarting, EndsAServerThatAwaitsItsController) {
    constexpr std::uint16_t kRtde = 30004;
    SilentPeer peer(kRtde);
    expectPromptEnd({"serve", deathCell("ur5").string(), "--server", "arm", "--port", "0",
                     "--controller", peer.address},
                    peer);
}

TEST(StopWhileStarting, EndsAWholeCell) {
    constexpr std::uint16_t kRtde = 30004;
    SilentPeer peer(kRtde);
    const auto file =
        std::filesystem::path(::testing::TempDir()) / fmt::format("waiting_{}.toml", getpid());
    std::ofstream(file) << fmt::format(R"(name = "waiting"
[[server]]
name = "first"
kind = "arm"
driver = {{ type = "simulator" }}
model = "{0}/models/iiwa7.toml"
skills = ["JointPtpMoveSkill"]
[[server]]
name = "arm"
kind = "arm"
driver = {{ type = "ur", controller = "{1}" }}
model = "{0}/models/ur5.toml"
skills = ["JointPtpMoveSkill"]
)",
                                       METIER_SOURCE_DIR, peer.address);
    expectPromptEnd({"up", file.string(), "--free-ports"}, peer);
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace metier::system_tests
