#include "host/server_records.hpp"

#include <gmock/gmock.h>

#include "lab.hpp"
#include "metier/base/queue.hpp"

namespace metier::server::testing {
namespace {

using ::testing::HasSubstr;

class RecordsOfAServer : public ::testing::Test {
protected:
    ~RecordsOfAServer() override { std::filesystem::remove_all(folder_); }

    static cell::ServerConfig recordedAt(const std::string& url) {
        cell::ServerConfig config;
        config.name = "ur5";
        config.records.url = url;
        return config;
    }

    const std::filesystem::path folder_ = freshFolder();
};

TEST_F(RecordsOfAServer, AreKeptOnlyWhereSomebodySays) {
    const auto none = ServerRecords::open(recordedAt(""), "urn:test:ur5");
    ASSERT_TRUE(none);
    EXPECT_EQ(*none, nullptr);
    const auto kept =
        ServerRecords::open(recordedAt((folder_ / "records.db").string()), "urn:test:ur5");
    ASSERT_TRUE(kept);
    EXPECT_NE(*kept, nullptr);
}

TEST_F(RecordsOfAServer, AreRefusedAnAddressThatIsNone) {
    const auto refused = ServerRecords::open(recordedAt("ftp://example/records"), "urn:test:ur5");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
    EXPECT_THAT(refused.error().message, HasSubstr("ftp://example/records"));
}

TEST_F(RecordsOfAServer, FailWhereTheirFolderIsNone) {
    std::ofstream(folder_ / "no_folder") << "a file\n";
    const auto records =
        ServerRecords::open(recordedAt((folder_ / "no_folder" / "records.db").string()),
                            "urn:test:ur5")
            .value();
    const auto failing = [&] {
        return records->recorder().status().write_state == records::WriteState::failing;
    };
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    Queue<int> nothing(1);
    while (!failing() && std::chrono::steady_clock::now() < deadline) {
        static_cast<void>(
            nothing.popUntil(std::chrono::steady_clock::now() + std::chrono::milliseconds(20)));
    }
    EXPECT_TRUE(failing());
}

}  // namespace
}  // namespace metier::server::testing
