#include "metier/server/cell_runner.hpp"

#include <gmock/gmock.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill() is POSIX, not in <csignal>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <stop_token>
#include <thread>

namespace metier::server {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Key;
using ::testing::Pair;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

/// This program in the roles of servers and virtual controllers (fake_processes.cpp).
class FakeCommands final : public CellCommands {
public:
    explicit FakeCommands(const cell::CellConfig& cell) : cell_(cell) {}

    CellCommand of(const cell::VirtualController& controller,
                   const CellAddresses& known) const override {
        known_of_[controller.name] = known;
        return {{"/proc/self/exe", "virtual", cell_.file.string(), controller.name}};
    }
    CellCommand of(const cell::ServerConfig& server, const CellAddresses& known) const override {
        known_of_[server.name] = known;
        return {{"/proc/self/exe", "serve", cell_.file.string(), server.name}, "--again-at"};
    }
    /// Addresses that were known when the command of that process was asked for.
    const CellAddresses& knownOf(const std::string& name) const { return known_of_.at(name); }

private:
    const cell::CellConfig& cell_;
    mutable std::map<std::string, CellAddresses> known_of_;
};

/// A cell of processes that only say that they are ready.
class CellOfFakes : public ::testing::Test {
protected:
    CellOfFakes() {
        static std::atomic<int> count = 0;
        cell_.file = std::filesystem::path(::testing::TempDir()) /
                     (std::to_string(getpid()) + "_" + std::to_string(++count) + ".toml");
        std::filesystem::remove(diaryFile());
    }
    ~CellOfFakes() override {
        close(wake_);
        std::filesystem::remove(diaryFile());
    }

    template <typename Kind = cell::ArmServer>
    void add(const std::string& name) {
        cell::ServerConfig server;
        server.name = name;
        server.kind = Kind();
        cell_.servers.push_back(server);
    }
    void addVirtual(const std::string& name, const std::string& type) {
        cell::VirtualController controller;
        controller.name = name;
        controller.type = type;
        cell_.virtual_controllers.push_back(controller);
    }
    Result<CellRunner> start(int stop_descriptor = -1) {
        return CellRunner::start(
            cell_, commands_, stop_descriptor,
            [this](const CellRunner::Running& server) { ready_.push_back(server.name); });
    }
    /// Output of the processes.
    std::vector<std::string> diary(const std::string& what = "") const {
        std::vector<std::string> lines;
        std::ifstream file(diaryFile());
        for (std::string line; std::getline(file, line);) {
            if (line.find(what) != std::string::npos) {
                lines.push_back(line);
            }
        }
        return lines;
    }
    void wake() const { eventfd_write(wake_, 1); }
    /// Looks after the cell until something was said with that text.
    std::string lookAfterUntil(CellRunner& cell, const std::string& text) {
        std::string seen;
        cell.lookAfter(wake_, OnFailure::restart, [&](const std::string& line) {
            seen += line + "\n";
            if (line.find(text) != std::string::npos) {
                wake();
            }
        });
        eventfd_t rung = 0;
        eventfd_read(wake_, &rung);
        return seen;
    }
    /// Kills the process of a server as a crash does.
    static void killServer(const std::string& name) {
        for (const auto& process : std::filesystem::directory_iterator("/proc")) {
            std::ifstream file(process.path() / "cmdline");
            const std::string line{std::istreambuf_iterator<char>(file), {}};
            std::ifstream stat(process.path() / "stat");
            std::string word;
            pid_t pid = 0;
            pid_t parent = 0;
            stat >> pid >> word >> word >> parent;
            if (parent == getpid() && line.find(name) != std::string::npos) {
                kill(pid, SIGKILL);
            }
        }
    }

    std::filesystem::path diaryFile() const { return cell_.file.string() + ".diary"; }

