// Making and opening a store: by several at once, and one of a version before.
#include "schema.hpp"

#include <fstream>
#include <latch>
#include <sstream>
#include <thread>

#include "either_database.hpp"
#include "metier/link/child_process.hpp"
#include "sqlite_database.hpp"
#include "wrapped_database.hpp"

namespace metier::records {
namespace {

using link::ChildProcess;

class NewStore : public EitherDatabase {};
INSTANTIATE_EITHER(NewStore);

/// Opens the store from so many threads in the same moment. \return the errors
std::vector<std::string> openAtOnce(const std::string& url, std::size_t count) {
    std::vector<std::string> errors(count);
    std::latch all_here(static_cast<std::ptrdiff_t>(count));
    std::vector<std::jthread> threads;
    for (auto& error : errors) {
        threads.emplace_back([&] {
            all_here.arrive_and_wait();
            const auto store = Store::open(url, Store::Access::write);
            error = store ? "" : store.error().message;
        });
    }
    threads.clear();
    return errors;
}

TEST_P(NewStore, IsMadeByAnyNumberOfThreadsAtOnce) {
    const int rounds = isFile() ? 10 : 4;
    for (int round = 0; round < rounds; ++round) {
        const auto url = round == 0 ? url_ : fresh();
        EXPECT_THAT(openAtOnce(url, 4), ::testing::Each("")) << round;
        EXPECT_TRUE(Store::open(url));
    }
}

TEST_P(NewStore, IsMadeByServersThatStartAtOnce) {
    const int rounds = isFile() ? 4 : 2;
    for (int round = 0; round < rounds; ++round) {
        const auto url = round == 0 ? url_ : fresh();
        std::vector<ChildProcess> servers;
        for (const auto* name : {"one", "two", "three", "four"}) {
            servers.push_back(ChildProcess::start({METIER_RECORDS_WRITER, url, name, "1"}).value());
        }
        for (auto& server : servers) {
            EXPECT_EQ(server.readLine(soon()).value_or("nothing"), "ready") << "no alarm before";
            EXPECT_EQ(server.waitUntil(soon()), 0);
        }
        EXPECT_EQ(Store::open(url).value()->list({}, {})->executions.size(), 4U);
    }
}

TEST_P(NewStore, IsMadeByAnotherServerWhileThisOneLooks) {
    for (const auto access : {Store::Access::write, Store::Access::read}) {
        const auto url = access == Store::Access::write ? url_ : fresh();
        const auto database = connect(url, Store::Access::write).value();
        RacedDatabase raced(*database,
                            [&url] { EXPECT_TRUE(Store::open(url, Store::Access::write)); });
        const auto prepared = prepareSchema(raced, access);
        const bool not_there =
            !prepared && prepared.error().code == Errc::not_found && access == Store::Access::read;
        EXPECT_TRUE(prepared || not_there) << prepared.error().message;
        EXPECT_TRUE(prepareSchema(*database, access));
    }
}

TEST_P(NewStore, IsNotChangedByWhoOnlyReads) {
    const auto url = fresh();
    ASSERT_TRUE(Store::open(url, Store::Access::write));
    const auto reader = connect(url, Store::Access::read);
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_FALSE((*reader)->script("DELETE FROM executions"));
    EXPECT_TRUE((*reader)->query("SELECT count(*) FROM executions", {}));
}

/// Executes what metier of the version before has left.
void makeOldStore(const std::string& file) {
    std::ifstream in(std::string(METIER_RECORDS_TESTS) + "/store_of_version_1.sql");
    std::stringstream sql;
    sql << in.rdbuf();
    const auto database = SqliteDatabase::open(file, Store::Access::write).value();
    const auto made = database->script(sql.str());
    ASSERT_TRUE(made) << made.error().message;
}

TEST(OldStore, IsReadAndContinued) {
    const auto file = (testFolder() / "records.db").string();
    makeOldStore(file);
    {
        const auto reading = Store::open(file);
        ASSERT_TRUE(reading) << reading.error().message;
        EXPECT_EQ((*reading)->list({}, {})->executions.size(), 3U);
    }
    const auto recorder = recorderOf(file);
    recordOne(*recorder, moveOf("new"), finished(at(1)));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto store = Store::open(file).value();
    const auto first = store->find("urn:test:ur5-1").value();
    EXPECT_EQ(first.state, "Ready");
    EXPECT_EQ(first.parameters, R"({"MaxVelocity":[1.0]})");
    EXPECT_EQ(first.check, R"({"possible":true})");
    const auto transitions = store->transitions(first.number).value();
    ASSERT_EQ(transitions.size(), 2U);
    EXPECT_EQ(transitions[1].sub_state, "ReadyNotConfigured");
    EXPECT_EQ(store->intermediates(first.number)->front().value, "0.5");
    EXPECT_EQ(store->path(first.number)->front().actual[1], -1.0);
    EXPECT_EQ(store->find("urn:test:ur5-3")->state, kLost);
    EXPECT_EQ(store->find("new")->number, 4);
}

TEST_P(NewStore, LosesTheBacklogOfAVersionBefore) {
    {
        const auto database = openDatabase(url_, Store::Access::write).value();
        ASSERT_TRUE(database->script("CREATE TABLE backlog (life BIGINT, number BIGINT)"));
    }
    EXPECT_TRUE(Store::open(url_));
    const auto database = openDatabase(url_, Store::Access::write).value();
    EXPECT_FALSE(database->query("SELECT * FROM backlog"));
    EXPECT_TRUE(database->query("SELECT * FROM executions"));
}

}  // namespace
}  // namespace metier::records
