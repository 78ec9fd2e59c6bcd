// What comes faster than rows are made of it: in the store as it was told, whatever happens next.
#include "backlog.hpp"

#include <atomic>
#include <csignal>
#include <functional>
#include <map>
#include <thread>
#include <utility>

#include "deaf_database.hpp"
#include "lateness.hpp"
#include "metier/process/child_process.hpp"
#include "metier/records/recorder.hpp"
#include "recorded.hpp"
#include "temporary_postgres.hpp"
#include "writer.hpp"

namespace metier::records {
namespace {

using namespace std::chrono_literals;
using process::ChildProcess;

/// Takes all and keeps the ids.
struct Ids final : MessageTaker {
    void take(Recorder::Key /*key*/, Execution&& e) override { ids.push_back(e.id); }
    void take(Recorder::Key /*key*/, Transition&& /*t*/) override {}
    void take(Recorder::Key /*key*/, Intermediate&& /*i*/) override {}
    void take(Recorder::Key /*key*/, Outcome&& /*o*/) override { ++ended; }

    std::vector<std::string> ids;
    int ended = 0;
};

Told toldOfThree() {
    MessageLog log;
    for (Recorder::Key key = 1; key <= 3; ++key) {
        log.put(key, moveOf("m-" + std::to_string(key)));
        log.put(key, finished(at(7)));
    }
    Told told;
    makeTold(log, {{2, sampleAt(0.5, 1.5)}, {3, sampleAt(0.6, 1.6)}}, told);
    return told;
}

TEST(ToldContent, ComesBackAsItWasTold) {
    const auto told = toldOfThree();
    EXPECT_EQ(told.messages, 6U);
    Ids taken;
    std::vector<KeyedSample> samples;
    ASSERT_EQ(giveTold(told.content, taken, samples), 0U);
    EXPECT_THAT(taken.ids, ::testing::ElementsAre("m-1", "m-2", "m-3"));
    EXPECT_EQ(taken.ended, 3);
    ASSERT_EQ(samples.size(), 2U);
    EXPECT_EQ(samples[1].key, 3U);
    EXPECT_EQ(samples[1].sample.actual, sampleAt(0.6, 1.6).actual);
}

TEST(ToldContent, MayBeAnyBytes) {
    const auto told = toldOfThree();
    std::size_t whole = 0;
    for (std::size_t i = 0; i < told.content.size(); ++i) {
        for (const auto bit : {0x01, 0x80, 0xFF}) {
            auto damaged = told.content;
            damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ bit);
            Ids taken;
            std::vector<KeyedSample> samples;
            whole += giveTold(damaged, taken, samples) == 0 ? 1 : 0;
            EXPECT_LE(taken.ids.size(), 6U);
        }
        Ids taken;
        std::vector<KeyedSample> samples;
        const auto cut = std::span(told.content).first(i);
        EXPECT_FALSE(giveTold(cut, taken, samples) == 0 && samples.size() == 2);
        EXPECT_LE(taken.ids.size(), 3U);
    }
    EXPECT_LT(whole, 3 * told.content.size());
}

TEST(ToldContent, TellsHowManyMessagesAreMissing) {
    const auto told = toldOfThree();
    MessageLog log;
    log.put(1, moveOf("m-1"));
    Told shorter;
    makeTold(log, {}, shorter);
    auto content = told.content;
    content.resize(shorter.content.size() + 1);  // the first message, and the size of all
    std::copy(shorter.content.begin() + 12, shorter.content.begin() + 20, content.begin() + 12);
    Ids taken;
    std::vector<KeyedSample> samples;
    EXPECT_EQ(giveTold(content, taken, samples), 5U) << "of " << told.messages;
    EXPECT_THAT(taken.ids, ::testing::ElementsAre("m-1"));
}

TEST(ToldContent, OfAnotherVersionIsLeftAlone) {
    auto told = toldOfThree();
    EXPECT_FALSE(isOfAnotherVersion(told.content));
    ++told.content.front();
    EXPECT_TRUE(isOfAnotherVersion(told.content));
    Ids taken;
    std::vector<KeyedSample> samples;
    EXPECT_NE(giveTold(told.content, taken, samples), 0U);
    EXPECT_TRUE(taken.ids.empty());
    EXPECT_FALSE(isOfAnotherVersion(Bytes{1, 2, 3})) << "that is damaged";
    EXPECT_FALSE(isOfAnotherVersion(Bytes{1, 2, 3, 4}));
}

class EitherBacklog : public ::testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        if (GetParam() == std::string("Sqlite")) {
            url_ = (testFolder() / "records.db").string();
        } else if (auto* postgres = TemporaryPostgres::instance()) {
            url_ = postgres->freshDatabase();
            flood_ = 5'000;
        } else {
            GTEST_SKIP() << "PostgreSQL is not installed";
        }
    }
    std::unique_ptr<Recorder> recorder(const std::string& server) const {
        return recorderOf(url_, server, 100'000);
    }
    void flood(Recorder& recorder, const std::string& name) const {
        for (int i = 1; i <= flood_; ++i) {
            const auto key = recorder.begin(moveOf(name + "-" + std::to_string(i)),
                                            {.time = at(1), .from = "Ready", .to = "Running"});
            recorder.end(key, finished(at(2)), {.time = at(2), .from = "Running", .to = "Ready"});
        }
    }
    std::int64_t number(const std::string& sql) {
        if (database_ == nullptr) {
            database_ = openDatabase(url_, Store::Access::write).value();
        }
        return database_->query(sql, {}).value().front().integer(0);
    }
    std::int64_t pieces() { return number("SELECT count(*) FROM backlog"); }
    std::int64_t rows() { return number("SELECT count(*) FROM executions"); }
    static void await(const std::function<bool()>& condition) {
        const auto deadline = soon();
        while (!condition()) {
            if (std::chrono::steady_clock::now() > deadline) {
                throw std::runtime_error("it does not come");
            }
        }
    }
    /// A server of that name that is flooded; killed when `is_time`.
    std::map<std::string, UtcTime> killWhen(const std::function<bool()>& is_time,
                                            const std::string& how, UtcTime& killed) {
        auto dying = ChildProcess::start({METIER_RECORDS_WRITER, url_, "dying", how}).value();
        static_cast<void>(dying.readLine(soon()));
        await(is_time);
        dying.signal(SIGKILL);
        killed = std::chrono::system_clock::now();
        EXPECT_EQ(dying.waitUntil(soon()), 128 + SIGKILL);
        std::map<std::string, UtcTime> told;
        while (const auto line = dying.readLine(soon())) {
            const auto space = line->find(' ');
            told[line->substr(0, space)] =
                UtcTime(std::chrono::microseconds(std::stoll(line->substr(space + 1))));
        }
        return told;
    }
    /// All that was told a second before the kill has ended, and nothing is there twice. On a
    /// machine that is busy, each of three times the writer wakes up may be late.
    void expectAllOf(const std::map<std::string, UtcTime>& told, UtcTime killed) {
        std::size_t checked = 0;
        const auto store = Store::open(url_).value();
        for (const auto& [id, time] : told) {
            if (time < killed - 1s - 3 * lateness_.worst()) {
                const auto found = store->find(id);
                ASSERT_TRUE(found) << id;
                EXPECT_EQ(found->state, "Ready") << id;
                EXPECT_EQ(store->transitions(found->number)->size(), 2U) << id;
                ++checked;
            }
        }
        EXPECT_GT(checked, 0U) << "of " << told.size();
        EXPECT_EQ(pieces(), 0);
        EXPECT_EQ(number("SELECT count(*) - count(DISTINCT id) FROM executions"), 0);
        EXPECT_EQ(number("SELECT count(*) FROM executions WHERE ended = 0"), 0);
    }

    std::string url_;
    /// Executions: more than rows are made of at once, less than a recorder takes.
    int flood_ = 20'000;
    std::unique_ptr<Database> database_;
    Lateness lateness_;
};