    cell::CellConfig cell_;
    FakeCommands commands_{cell_};
    std::vector<std::string> ready_;
    int wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
};

TEST_F(CellOfFakes, StartsWhatOthersUseBeforeThemAndEndsItAfterThem) {
    add<cell::CompositionServer>("composed");
    add<cell::SynchronizedServer>("both");
    add<cell::MoveComponent>("arm-move");
    add("arm");
    addVirtual("controller", "ur");
    addVirtual("world", "world");
    {
        const auto cell = start();
        ASSERT_TRUE(cell) << cell.error().message;
        EXPECT_THAT(ready_, ElementsAre("arm", "arm-move", "both", "composed"));
    }
    EXPECT_THAT(diary("ends"), ElementsAre("composed ends", "both ends", "arm-move ends",
                                           "arm ends", "controller ends", "world ends"));
}

TEST_F(CellOfFakes, TellsEachCommandTheAddressesOfThoseBefore) {
    add<cell::CompositionServer>("composed");
    add("arm");
    addVirtual("controller", "ur");
    addVirtual("world", "world");
    const auto cell = start();
    ASSERT_TRUE(cell) << cell.error().message;
    EXPECT_TRUE(commands_.knownOf("world").controllers.empty());
    EXPECT_THAT(commands_.knownOf("controller").controllers, UnorderedElementsAre(Key("world")));
    EXPECT_THAT(commands_.knownOf("arm").controllers,
                UnorderedElementsAre(Key("world"), Pair("controller", "controller:7400")));
    EXPECT_TRUE(commands_.knownOf("arm").servers.empty());
    const auto& arm = cell->servers().front();
    EXPECT_THAT(commands_.knownOf("composed").servers, UnorderedElementsAre(Pair("arm", arm.url)));
    EXPECT_EQ(cell->virtualControllers().at("controller"), "controller:7400");
}

TEST_F(CellOfFakes, StartsArmsBeforeGrippers) {
    add<cell::GripperServer>("hand");
    add("arm");
    const auto cell = start();
    ASSERT_TRUE(cell) << cell.error().message;
    EXPECT_THAT(ready_, ElementsAre("arm", "hand"));
}

TEST_F(CellOfFakes, StartsAServerThatEndedAgainAtItsPort) {
    add("arm");
    add("other");
    auto cell = start();
    ASSERT_TRUE(cell) << cell.error().message;
    const auto url = cell->servers().front().url;
    killServer("arm");
    const auto said = lookAfterUntil(*cell, "is back");
    EXPECT_THAT(said, StartsWith("'arm' was ended by signal 9 (Killed); it is started again in "
                                 "0.5 s\n'arm' is back at " +
                                 url));
    EXPECT_THAT(diary("starts"), ElementsAre("arm starts", "other starts",
                                             "arm starts at " + url.substr(url.rfind(':') + 1)));
    EXPECT_TRUE(diary("ends").empty()) << "the other one stays";
}

TEST_F(CellOfFakes, WaitsLongerForAServerThatDoesNotComeBack) {
    add("once");
    auto cell = start();
    ASSERT_TRUE(cell) << cell.error().message;
    killServer("once");
    EXPECT_THAT(lookAfterUntil(*cell, "again in 2 s"),
                HasSubstr("'once' ended with status 3; it is started again in 1 s\n"));
}

TEST_F(CellOfFakes, EndsWithAServerIfItIsToldTo) {
    add("arm");
    add("other");
    auto cell = start();
    ASSERT_TRUE(cell) << cell.error().message;
    killServer("other");
    const auto ended = cell->lookAfter(wake_, OnFailure::end_cell,
                                       [](const std::string& line) { FAIL() << line; });
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->name, "other");
    EXPECT_EQ(ended->how, "was ended by signal 9 (Killed)");
}

TEST_F(CellOfFakes, SaysWhyAServerIsNotReady) {
    add("failing");
    const auto failed = start();
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().message, "'failing' did not become ready: it ended with status 3");
    cell_.servers.clear();
    add("refused");
    const auto refused = start();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message,
              "'refused' did not become ready: it said: this is no ready line");
}

TEST_F(CellOfFakes, EndsAtOnceWhileAServerStarts) {
    add("arm");
    add("slow");
    std::jthread later([this](const std::stop_token& stop) {
        while (diary("slow starts").empty() && !stop.stop_requested()) {
            std::this_thread::yield();
        }
        wake();
    });
    const auto stopped = start(wake_);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, Errc::cancelled);
    EXPECT_THAT(stopped.error().message, HasSubstr("'slow' was not ready yet"));
    EXPECT_THAT(diary("ends"), UnorderedElementsAre("slow ends", "arm ends"));
}

}  // namespace
}  // namespace metier::server
