#include "metier/opcua/mdns.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;

/// A D-Bus address without a daemon, until its end.
class NoBus {
public:
    NoBus() {
        if (const char* address = std::getenv(kVariable)) {
            before_ = address;
        }
        ::setenv(kVariable, "unix:path=/nonexistent/bus", 1);
    }
    ~NoBus() {
        if (before_) {
            ::setenv(kVariable, before_->c_str(), 1);
        } else {
            ::unsetenv(kVariable);
        }
    }
    NoBus(const NoBus&) = delete;
    NoBus& operator=(const NoBus&) = delete;

private:
    static constexpr const char* kVariable = "DBUS_SYSTEM_BUS_ADDRESS";
    std::optional<std::string> before_;
};

TEST(MdnsWithoutAvahi, TellsNobodyAndHoldsUpNobody) {
    const NoBus no_bus;
    const auto begin = std::chrono::steady_clock::now();
    { const MdnsAnnouncer announcer({.name = "arm", .host = "127.0.0.1", .port = 4841}); }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 5s) << "it does not wait for its next try";
    const auto found = browseMdns();
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, Errc::not_found);
}

/// With the Avahi daemon of this machine.
class Mdns : public ::testing::Test {
protected:
    void SetUp() override {
        if (const auto found = browseMdns(); !found) {
            GTEST_SKIP() << "NOT TESTED: mDNS: " << found.error().message;
        }
    }
    /// Whether it held within half a minute.
    static bool soon(const std::function<bool(const std::vector<FoundServer>&)>& holds) {
        const auto deadline = std::chrono::steady_clock::now() + 30s;
        while (std::chrono::steady_clock::now() < deadline) {
            if (const auto found = browseMdns(); found && holds(*found)) {
                return true;
            }
        }
        return false;
    }
    static std::ptrdiff_t count(const std::vector<FoundServer>& servers, const std::string& url) {
        return std::count_if(servers.begin(), servers.end(),
                             [&](const auto& server) { return server.url == url; });
    }
};

TEST_F(Mdns, TellsOfAServerForAsLongAsItLives) {
    const std::string url = "opc.tcp://127.0.0.1:48499";
    {
        const MdnsAnnouncer arm({.name = "metier test arm", .host = "127.0.0.1", .port = 48499});
        ASSERT_TRUE(soon([&](const auto& servers) { return count(servers, url) == 1; }));
        const auto servers = browseMdns().value();
        for (const auto& server : servers) {
            if (server.url == url) {
                EXPECT_EQ(server.name, "metier test arm");
                EXPECT_EQ(server.reported_by, "mDNS");
            }
        }
    }
    EXPECT_TRUE(soon([&](const auto& servers) { return count(servers, url) == 0; }));
}

TEST_F(Mdns, GivesAnotherNameToASecondServerOfTheSame) {
    const MdnsAnnouncer one({.name = "metier test twin", .host = "127.0.0.1", .port = 48497});
    const MdnsAnnouncer two({.name = "metier test twin", .host = "127.0.0.1", .port = 48498});
    EXPECT_TRUE(soon([&](const auto& servers) {
        return count(servers, "opc.tcp://127.0.0.1:48497") == 1 &&
               count(servers, "opc.tcp://127.0.0.1:48498") == 1;
    }));
}

TEST_F(Mdns, TellsThePathOfTheEndpoint) {
    const MdnsAnnouncer arm(
        {.name = "metier test path", .host = "127.0.0.1", .port = 48496, .path = "/arm"});
    EXPECT_TRUE(soon(
        [&](const auto& servers) { return count(servers, "opc.tcp://127.0.0.1:48496/arm") == 1; }));
}

}  // namespace
}  // namespace metier::opcua
