// Servers with one store while other programs use every core.
#include <chrono>
#include <csignal>
#include <thread>

#include "metier/link/child_process.hpp"
#include "recorded.hpp"
#include "temporary_postgres.hpp"

namespace metier::records {
namespace {

using link::ChildProcess;

/// Programs that leave no core idle, as a compiler does.
class BusyMachine {
public:
    BusyMachine() {
        for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i) {
            threads_.emplace_back([](const std::stop_token& stop) {
                while (!stop.stop_requested()) {
                }
            });
        }
    }

private:
    std::vector<std::jthread> threads_;
};

void expectFourWithoutAlarms(const std::string& url) {
    const BusyMachine busy;
    std::vector<ChildProcess> servers;
    for (const auto* name : {"one", "two", "three", "four"}) {
        servers.push_back(ChildProcess::start({METIER_RECORDS_WRITER, url, name, "0"}).value());
    }
    const auto readLines = [](ChildProcess& server, int count) {
        for (int i = 0; i < count; ++i) {
            const auto line = server.readLine(soon()).value_or("nothing");
            EXPECT_EQ(line.find("health"), std::string::npos) << line;
        }
    };
    constexpr int kLines = 400;  // 2 s
    for (auto& server : servers) {
        EXPECT_EQ(server.readLine(soon()).value_or("nothing"), "ready");
        readLines(server, kLines);
    }
    const auto store = Store::open(url).value();
    const auto end = soon();
    while (!(store->find("one-1") && store->find("four-1")) &&
           std::chrono::steady_clock::now() < end) {
        for (auto& server : servers) {  // the writing threads have a low priority
            readLines(server, 1);
        }
    }
    for (auto& server : servers) {
        server.signal(SIGKILL);
        EXPECT_EQ(server.waitUntil(soon()), 128 + SIGKILL);
    }
    EXPECT_TRUE(store->find("one-1"));
    EXPECT_TRUE(store->find("four-1"));
}

TEST(FourServersOfABusyMachine, ShareAFileWithoutAnAlarm) {
    expectFourWithoutAlarms((testFolder() / "records.db").string());
}

TEST(FourServersOfABusyMachine, ShareADatabaseWithoutAnAlarm) {
    auto* postgres = TemporaryPostgres::instance();
    if (postgres == nullptr) {
        GTEST_SKIP() << "PostgreSQL is not installed";
    }
    expectFourWithoutAlarms(postgres->freshDatabase());
}

}  // namespace
}  // namespace metier::records
