// Ends of executions whose server died, and removal of old ones.
#include "retention.hpp"

#include "either_store.hpp"

namespace metier::records {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using KeptRecords = EitherStore;
INSTANTIATE_EITHER(KeptRecords);

TEST_P(KeptRecords, ClosesWhatADeadServerLeftUnderWayAsLost) {
    const auto other = recorderOf(url_, "urn:test:edo");
    other->begin(moveOf("e-1"));
    {
        const auto died = recorderOf(url_);
        const auto key = died->begin(moveOf("m-1"));
        died->sample(key, sampleAt(2.5, 0.1));
        ASSERT_TRUE(died->flush(soon()) && other->flush(soon()));
    }
    ASSERT_FALSE(store()->find("m-1")->isOver());
    const auto back = recorderOf(url_);
    ASSERT_TRUE(back->flush(soon()));
    const auto lost = store()->find("m-1").value();
    EXPECT_EQ(lost.state, kLost);
    EXPECT_EQ(lost.reason, kServerLost);
    EXPECT_EQ(lost.ended, at(2'500));
    EXPECT_THAT(lost.reason_text, HasSubstr("server ended"));
    EXPECT_FALSE(store()->find("e-1")->isOver());
}

TEST_P(KeptRecords, ClosesWhatWasLostAtItsLastSign) {
    {
        const auto died = recorderOf(url_);
        died->begin(moveOf("without a sign", at(5)));
        const auto key = died->begin(moveOf("with a late event"));
        died->sample(key, sampleAt(2.5, 0.1));
        died->intermediate(key, {.time = at(4'000), .value = "1"});
        ASSERT_TRUE(died->flush(soon()));
    }
    const auto back = recorderOf(url_);
    ASSERT_TRUE(back->flush(soon()));
    EXPECT_EQ(store()->find("without a sign")->ended, at(5));
    EXPECT_EQ(store()->find("with a late event")->ended, at(4'000));
}

/// \return number of removed executions
Result<std::uint64_t> retain(const std::string& url, const Retention& keep, UtcTime now) {
    METIER_ASSIGN(const auto database, openDatabase(url, Store::Access::write));
    RetentionRun run(keep, now);
    while (true) {
        METIER_ASSIGN(const auto more, run.step(*database));
        if (!more) {
            return run.removed();
        }
    }
}

TEST_P(KeptRecords, RemovesWhatIsOlderThanWanted) {
    recordSix();
    const auto removed = retain(url_, {.age = 1h, .bytes = 0}, at(2'500) + 1h);
    ASSERT_TRUE(removed) << removed.error().message;
    EXPECT_EQ(*removed, 3U);
    EXPECT_THAT(ids({}), ElementsAre("f", "e", "d"));
    EXPECT_THAT(store()->path(1).value(), IsEmpty());
    Filter gone;
    gone.text = "over limit";
    EXPECT_THAT(ids(gone), IsEmpty());
}

TEST_P(KeptRecords, KeepsWhatBeganExactlyThatLongAgo) {
    recordSix();
    EXPECT_EQ(retain(url_, {.age = 1h, .bytes = 0}, at(2'000) + 1h).value(), 2U);
    EXPECT_THAT(ids({}), ElementsAre("f", "e", "d", "c"));
    EXPECT_EQ(retain(url_, {.age = 0h, .bytes = 0}, at(0) + 9'000h).value(), 0U) << "no limit";
    EXPECT_EQ(retain(url_, {.age = 0h, .bytes = 2'000'000'000}, at(0)).value(), 0U);
}

TEST_P(KeptRecords, RemovesTheOldestBeyondItsSizeButNothingUnderWay) {
    constexpr int kExecutions = 1'200;
    const auto recorder = recorderOf(url_);
    recorder->begin(moveOf("under way", at(-1)));
    for (int i = 0; i < kExecutions; ++i) {
        auto large = moveOf("m-" + std::to_string(i), at(i));
        large.parameters = '"' + std::string(1'000, 'p') + '"';
        recordOne(*recorder, large, finished(at(i + 1)));
        if (i % 100 == 99) {
            ASSERT_TRUE(recorder->flush(soon()));
        }
    }
    const auto reading = store();
    const auto full = reading->bytes().value();
    const auto removed = retain(url_, {.age = 0h, .bytes = full / 2}, at(0));
    ASSERT_TRUE(removed) << removed.error().message;
    EXPECT_GT(*removed, 400U);
    EXPECT_LT(*removed, 900U);
    EXPECT_LE(reading->bytes().value(), full / 2);
    EXPECT_TRUE(reading->find("under way"));
    EXPECT_TRUE(reading->find("m-" + std::to_string(kExecutions - 1)));
    EXPECT_FALSE(reading->find("m-0"));
}

}  // namespace
}  // namespace metier::records
