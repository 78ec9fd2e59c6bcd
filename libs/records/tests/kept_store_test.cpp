// A store that several threads use for a long time.
#include "metier/records/kept_store.hpp"

#include <thread>

#include "either_database.hpp"

namespace metier::records {
namespace {

namespace fs = std::filesystem;

class StoreThatIsKept : public EitherDatabase {
protected:
    void record(const std::string& id) const {
        const auto recorder = recorderOf(url_);
        recordOne(*recorder, moveOf(id), finished(at(1)));
        ASSERT_TRUE(recorder->flush(soon()));
    }
    static Result<std::string> newest(KeptStore& kept) {
        return kept.use([](Store& store) -> Result<std::string> {
            METIER_ASSIGN(const auto listing, store.list({}, {}));
            return listing.executions.empty() ? "nothing" : listing.executions.front().id;
        });
    }
};
INSTANTIATE_EITHER(StoreThatIsKept);

TEST_P(StoreThatIsKept, IsOpenedOnceItIsThereAndOnlyOnce) {
    KeptStore kept(url_);
    EXPECT_EQ(newest(kept).error().code, Errc::not_found);
    record("m-1");
    EXPECT_EQ(newest(kept).value_or(""), "m-1");
    const Store* first = nullptr;
    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(kept.use([&first](Store& store) -> Result<void> {
            EXPECT_TRUE(first == nullptr || first == &store);
            first = &store;
            return {};
        }));
    }
}

TEST_P(StoreThatIsKept, IsUsedByManyThreads) {
    record("m-1");
    KeptStore kept(url_);
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([&kept] {
            for (int j = 0; j < 50; ++j) {
                EXPECT_EQ(newest(kept).value_or(""), "m-1");
            }
        });
    }
}

TEST_P(StoreThatIsKept, IsNotOpenedAnewForWhatIsNotThere) {
    record("m-1");
    KeptStore kept(url_);
    EXPECT_EQ(newest(kept).value_or(""), "m-1");
    int calls = 0;
    const auto missing = kept.use([&calls](Store& store) {
        ++calls;
        return store.find("m-2");
    });
    EXPECT_EQ(missing.error().code, Errc::not_found);
    EXPECT_EQ(calls, 1);
}

TEST(KeptFile, IsOpenedAnewOnceItWasReplaced) {
    const auto folder = testFolder();
    const auto file = (folder / "records.db").string();
    recordOne(*recorderOf(file), moveOf("old"), finished(at(1)));
    KeptStore kept(file);
    const auto newest = [&kept] {
        return kept.use([](Store& store) { return store.find("1"); })
            .map([](const ExecutionRow& execution) { return execution.id; })
            .value_or("nothing");
    };
    EXPECT_EQ(newest(), "old");
    fs::remove_all(folder);
    EXPECT_EQ(newest(), "nothing");
    recordOne(*recorderOf(file), moveOf("new"), finished(at(1)));
    EXPECT_EQ(newest(), "new");
}

TEST(KeptDatabase, IsThereAgainOnceItsServerIs) {
    auto* postgres = TemporaryPostgres::instance();
    if (postgres == nullptr) {
        GTEST_SKIP() << "PostgreSQL is not installed";
    }
    const auto url = postgres->freshDatabase();
    recordOne(*recorderOf(url), moveOf("m-1"), finished(at(1)));
    KeptStore kept(url);
    const auto find = [&kept] { return kept.use([](Store& store) { return store.find("m-1"); }); };
    EXPECT_TRUE(find());
    postgres->kill();
    EXPECT_EQ(find().error().code, Errc::connection_lost);
    postgres->start();
    EXPECT_TRUE(find()) << "with a new connection";
    postgres->kill();
    postgres->start();
    EXPECT_TRUE(find()) << "though nobody noticed that the old one broke";
}

}  // namespace
}  // namespace metier::records
