#include "server_watch.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "metier/opcua/text.hpp"

namespace metier::dashboard {

using namespace std::chrono_literals;

ServerWatch::ServerWatch(LinkContext context, const Connector& connector)
    : context_(std::move(context)),
      connector_(connector),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

ServerWatch::~ServerWatch() {
    thread_.request_stop();
    thread_ = {};
}

std::shared_ptr<ServerLink> ServerWatch::link() const {
    const std::lock_guard lock(mutex_);
    return link_;
}

void ServerWatch::showLive(bool shown) {
    {
        const std::lock_guard lock(news_->mutex);
        news_->live = shown;
    }
    news_->changed.notify_all();
}

void ServerWatch::present(std::shared_ptr<ServerLink> link) {
    const std::lock_guard lock(mutex_);
    link_.swap(link);
}

std::shared_ptr<ServerLink> ServerWatch::connect() {
    auto options = connector_.options(context_.server.url);
    if (!options) {
        context_.board.setDisconnected(context_.server.name,
                                       opcua::sanitise(options.error().message));
        return nullptr;
    }
    std::uint64_t number = 0;
    {
        const std::lock_guard lock(news_->mutex);
        number = ++news_->link;
        news_->lost.reset();
    }
    auto link =
        ServerLink::open(context_, *options, [news = news_, number](const opcua::Failure& failure) {
            {
                const std::lock_guard lock(news->mutex);
                if (news->link == number) {
                    news->lost = failure.message;
                }
            }
            news->changed.notify_all();
        });
    if (!link) {
        context_.board.setDisconnected(
            context_.server.name,
            opcua::sanitise(link.error().message + connector_.advice(link.error())));
        return nullptr;
    }
    if (connector_.connected) {
        connector_.connected(*options, context_.server.url);
    }
    return std::move(*link);
}

void ServerWatch::keep(ServerLink& link, const std::stop_token& stop) {
    bool shown = false;
    std::unique_lock lock(news_->mutex);
    while (!stop.stop_requested() && !news_->lost) {
        if (news_->live != shown) {
            shown = news_->live;
            lock.unlock();
            link.showLive(shown);
            lock.lock();
            continue;
        }
        news_->changed.wait(lock, stop, [&] { return news_->lost || news_->live != shown; });
    }
}

void ServerWatch::run(const std::stop_token& stop) {
    constexpr auto kShortestPause = 250ms;
    constexpr auto kLongestPause = 4'000ms;
    std::chrono::milliseconds pause = kShortestPause;
    while (!stop.stop_requested()) {
        if (auto link = connect()) {
            pause = kShortestPause;
            present(link);  // before any listener is notified
            context_.board.setOffer(context_.server.name, link->offer());
            keep(*link, stop);
            present(nullptr);
        }
        std::unique_lock lock(news_->mutex);
        const auto lost = std::exchange(news_->lost, std::nullopt);
        lock.unlock();
        if (lost) {
            context_.board.setDisconnected(context_.server.name, opcua::sanitise(*lost));
        }
        lock.lock();
        news_->changed.wait_for(lock, stop, pause, [] { return false; });
        pause = std::min<std::chrono::milliseconds>(pause * 2, kLongestPause);
    }
}

}  // namespace metier::dashboard
