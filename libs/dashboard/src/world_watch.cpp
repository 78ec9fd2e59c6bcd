#include "world_watch.hpp"

#include <array>
#include <chrono>
#include <span>
#include <utility>

namespace metier::dashboard {

using namespace std::chrono_literals;

namespace {

constexpr std::size_t kLongestLine = 1'000'000;

/// A part as it is served: pose and size [m, rad], who holds it.
nlohmann::json partJson(const nlohmann::json& told) {
    nlohmann::json part{{"pose", told.at("pose")}, {"size", told.at("size")}, {"held_by", nullptr}};
    for (auto& number : part["pose"]) {
        number = rounded(number.get<double>());
    }
    if (const auto held = told.at("held_by").get<std::string>(); !held.empty()) {
        part["held_by"] = held;
    }
    return part;
}

}  // namespace

WorldWatch::WorldWatch(CellWorld world, Board& board, std::chrono::milliseconds answer)
    : world_(std::move(world)),
      board_(board),
      answer_(answer),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

void WorldWatch::show(bool shown) {
    {
        const std::lock_guard lock(mutex_);
        shown_ = shown;
    }
    changed_.notify_all();
}

std::optional<std::string> WorldWatch::askForLine() {
    const auto deadline = std::chrono::steady_clock::now() + answer_;
    if (!link_) {
        received_.clear();
        auto link = link::TcpLink::connect(world_.address, world_.port, deadline);
        if (!link) {
            return std::nullopt;
        }
        link_ = std::move(*link);
    }
    static constexpr std::string_view kQuestion = "{\"state\": true}\n";
    if (!link_->send(std::as_bytes(std::span(kQuestion)), deadline)) {
        return std::nullopt;
    }
    auto end = received_.find('\n');
    while (end == std::string::npos && received_.size() < kLongestLine) {
        std::array<char, 4096> buffer{};
        const auto count = link_->receive(std::as_writable_bytes(std::span(buffer)), deadline);
        if (!count) {
            return std::nullopt;
        }
        received_.append(buffer.data(), *count);
        end = received_.find('\n');
    }
    if (end == std::string::npos) {
        return std::nullopt;
    }
    auto line = received_.substr(0, end);
    received_.erase(0, end + 1);
    return line;
}

std::optional<bool> WorldWatch::ask() {
    const auto line = askForLine();
    if (!line) {
        link_.reset();
        return std::nullopt;
    }
    try {
        const auto state = nlohmann::json::parse(*line);
        auto parts = nlohmann::json::object();
        for (const auto& [name, told] : state.at("parts").items()) {
            parts[name] = partJson(told);
        }
        const bool moved = parts != parts_;
        if (moved) {
            board_.setParts(parts);
        }
        parts_ = std::move(parts);
        return moved;
    } catch (const nlohmann::json::exception&) {
        link_.reset();  // it does not speak as a world does
        return std::nullopt;
    }
}

void WorldWatch::work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        if (!shown_ && !parts_.is_null()) {
            changed_.wait(lock, stop, [this] { return shown_; });
            continue;
        }
        lock.unlock();
        const auto moved = ask();
        lock.lock();
        const auto pause = !moved ? 1'000ms : (*moved ? 33ms : 500ms);
        changed_.wait_for(lock, stop, pause, [this] { return !shown_ && !parts_.is_null(); });
    }
}

}  // namespace metier::dashboard
