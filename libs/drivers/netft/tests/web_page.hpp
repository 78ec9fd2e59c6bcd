#pragma once

#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "metier/link/tcp_link.hpp"

namespace metier::netft_driver::testing {

inline SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

inline std::string ok(const std::string& body) {
    return "HTTP/1.0 200 OK\r\nContent-Type: text/xml\r\n\r\n" + body;
}

/// A server on loopback that answers each path with fixed bytes and closes.
class WebPage {
public:
    /// \param answers by path; others get 404
    explicit WebPage(std::map<std::string, std::string> answers)
        : answers_(std::move(answers)), thread_([this](const std::stop_token& stop) {
              while (!stop.stop_requested()) {
                  if (auto link = listener_.accept(in(std::chrono::milliseconds(20)))) {
                      serve(*link);
                  }
              }
          }) {}

    std::uint16_t port() const { return listener_.port(); }
    void set(const std::string& path, const std::string& answer) {
        const std::lock_guard lock(mutex_);
        answers_[path] = answer;
    }
    int asked() {
        const std::lock_guard lock(mutex_);
        return asked_;
    }

private:
    void serve(link::TcpLink& link) {
        std::string request;
        std::array<char, 512> buffer{};
        while (request.find("\r\n\r\n") == std::string::npos) {
            const auto count = link.receive(std::as_writable_bytes(std::span(buffer)),
                                            in(std::chrono::seconds(5)));
            if (!count) {
                return;
            }
            request.append(buffer.data(), *count);
        }
        const auto begin = request.find(' ') + 1;
        const auto path = request.substr(begin, request.find(' ', begin) - begin);
        std::string answer = "HTTP/1.0 404 Not Found\r\n\r\n";
        {
            const std::lock_guard lock(mutex_);
            ++asked_;
            if (const auto found = answers_.find(path); found != answers_.end()) {
                answer = found->second;
            }
        }
        static_cast<void>(link.send(std::as_bytes(std::span(answer)), in(std::chrono::seconds(5))));
        link.shutdown();
    }

    link::TcpListener listener_ = link::TcpListener::listen("127.0.0.1", 0).value();
    std::mutex mutex_;
    std::map<std::string, std::string> answers_;
    int asked_ = 0;
    std::jthread thread_;
};

}  // namespace metier::netft_driver::testing
