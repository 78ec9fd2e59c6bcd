#include "metier/opcua_skill/server_executor.hpp"

#include <utility>

namespace metier::opcua_skill {

void ServerExecutor::post(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    if (server_ != nullptr) {
        server_->post(std::move(work));
    }
}

skill::Timer ServerExecutor::after(std::chrono::nanoseconds delay, std::function<void()> work) {
    auto* const server = [this] {
        const std::lock_guard lock(mutex_);
        return server_;
    }();
    if (server == nullptr) {
        return {};
    }
    // Without the lock: the stack has one of its own, which this thread may hold already. The
    // server cannot end meanwhile, since this is its thread.
    // Shared, because std::function asks for what can be copied.
    auto timer = std::make_shared<opcua::TimerHandle>(server->after(delay, std::move(work)));
    return skill::Timer([timer] { timer->cancel(); });
}

void ServerExecutor::close() {
    const std::lock_guard lock(mutex_);
    server_ = nullptr;
}

}  // namespace metier::opcua_skill
