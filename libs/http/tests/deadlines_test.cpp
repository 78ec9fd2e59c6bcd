// No wait for a peer lasts longer than its limit. Each test sets the limit that it is about; all
// others are longer than the test may take.
#include <gmock/gmock.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>

#include "http_bench.hpp"

namespace metier::http {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RawBrowser;

constexpr auto kFar = 3'600'000ms;

/// How long something took.
template <typename Work>
std::chrono::nanoseconds timeOf(Work work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::steady_clock::now() - begin;
}

constexpr auto kIdle = 300ms;

class IdleTime : public HttpBench {
protected:
    IdleTime() : HttpBench({.request_time = kFar, .idle_time = kIdle, .send_time = kFar}) {
        serve();
    }
    /// A new connection on which these bytes were sent long before it was idle for too long.
    /// Connects again if the computer held the test up.
    std::unique_ptr<RawBrowser> sentInTime(const std::string& bytes) const {
        const auto deadline = std::chrono::steady_clock::now() + 30s;
        while (std::chrono::steady_clock::now() < deadline) {
            std::unique_ptr<RawBrowser> browser;
            const auto taken = timeOf([&] {
                browser = std::make_unique<RawBrowser>(port_);
                browser->send(bytes);
            });
            if (taken < kIdle / 2) {
                return browser;
            }
        }
        return nullptr;
    }
};

TEST_F(IdleTime, EndsAConnectionOnWhichNothingCame) {
    EXPECT_GE(timeOf([&] { EXPECT_TRUE(RawBrowser(port_).awaitEnd()); }), 200ms);
}

TEST_F(IdleTime, EndsAConnectionAfterItsLastRequest) {
    const auto request = get("/echo/one");
    const auto browser = sentInTime(request.substr(0, 10));
    ASSERT_TRUE(browser);
    browser->send(request.substr(10));
    EXPECT_THAT(browser->receive("<one>"), HasSubstr("<one>"));
    EXPECT_TRUE(browser->awaitEnd());
}

TEST_F(IdleTime, IsNotThatOfARequestUnderWay) {
    const auto request = get("/echo/one");
    const auto browser = sentInTime(request.substr(0, 10));
    ASSERT_TRUE(browser);
    EXPECT_TRUE(browser->isLeftAlone(3 * kIdle));
    browser->send(request.substr(10));
    EXPECT_THAT(browser->receive("<one>"), HasSubstr("<one>"));
}

class RequestTime : public HttpBench {
protected:
    RequestTime()
        : HttpBench(
              {.connections = 1, .request_time = 500ms, .idle_time = kFar, .send_time = kFar}) {
        serve();
    }
    /// Sends a byte every 20 ms until the server ends the connection.
    static void trickle(RawBrowser& browser, const std::string& bytes) {
        for (const char byte : bytes) {
            if (!browser.send(std::string(1, byte)) || !browser.isLeftAlone(20ms)) {
                return;
            }
        }
        FAIL() << "all of it was taken";
    }
};

TEST_F(RequestTime, EndsAHeadThatComesByteByByte) {
    RawBrowser browser(port_);
    EXPECT_GE(timeOf([&] { trickle(browser, "GET / HTTP/1.1\r\nX: " + std::string(3'000, 'x')); }),
              400ms);
    EXPECT_TRUE(answers()) << "its thread is free";
}

TEST_F(RequestTime, EndsABodyThatComesByteByByte) {
    RawBrowser browser(port_);
    browser.send("POST /echo HTTP/1.1\r\nHost: here\r\nContent-Length: 5000\r\n\r\n");
    trickle(browser, std::string(3'000, 'x'));
    EXPECT_EQ(handled_, 0);
    EXPECT_TRUE(answers());
}

TEST_F(RequestTime, EndsABodyThatDoesNotCome) {
    RawBrowser browser(port_);
    browser.send("POST /echo HTTP/1.1\r\nHost: here\r\nContent-Length: 10\r\n\r\nhalf");
    EXPECT_THAT(browser.receive(), Not(HasSubstr("200 OK")));
    EXPECT_EQ(handled_, 0);
}

TEST_F(RequestTime, BeginsWithTheFirstByteOfEachRequest) {
    RawBrowser browser(port_);
    for (int i = 0; i < 2; ++i) {
        EXPECT_TRUE(browser.isLeftAlone(700ms)) << "between two requests";
        browser.send(get("/echo/one"));
        EXPECT_THAT(browser.receive("<one>"), HasSubstr("<one>"));
    }
}

class SendTime : public HttpBench {
protected:
    SendTime()
        : HttpBench(
              {.connections = 1, .request_time = kFar, .idle_time = kFar, .send_time = 500ms}) {
        server_.Get("/endless", [this](const httplib::Request&, httplib::Response& response) {
            response.set_chunked_content_provider(
                "text/plain",
                [](std::size_t, httplib::DataSink& sink) {
                    const std::string piece(100'000, 'x');
                    return sink.write(piece.data(), piece.size());
                },
                [this](bool) { ended_.set_value(); });
        });
        serve();
    }

    std::promise<void> ended_;
};

TEST_F(SendTime, EndsAnAnswerThatNobodyReads) {
    RawBrowser browser(port_);
    const auto taken = timeOf([&] {
        browser.send(get("/endless"));
        EXPECT_EQ(ended_.get_future().wait_for(30s), std::future_status::ready);
    });
    EXPECT_GE(taken, 400ms);
    EXPECT_TRUE(answers()) << "its thread is free";
}

TEST_F(SendTime, EndsAnAnswerToAPeerThatHasGone) {
    {
        RawBrowser browser(port_);
        browser.send(get("/endless"));
        browser.receive("\r\n\r\n");
    }
    EXPECT_EQ(ended_.get_future().wait_for(30s), std::future_status::ready);
}

}  // namespace
}  // namespace metier::http
