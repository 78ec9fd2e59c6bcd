#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "metier/base/queue.hpp"
#include "metier/opcua/client.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {

/// The messages of events of the Server object.
class ServerEvents {
public:
    ServerEvents(opcua::Client& client, const opcua::NodeId& type) {
        auto subscription = client.subscribeEvents(
            opcua::ids::kServer, {.fields = {{{0, "Message"}}}, .of_type = type},
            [messages = messages_](const opcua::EventNotice& notice) {
                // A session that may not audit gets Null.
                if (notice.kind == opcua::EventNotice::Kind::event && !notice.fields[0].isEmpty()) {
                    messages->tryPush(notice.fields[0].toString());
                }
            });
        if (!subscription) {
            throw std::runtime_error(subscription.error().message);
        }
        subscription_ = std::move(*subscription);
    }
    /// The next one that says `text`; those before are dropped. Empty if there is none in a minute.
    std::string next(const std::string& text) {
        auto message = messages_->popUntil(inAMinute());
        while (message && message->find(text) == std::string::npos) {
            message = messages_->popUntil(inAMinute());
        }
        return message.value_or("");
    }
    bool anyWaiting() { return messages_->popUntil({}).has_value(); }

private:
    // Shared with the callback, which may run until the subscription has ended.
    std::shared_ptr<Queue<std::string>> messages_ = std::make_shared<Queue<std::string>>(10'000);
    opcua::Subscription subscription_;
};

}  // namespace metier::system_tests
