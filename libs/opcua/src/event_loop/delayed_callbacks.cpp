#include "delayed_callbacks.hpp"

namespace metier::opcua {

void DelayedCallbacks::run() {
    for (auto left = queue_.size(); left > 0 && !queue_.empty(); --left) {
        const auto* delayed = queue_.front();
        queue_.pop_front();
        if (delayed->callback != nullptr) {
            delayed->callback(delayed->application, delayed->context);
        }
    }
}

}  // namespace metier::opcua
