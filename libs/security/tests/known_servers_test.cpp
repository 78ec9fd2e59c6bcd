#include "metier/security/known_servers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>

namespace metier::security {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class KnownServersTest : public ::testing::Test {
protected:
    KnownServersTest() { fs::remove_all(folder_); }
    /// Files as of other addresses; quicker than to note these.
    void fillUp(int count) const {
        for (int i = 0; i < count; ++i) {
            std::ofstream(folder_ / "closed" / std::to_string(i)).flush();
        }
    }

    const fs::path folder_ = fs::path(::testing::TempDir()) / "known_servers" /
                             ::testing::UnitTest::GetInstance()->current_test_info()->name();
    const KnownServers known_{folder_ / "closed"};
};

TEST_F(KnownServersTest, AreThoseThatWereNoted) {
    EXPECT_FALSE(known_.isClosed("opc.tcp://cell:48421"));
    ASSERT_TRUE(known_.noteClosed("opc.tcp://cell:48421"));
    EXPECT_TRUE(known_.isClosed("opc.tcp://cell:48421"));
    EXPECT_TRUE(KnownServers(folder_ / "closed").isClosed("opc.tcp://cell:48421"))
        << "in another process";
    EXPECT_FALSE(known_.isClosed("opc.tcp://cell:48422"));
    EXPECT_FALSE(known_.isClosed("opc.tcp://other:48421"));
}

TEST_F(KnownServersTest, AreKnownHoweverTheirAddressIsWritten) {
    ASSERT_TRUE(known_.noteClosed("opc.tcp://127.0.0.1:48421"));
    for (const auto* same : {"opc.tcp://localhost:48421", "opc.tcp://[::1]:48421/",
                             "OPC.TCP://LOCALHOST:48421/path", "opc.tcp://127.0.0.1:48421/"}) {
        EXPECT_TRUE(known_.isClosed(same)) << same;
    }
    EXPECT_FALSE(known_.isClosed("opc.tcp://127.0.0.2:48421"));
    ASSERT_TRUE(known_.noteClosed("opc.tcp://[fe80::1]"));
    EXPECT_TRUE(known_.isClosed("opc.tcp://[FE80::1]:4840"));
    EXPECT_FALSE(known_.isClosed("opc.tcp://[fe80::2]:4840"));
}

TEST_F(KnownServersTest, AreForgottenOnDemand) {
    ASSERT_TRUE(known_.noteClosed("opc.tcp://127.0.0.1:48421"));
    EXPECT_TRUE(known_.forget("opc.tcp://localhost:48421").value());
    EXPECT_FALSE(known_.isClosed("opc.tcp://127.0.0.1:48421"));
    EXPECT_FALSE(known_.forget("opc.tcp://localhost:48421").value());
    EXPECT_FALSE(KnownServers(folder_ / "nowhere").forget("opc.tcp://a:1").value());
}

TEST_F(KnownServersTest, StayInTheirFolderWhateverTheyAreCalled) {
    const auto odd = "opc.tcp://../../" + std::string(1'000, 'x') + "\n:1";
    ASSERT_TRUE(known_.noteClosed(odd));
    ASSERT_TRUE(known_.noteClosed("opc.tcp://..:1"));
    EXPECT_TRUE(known_.isClosed(odd));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "the folder itself";
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "closed"), {}), 2);
}

TEST_F(KnownServersTest, AreAThousandAtMost) {
    for (int port = 1; port <= 1'010; ++port) {
        ASSERT_TRUE(known_.noteClosed("opc.tcp://cell:" + std::to_string(port)));
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "closed"), {}), 1'000);
    EXPECT_TRUE(known_.isClosed("opc.tcp://cell:1010"));
}

TEST_F(KnownServersTest, AreForgottenInTheOrderInWhichTheyWereNoted) {
    const auto note = [&](const std::string& url) { ASSERT_TRUE(known_.noteClosed(url)); };
    note("opc.tcp://first:1");
    note("opc.tcp://second:1");
    for (const auto& file : fs::directory_iterator(folder_ / "closed")) {
        const bool first = file.path().filename().string().starts_with("first");
        fs::last_write_time(file, fs::file_time_type::clock::now() - (first ? 2h : 1h));
    }
    fillUp(998);
    note("opc.tcp://second:1");
    EXPECT_TRUE(known_.isClosed("opc.tcp://first:1")) << "a known address makes no room";
    note("opc.tcp://third:1");
    EXPECT_FALSE(known_.isClosed("opc.tcp://first:1"));
    EXPECT_TRUE(known_.isClosed("opc.tcp://second:1"));
    note("opc.tcp://fourth:1");
    EXPECT_FALSE(known_.isClosed("opc.tcp://second:1"));
    EXPECT_TRUE(known_.isClosed("opc.tcp://third:1"));
}

TEST_F(KnownServersTest, AreAThousandAlsoIfOthersPutMoreThere) {
    fs::create_directories(folder_ / "closed");
    fillUp(1'010);
    ASSERT_TRUE(known_.noteClosed("opc.tcp://cell:1"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "closed"), {}), 1'000);
    EXPECT_TRUE(known_.isClosed("opc.tcp://cell:1"));
}

TEST_F(KnownServersTest, AreNotNotedWhereNoFolderCanBe) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "closed") << "a file";
    const auto noted = known_.noteClosed("opc.tcp://cell:1");
    ASSERT_FALSE(noted);
    EXPECT_EQ(noted.error().code, Errc::resource_unavailable);
    EXPECT_FALSE(known_.isClosed("opc.tcp://cell:1"));
    EXPECT_FALSE(known_.forget("opc.tcp://cell:1").value());
}

// The folder may hold the address: an open server there is not taken for the known one.
TEST_F(KnownServersTest, MayBeClosedIfTheFolderCannotBeExamined) {
    fs::create_directories(folder_);
    fs::create_symlink("closed", folder_ / "closed");  // leads to itself
    EXPECT_TRUE(known_.isClosed("opc.tcp://cell:1"));
    EXPECT_EQ(known_.forget("opc.tcp://cell:1").error().code, Errc::resource_unavailable);
}

}  // namespace
}  // namespace metier::security
