// The streams of many tabs, over real connections.
#include "stream.hpp"

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/http/http_server.hpp"
#include "metier/http/testing/raw_browser.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using http::testing::RawBrowser;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kAtMost = 30s;
constexpr const char* kRequest = "GET /stream HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";

class StreamTest : public ::testing::Test {
protected:
    explicit StreamTest(http::HttpLimits limits = {}) : limits_(limits) { serve(); }
    ~StreamTest() override {
        board_.closeAll();
        server_.end();
    }

    void serve() {
        server_.Get("/stream", [this](const httplib::Request&, httplib::Response& response) {
            const auto tab = std::to_string(++tabs_);
            const auto begun = streams_.begin(tab, response,
                                              {[this] { return may_listen_.load(); },
                                               [this, tab] {
                                                   const std::lock_guard lock(mutex_);
                                                   ended_[tab].set_value();
                                               }});
            if (!begun) {
                response.status = 503;
            }
        });
        port_ = server_.serve("127.0.0.1", 0).value();
    }
    /// Becomes ready once the tab of that number has ended.
    std::future<void> endOf(const std::string& tab) {
        const std::lock_guard lock(mutex_);
        return ended_[tab].get_future();
    }

    SystemClock clock_;
    http::HttpLimits limits_;
    Board board_{{{"name", "test"}}, clock_};
    Streams streams_{board_, limits_};
    http::HttpServer server_{limits_};
    std::uint16_t port_ = 0;
    std::atomic<int> tabs_ = 0;
    std::atomic<bool> may_listen_ = true;
    std::mutex mutex_;
    std::map<std::string, std::promise<void>> ended_;
};

TEST_F(StreamTest, BeginsWithTheTabAndAllThereIs) {
    board_.changeSkill("ur5/C/Move", [](SkillState& state) { state.state = "Ready"; });
    RawBrowser browser(port_);
    browser.send(kRequest);
    const auto text = browser.receive("\"Ready\"");
    EXPECT_THAT(text, HasSubstr("Content-Type: text/event-stream"));
    EXPECT_THAT(text, HasSubstr("event: hello\ndata: {\"tab\":\"1\"}"));
    EXPECT_THAT(text, HasSubstr("event: snapshot"));
}

TEST_F(StreamTest, GivesAHundredTabsTheSame) {
    std::vector<std::unique_ptr<RawBrowser>> browsers;
    for (int i = 0; i < 100; ++i) {
        browsers.push_back(std::make_unique<RawBrowser>(port_));
        browsers.back()->send(kRequest);
        EXPECT_THAT(browsers.back()->receive("snapshot"), HasSubstr("hello"));
    }
    board_.raise({"ur5", 700, "something is wrong"});
    for (const auto& browser : browsers) {
        EXPECT_THAT(browser->receive("something is wrong"), HasSubstr("event: alarm"));
    }
}

TEST_F(StreamTest, TellsSoonThatATabIsClosed) {
    auto ended = endOf("1");
    {
        RawBrowser browser(port_);
        browser.send(kRequest);
        browser.receive("snapshot");
        EXPECT_TRUE(board_.hasTab("1"));
    }
    ASSERT_EQ(ended.wait_for(kAtMost), std::future_status::ready);
    EXPECT_FALSE(board_.hasTab("1"));
}

TEST_F(StreamTest, EndsOnceItsPersonMayListenNoLonger) {
    auto ended = endOf("1");
    RawBrowser browser(port_);
    browser.send(kRequest);
    browser.receive("snapshot");
    may_listen_ = false;
    EXPECT_EQ(ended.wait_for(kAtMost), std::future_status::ready);
    EXPECT_FALSE(board_.hasTab("1"));
    browser.receive();  // returns: the connection was ended
}

class SlowReader : public StreamTest {
protected:
    SlowReader() : StreamTest({.waiting_bytes = 200'000, .send_time = 2s}) {}
};

TEST_F(SlowReader, IsCutAndHoldsUpNobody) {
    auto ended = endOf("1");
    RawBrowser slow(port_);
    slow.send(kRequest);
    slow.receive("snapshot");  // so its tab is the first; and not a byte more
    RawBrowser quick(port_);
    quick.send(kRequest);
    quick.receive("snapshot");

    const std::string text(10'000, 'x');
    int raised = 0;
    while (ended.wait_for(0s) != std::future_status::ready && raised < 10'000) {
        board_.raise({"ur5", 1, text + std::to_string(++raised)});
        ASSERT_THAT(quick.receive("x" + std::to_string(raised) + "\""),
                    HasSubstr("x" + std::to_string(raised) + "\""))
            << "the quick reader gets all of it, one by one";
    }
    EXPECT_EQ(ended.wait_for(kAtMost), std::future_status::ready);
    EXPECT_FALSE(board_.hasTab("1"));
    EXPECT_TRUE(board_.hasTab("2"));
}

class FewTabs : public StreamTest {
protected:
    FewTabs() : StreamTest({.connections = 4, .tabs = 2}) {}
};

TEST_F(FewTabs, AreOpenAtTheSameTime) {
    std::array<RawBrowser, 2> open{RawBrowser(port_), RawBrowser(port_)};
    for (auto& browser : open) {
        browser.send(kRequest);
        browser.receive("snapshot");
    }
    RawBrowser third(port_);
    third.send(kRequest);
    EXPECT_THAT(third.receive("\r\n\r\n"), HasSubstr("503"));
}

TEST_F(FewTabs, RefusesAConnectionTooMuchAtOnce) {
    std::vector<std::unique_ptr<RawBrowser>> open;
    for (int i = 0; i < 2; ++i) {
        open.push_back(std::make_unique<RawBrowser>(port_));
        open.back()->send(kRequest);
        open.back()->receive("snapshot");
    }
    for (int i = 0; i < 2; ++i) {
        open.push_back(std::make_unique<RawBrowser>(port_));
        open.back()->send("GET /nothing HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
        open.back()->receive("\r\n\r\n");
    }
    RawBrowser fifth(port_);
    EXPECT_THAT(fifth.receive(), HasSubstr("too many connections"));
}

}  // namespace
}  // namespace metier::dashboard
