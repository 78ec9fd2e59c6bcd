// The end of a server, whatever its connections wait for.
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "http_bench.hpp"

namespace metier::http {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using testing::RawBrowser;

constexpr auto kFar = 3'600'000ms;
constexpr HttpLimits kPatient{.request_time = kFar, .idle_time = kFar, .send_time = kFar};

class Ending : public HttpBench {
protected:
    Ending() : HttpBench(kPatient) {
        server_.Get("/endless", [](const httplib::Request&, httplib::Response& response) {
            response.set_chunked_content_provider("text/plain",
                                                  [](std::size_t, httplib::DataSink& sink) {
                                                      const std::string piece(100'000, 'x');
                                                      return sink.write(piece.data(), piece.size());
                                                  });
        });
        server_.Get("/long", [this](const httplib::Request&, httplib::Response&) {
            begun_.set_value();
            EXPECT_EQ(released_.get_future().wait_for(30s), std::future_status::ready);
            handler_returned_ = true;
        });
        serve();
    }
    /// end() on a thread of its own.
    std::future<void> ending() {
        return std::async(std::launch::async, [this] { end(); });
    }

    std::promise<void> begun_;
    std::promise<void> released_;
    std::atomic<bool> handler_returned_ = false;
};

TEST_F(Ending, CutsConnectionsWhateverTheyWaitFor) {
    std::vector<std::unique_ptr<RawBrowser>> waiting;
    for (const auto& bytes :
         {std::string(), std::string("GET /echo/x HT"),
          std::string("POST /echo HTTP/1.1\r\nHost: here\r\nContent-Length: 10\r\n\r\nhalf"),
          get("/echo/x"), get("/endless")}) {
        waiting.push_back(std::make_unique<RawBrowser>(port_));
        waiting.back()->send(bytes);
    }
    waiting[3]->receive("<x>");
    waiting[4]->receive("\r\n\r\n");  // and nothing more of it
    auto ended = ending();
    ASSERT_EQ(ended.wait_for(30s), std::future_status::ready);
    for (std::size_t i = 0; i < waiting.size(); ++i) {
        EXPECT_TRUE(waiting[i]->awaitEnd()) << i;
    }
}

TEST_F(Ending, WaitsForTheHandlersThatRun) {
    RawBrowser browser(port_);
    browser.send(get("/long"));
    begun_.get_future().wait();
    auto ended = ending();
    EXPECT_TRUE(browser.awaitEnd()) << "its peer need not wait";
    EXPECT_NE(ended.wait_for(0s), std::future_status::ready);
    EXPECT_FALSE(handler_returned_);
    released_.set_value();
    ASSERT_EQ(ended.wait_for(30s), std::future_status::ready);
    EXPECT_TRUE(handler_returned_);
}

TEST_F(Ending, RefusesNewConnections) {
    const auto port = port_;
    end();
    EXPECT_FALSE(link::TcpLink::connect("127.0.0.1", port, std::chrono::steady_clock::now() + 30s));
    HttpServer next(kPatient);
    EXPECT_EQ(next.serve("127.0.0.1", port).value_or(0), port) << "the port is free at once";
    next.end();
}

TEST_F(Ending, IsNotHeldUpByPeersThatConnect) {
    const auto port = port_;
    std::atomic<bool> over = false;
    std::promise<void> connected;
    std::vector<std::jthread> peers;
    for (int i = 0; i < 4; ++i) {
        peers.emplace_back([&, i] {
            for (int round = 0; !over; ++round) {
                auto link = link::TcpLink::connect("127.0.0.1", port,
                                                   std::chrono::steady_clock::now() + 1s);
                if (i == 0 && round == 10) {
                    connected.set_value();
                }
            }
        });
    }
    connected.get_future().wait();
    auto ended = ending();
    EXPECT_EQ(ended.wait_for(30s), std::future_status::ready);
    over = true;
}

TEST(HttpServerTest, EndsRightAfterItBegan) {
    for (int round = 0; round < 100; ++round) {
        HttpServer server(kPatient);
        ASSERT_TRUE(server.serve("127.0.0.1", 0));
        server.end();
    }
}

TEST(HttpServerTest, EndsWithoutHavingServed) {
    HttpServer server(kPatient);
    server.end();
}

TEST(HttpServerTest, RefusesAPortThatIsTakenAndAForeignAddress) {
    HttpServer first(kPatient);
    const auto port = first.serve("127.0.0.1", 0).value();
    HttpServer second(kPatient);
    for (const auto* address : {"127.0.0.1", "192.0.2.1", "no address"}) {
        const auto refused = second.serve(address, port);
        ASSERT_FALSE(refused) << address;
        EXPECT_EQ(refused.error().code, Errc::already_exists);
        EXPECT_THAT(refused.error().message, HasSubstr(address));
        EXPECT_THAT(refused.error().message, HasSubstr(std::to_string(port)));
    }
    second.end();
    first.end();
}

}  // namespace
}  // namespace metier::http
