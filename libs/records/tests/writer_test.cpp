// Rows of records, also if it is not known whether they are in the store.
#include "writer.hpp"

#include "recorded.hpp"
#include "wrapped_database.hpp"

namespace metier::records {
namespace {

class WriterOfAFile : public ::testing::Test {
protected:
    std::int64_t number(const std::string& sql) const {
        return database_->query(sql).value().front().integer(0);
    }
    /// Gives the writer a transition of its only execution.
    void give(std::int64_t time, const char* from, const char* to) {
        Batch batch;
        batch.messages.push_back({1, Transition{.time = at(time), .from = from, .to = to}});
        EXPECT_EQ(writer_.take(std::move(batch)).sum(), 0U);
    }
    void begin() {
        Batch batch;
        batch.messages.push_back({1, std::make_unique<ExecutionRow>(moveOf("m-1"))});
        EXPECT_EQ(writer_.take(std::move(batch)).sum(), 0U);
        give(1, "Ready", "Running");
    }
    void expectOneOf(std::size_t transitions) const {
        EXPECT_EQ(number("SELECT count(*) FROM executions"), 1);
        const auto store = Store::open(file_).value();
        EXPECT_EQ(store->transitions(store->find("m-1")->number)->size(), transitions);
    }

    const std::string file_ = (testFolder() / "records.db").string();
    const std::unique_ptr<Database> database_ = openDatabase(file_, Store::Access::write).value();
    Writer writer_{"one"};
};

TEST_F(WriterOfAFile, WritesNothingTwiceIfTheAnswerToTheCommitOfABeginIsLost) {
    begin();
    DeafDatabase deaf(*database_);
    ASSERT_FALSE(writer_.write(deaf));
    ASSERT_EQ(number("SELECT count(*) FROM executions"), 1) << "it is there nevertheless";
    ASSERT_TRUE(writer_.hasChanges());
    ASSERT_TRUE(writer_.write(*database_));
    EXPECT_EQ(writer_.written(), 1U);
    expectOneOf(1);
    give(2, "Running", "Suspended");
    ASSERT_TRUE(writer_.write(*database_));
    expectOneOf(2);
}

TEST_F(WriterOfAFile, WritesNothingTwiceIfTheAnswerToALaterCommitIsLost) {
    begin();
    ASSERT_TRUE(writer_.write(*database_));
    give(2, "Running", "Suspended");
    DeafDatabase deaf(*database_);
    ASSERT_FALSE(writer_.write(deaf));
    ASSERT_TRUE(writer_.write(*database_));
    expectOneOf(2);
    give(3, "Suspended", "Running");
    ASSERT_TRUE(writer_.write(*database_));
    expectOneOf(3);
    EXPECT_EQ(writer_.written(), 1U);
}

}  // namespace
}  // namespace metier::records
