#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

#include "metier/http/http_server.hpp"
#include "metier/http/testing/raw_browser.hpp"

namespace metier::http {

/// A server with a path for each thing that a test asks for.
class HttpBench : public ::testing::Test {
protected:
    explicit HttpBench(const HttpLimits& limits) : server_(limits) {
        server_.set_pre_routing_handler(
            [](const httplib::Request& request, httplib::Response& response) {
                if (request.path != "/refused") {
                    return httplib::Server::HandlerResponse::Unhandled;
                }
                response.status = 403;
                return httplib::Server::HandlerResponse::Handled;
            });
        server_.Get(
            R"(/echo/(\w+))", [this](const httplib::Request& request, httplib::Response& response) {
                ++handled_;
                response.set_content("<" + std::string(request.matches[1]) + ">", "text/plain");
            });
        server_.Post("/echo", [this](const httplib::Request& request, httplib::Response& response) {
            ++handled_;
            response.set_content("<" + request.body + ">", "text/plain");
        });
    }
    void TearDown() override { end(); }

    void serve() { port_ = server_.serve("127.0.0.1", 0).value(); }
    void end() {
        if (port_ != 0) {
            server_.end();
            port_ = 0;
        }
    }
    static std::string get(const std::string& path) {
        return "GET " + path + " HTTP/1.1\r\nHost: here\r\n\r\n";
    }
    static std::string post(const std::string& body) {
        return "POST /echo HTTP/1.1\r\nHost: here\r\nContent-Length: " +
               std::to_string(body.size()) + "\r\n\r\n" + body;
    }
    /// The same, as the last request of its connection.
    static std::string closing(std::string request) {
        return request.insert(request.find("\r\n") + 2, "Connection: close\r\n");
    }
    /// All that is answered to bytes until the server ends the connection.
    std::string answerTo(const std::string& bytes) {
        testing::RawBrowser browser(port_);
        browser.send(bytes);
        return browser.receive();
    }
    static std::size_t count(const std::string& text, const std::string& part) {
        std::size_t found = 0;
        for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
            ++found;
        }
        return found;
    }
    /// Whether a new connection is served within half a minute. It is refused as long as the thread
    /// of a former one has not ended, which its peer does not see.
    bool answers() {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        bool answered = false;
        while (!answered && std::chrono::steady_clock::now() < deadline) {
            answered = answerTo(closing(get("/echo/still"))).ends_with("<still>");
        }
        return answered;
    }

    HttpServer server_;
    std::uint16_t port_ = 0;
    std::atomic<int> handled_ = 0;
};

}  // namespace metier::http
