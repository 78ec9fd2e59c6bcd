#include "metier/link/host_addresses.hpp"

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <netdb.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <future>
#include <mutex>

#include "metier/link/tcp_link.hpp"
#include "metier/link/udp_link.hpp"

namespace {

constexpr const char* kHangs = "hangs.metier.test";

/// A name server that does not answer until it is released.
class SilentNameServer {
public:
    void wait() {
        std::unique_lock lock(mutex_);
        ++asked_;
        changed_.wait(lock, [this] { return released_; });
    }
    void release() {
        {
            const std::lock_guard lock(mutex_);
            released_ = true;
        }
        changed_.notify_all();
    }
    int asked() {
        const std::lock_guard lock(mutex_);
        return asked_;
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool released_ = false;
    int asked_ = 0;
};

std::atomic<SilentNameServer*> silent{nullptr};

}  // namespace

// Stands before the system's, which is asked for every other name.
extern "C" int getaddrinfo(const char* host, const char* service, const addrinfo* wanted,
                           addrinfo** found) {
    using Resolve = int (*)(const char*, const char*, const addrinfo*, addrinfo**);
    static const auto system =
        reinterpret_cast<Resolve>(dlsym(RTLD_NEXT, "getaddrinfo"));  // NOLINT: as dlsym() is
    auto* server = silent.load();
    if (server != nullptr && host != nullptr && std::strcmp(host, kHangs) == 0) {
        server->wait();
        return EAI_AGAIN;
    }
    return system(host, service, wanted, found);
}

namespace metier::link {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

/// Lets every look-up of the test go on at its end.
class HostAddresses : public ::testing::Test {
protected:
    HostAddresses() { silent.store(&server_); }
    ~HostAddresses() override {
        server_.release();
        // Until the look-up is over: the same name is looked up anew then.
        while (addressesOf(kHangs, in(10s)).error().code == Errc::timeout) {
        }
        silent.store(nullptr);
    }

    SilentNameServer server_;
};

TEST_F(HostAddresses, TakesAnAddressAsItIs) {
    EXPECT_EQ(addressesOf("192.0.2.7", in(0ms)).value().front().to_string(), "192.0.2.7");
    EXPECT_EQ(addressesOf("::1", in(0ms)).value().front().to_string(), "::1");
}

TEST_F(HostAddresses, FindsAName) {
    const auto found = addressesOf("localhost", in(10s));
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_TRUE(found->front().is_loopback());
}

TEST_F(HostAddresses, GivesUpAtTheDeadlineThoughTheNameServerIsSilent) {
    const auto deadline = in(50ms);
    auto asked = std::async(std::launch::async, [&] { return addressesOf(kHangs, deadline); });
    const bool in_time = asked.wait_until(deadline + 10s) == std::future_status::ready;
    server_.release();
    ASSERT_TRUE(in_time);
    EXPECT_EQ(asked.get().error().code, Errc::timeout);
}

TEST_F(HostAddresses, AsksOnceHoweverOftenItIsAskedMeanwhile) {
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(addressesOf(kHangs, in(20ms)).error().code, Errc::timeout);
    }
    EXPECT_LE(server_.asked(), 1);
    EXPECT_TRUE(addressesOf("localhost", in(10s))) << "another name waits for nobody";
}

TEST_F(HostAddresses, ConnectsNoLongerThanItsDeadline) {
    const auto deadline = in(50ms);
    auto tcp =
        std::async(std::launch::async, [&] { return TcpLink::connect(kHangs, 1, deadline); });
    auto udp =
        std::async(std::launch::async, [&] { return UdpLink::connect(kHangs, 1, deadline); });
    const bool in_time = tcp.wait_until(deadline + 10s) == std::future_status::ready &&
                         udp.wait_until(deadline + 10s) == std::future_status::ready;
    server_.release();
    ASSERT_TRUE(in_time);
    const auto refused = tcp.get();
    EXPECT_EQ(refused.error().code, Errc::timeout);
    EXPECT_THAT(refused.error().message, HasSubstr("hangs.metier.test:1: the name of the host"));
    EXPECT_EQ(udp.get().error().code, Errc::timeout);
}

}  // namespace
}  // namespace metier::link