INSTANTIATE_TEST_SUITE_P(Of, EitherBacklog, ::testing::Values("Sqlite", "Postgres"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(EitherBacklog, HoldsAFloodAndBecomesRowsOnceItIsOver) {
    const auto recorder = this->recorder("one");
    const auto long_one = recorder->begin(moveOf("long"));
    ASSERT_TRUE(recorder->flush(soon()));
    flood(*recorder, "short");
    await([this] { return pieces() > 0; });
    await([&] { return recorder->status().waiting > 0; });
    recorder->sample(long_one, sampleAt(0.5, 1.5));
    recorder->transition(long_one, {.time = at(5), .from = "Running", .to = "Suspended"});
    recorder->end(long_one, halted(at(6), "axis 2"));
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(pieces(), 0);
    EXPECT_EQ(rows(), flood_ + 1);
    EXPECT_EQ(recorder->status().waiting, 0U);
    EXPECT_EQ(recorder->status().written, flood_ + 1U);
    EXPECT_FALSE(recorder->status().dropped.any());
    const auto store = Store::open(url_).value();
    const auto ended = store->find("long").value();
    EXPECT_EQ(ended.reason_text, "axis 2");
    EXPECT_EQ(store->path(ended.number)->size(), 1U);
    EXPECT_EQ(store->transitions(ended.number)->size(), 1U);
    const auto last = store->find("short-" + std::to_string(flood_)).value();
    EXPECT_EQ(last.parameters, moveOf("").parameters);
    EXPECT_EQ(last.missed_cycles, 2U);
    EXPECT_EQ(store->transitions(last.number)->back().to, "Ready");
}

TEST_P(EitherBacklog, BecomesRowsWithoutAnybodyWhoAsks) {
    const auto recorder = this->recorder("one");
    flood(*recorder, "short");
    await([this] { return pieces() > 0; });
    await([this] { return rows() == flood_ && pieces() == 0; });
}

TEST_P(EitherBacklog, OfAServerThatWasKilledIsThereOnceItIsStartedAgain) {
    UtcTime killed;
    const auto told = killWhen([this] { return pieces() > 6; }, "flood", killed);
    ASSERT_GT(pieces(), 0);
    ASSERT_TRUE(recorder("dying")->flush(soon()));
    expectAllOf(told, killed);
}

TEST_P(EitherBacklog, OfAServerThatWasKilledIsThereOnceAnyIsStarted) {
    UtcTime killed;
    const auto told = killWhen([this] { return pieces() > 6; }, "flood", killed);
    ASSERT_TRUE(recorder("another")->flush(soon()));
    expectAllOf(told, killed);
}

TEST_P(EitherBacklog, OutlivesAServerThatIsKilledWhileItMakesRowsOfIt) {
    UtcTime killed;
    std::int64_t most = 0;
    const auto is_worked_off = [&] {
        most = std::max(most, pieces());
        return most > 6 && pieces() < most;
    };
    const auto told = killWhen(is_worked_off, "wave", killed);
    ASSERT_TRUE(recorder("dying")->flush(soon()));
    expectAllOf(told, killed);
}

TEST_P(EitherBacklog, OfALivingServerIsLeftToIt) {
    const auto first = recorder("one");
    flood(*first, "first");
    await([this] { return pieces() > 0; });
    const auto second = recorder("one");
    flood(*second, "second");
    ASSERT_TRUE(second->flush(soon()));
    ASSERT_TRUE(first->flush(soon()));
    EXPECT_EQ(rows(), 2 * flood_);
    EXPECT_EQ(number("SELECT count(DISTINCT id) FROM executions WHERE ended <> 0"), 2 * flood_);
}

TEST_P(EitherBacklog, ThatIsDamagedIsToldAndKeepsNobodyFromRecording) {
    UtcTime killed;
    killWhen([this] { return pieces() > 2; }, "flood", killed);
    const auto before = pieces();
    ASSERT_TRUE(database_->query("UPDATE backlog SET content = $1 WHERE number = 1",
                                 std::array<Cell, 1>{Bytes{1, 2, 3}}));
    const auto recorder = this->recorder("dying");
    recordOne(*recorder, moveOf("next"), finished(at(3)));
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_GE(recorder->status().dropped.events, 1U) << "one of " << before;
    EXPECT_EQ(pieces(), 0);
    EXPECT_TRUE(Store::open(url_).value()->find("next"));
}

TEST_P(EitherBacklog, OfAnotherVersionStaysForThat) {
    UtcTime killed;
    killWhen([this] { return pieces() > 2; }, "flood", killed);
    const auto before = pieces();
    const auto rows_before = rows();
    const auto first = database_->query("SELECT content FROM backlog WHERE number = 0", {});
    auto content = first.value().front().bytes(0);
    ++content.front();
    ASSERT_TRUE(database_->query("UPDATE backlog SET content = $1 WHERE number = 0",
                                 std::array<Cell, 1>{content}));
    const auto recorder = this->recorder("dying");
    recordOne(*recorder, moveOf("next"), finished(at(3)));
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_FALSE(recorder->status().dropped.any());
    EXPECT_EQ(pieces(), before);
    EXPECT_EQ(rows(), rows_before + 1);
}

TEST_P(EitherBacklog, IsMadeRowsOfPieceByPieceByWhoeverComes) {
    UtcTime killed;
    const auto told = killWhen([this] { return pieces() > 6; }, "flood", killed);
    std::array<std::unique_ptr<Recovery>, 2> others;
    bool more = true;
    for (std::size_t i = 0; more; ++i) {
        // Both know only some pieces; one begins anew.
        auto& other = others.at(i % 3 == 0 ? 0 : 1);
        if (!other || i == 4) {
            other = std::make_unique<Recovery>("dying", nullptr);
        }
        const auto before = pieces();
        ASSERT_TRUE(inTransaction(*database_, [&]() -> Result<void> {
            more = other->step(*database_).value();
            return {};
        }));
        EXPECT_EQ(pieces(), before - (more ? 1 : 0));
        EXPECT_FALSE(other->lost().any());
    }
    ASSERT_TRUE(
        inTransaction(*database_, [this] { return Writer::closeLost(*database_, "dying"); }));
    expectAllOf(told, killed);
}

/// Another server took this one for dead while its store held it up.
TEST_P(EitherBacklog, OfALivingServerMayBeMadeRowsOfByAnother) {
    const auto living = recorder("living");
    const auto long_one = living->begin(moveOf("long"));
    living->transition(long_one, {.time = at(1), .from = "Running", .to = "Running"});
    ASSERT_TRUE(living->flush(soon()));
    flood(*living, "short");
    living->transition(long_one, {.time = at(2), .from = "Running", .to = "Running"});
    await([this] { return pieces() > 0; });
    ASSERT_TRUE(inTransaction(*database_, [&]() -> Result<void> {
        await([&] { return living->status().health == Health::failing; });
        EXPECT_TRUE(database_->isAttendedByOthers("living").value());
        Recovery other("living", nullptr);
        while (other.step(*database_).value()) {
        }
        return Writer::closeLost(*database_, "living");
    }));
    living->transition(long_one, {.time = at(3), .from = "Running", .to = "Running"});
    living->end(long_one, halted(at(6), "axis 2"));
    ASSERT_TRUE(living->flush(soon()));
    EXPECT_EQ(pieces(), 0);
    EXPECT_EQ(rows(), flood_ + 1);
    EXPECT_EQ(number("SELECT count(DISTINCT id) FROM executions"), flood_ + 1);
    EXPECT_EQ(number("SELECT count(*) FROM executions WHERE ended = 0"), 0);
    // The one whose begin and end are in different pieces, of which one was the other's.
    const auto lost = number("SELECT count(*) FROM history WHERE state = 'Lost'");
    EXPECT_LE(lost, 1);
    EXPECT_EQ(living->status().dropped.events, static_cast<std::uint64_t>(2 * lost))
        << "its last transition and its end";
    const auto store = Store::open(url_).value();
    const auto ended = store->find("long").value();
    EXPECT_EQ(ended.reason_text, "axis 2");
    EXPECT_EQ(store->transitions(ended.number)->size(), 3U);
}

TEST_P(EitherBacklog, IsFlushedWhileTheFloodGoesOn) {
    const auto recorder = recorderOf(url_, "one", 2'000);
    const std::jthread flood([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            recordOne(*recorder, moveOf("short"), finished(at(2)));
        }
    });
    await([this] { return pieces() > 1; });
    Recorder::Key key = 0;
    await([&] { return (key = recorder->begin(moveOf("long"))) != 0; });  // unless it was dropped
    recorder->end(key, finished(at(2)));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto found = Store::open(url_).value()->find("long");
    ASSERT_TRUE(found);
    EXPECT_EQ(found->state, "Ready");
}

TEST_P(EitherBacklog, IsNotMadeRowsOfTwiceIfAnAnswerWasLost) {
    static_cast<void>(recorder("one")->flush(soon()));
    ASSERT_EQ(pieces(), 0);
    Backlog backlog("one");
    MessageLog log;
    log.put(1, moveOf("m-1"), {.time = at(1), .from = "Ready", .to = "Running"});
    log.put(1, {.time = at(2), .from = "Running", .to = "Ready"}, finished(at(2)));
    Told told;
    makeTold(log, {}, told);
    DeafDatabase deaf(*database_);
    EXPECT_FALSE(backlog.add(deaf, told, "[]"));
    ASSERT_EQ(pieces(), 1);
    ASSERT_TRUE(recorder("another")->flush(soon()));
    ASSERT_EQ(pieces(), 0);
    ASSERT_TRUE(backlog.add(*database_, told, "[]"));
    ASSERT_TRUE(backlog.isOldestInDoubt());
    Writer writer("one", nullptr);
    EXPECT_FALSE(writer.take(backlog.readOldest(*database_).value().value()).any());
    writer.doubt();
    ASSERT_TRUE(writer.write(*database_));
    EXPECT_EQ(rows(), 1);
    EXPECT_EQ(number("SELECT count(*) FROM parts"), 1);
}

TEST_P(EitherBacklog, IsReadWhateverFormBytesHaveByDefault) {
    ASSERT_EQ(number("SELECT 1"), 1);
    if (GetParam() == std::string("Postgres")) {
        const auto name = database_->query("SELECT current_database()::text", {})->front().text(0);
        ASSERT_TRUE(database_->script("ALTER DATABASE " + name + " SET bytea_output = 'escape'"));
    }
    const auto recorder = this->recorder("one");
    flood(*recorder, "short");
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(rows(), flood_);
    EXPECT_FALSE(recorder->status().dropped.any());
}

TEST_P(EitherBacklog, TakesNoRoomFromTheRowsThatAreKept) {
    const auto living = recorder("living");
    ASSERT_TRUE(living->flush(soon()));
    ASSERT_EQ(pieces(), 0);
    ASSERT_TRUE(database_->query("INSERT INTO backlog VALUES (1, 0, 'living', '[]', $1)",
                                 std::array<Cell, 1>{Bytes(4'000'000)}));
    recordOne(*living, moveOf("kept"), finished(at(1)));
    ASSERT_TRUE(living->flush(soon()));
    Recorder::Options options;
    options.url = url_;
    options.server = "another";
    options.keep = {.age = {}, .bytes = 2'000'000};
    const auto another = Recorder::create(std::move(options)).value();
    recordOne(*another, moveOf("next"), finished(at(2)));
    ASSERT_TRUE(another->flush(soon()));
    EXPECT_EQ(rows(), 2);
    ASSERT_TRUE(database_->script("DELETE FROM backlog"));
}

TEST_P(EitherBacklog, IsMadeInAStoreThatHasNone) {
    recordOne(*recorder("one"), moveOf("old"), finished(at(1)));
    ASSERT_GT(rows(), 0);
    ASSERT_TRUE(database_->script("DROP TABLE backlog"));
    EXPECT_TRUE(Store::open(url_).value()->find("old"));
    const auto recorder = this->recorder("one");
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(pieces(), 0);
}

}  // namespace
}  // namespace metier::records
