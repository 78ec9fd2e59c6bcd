#include "metier/records/kept_store.hpp"

namespace metier::records {

/// False: others had it for too long.
bool KeptStore::take() {
    std::unique_lock lock(mutex_);
    const bool free = given_back_.wait_for(lock, kPatience, [this] { return !taken_; });
    taken_ = taken_ || free;
    return free;
}

void KeptStore::giveBack() {
    {
        const std::lock_guard lock(mutex_);
        taken_ = false;
    }
    given_back_.notify_one();
}

Result<void> KeptStore::open() {
    store_.reset();
    METIER_ASSIGN(auto opened, Store::open(url_));
    store_ = std::move(opened);
    return {};
}

/// Not that something is not there, or damaged, or held up by others.
bool KeptStore::isOfConnection(Errc code) {
    return code != Errc::not_found && code != Errc::invalid_argument && code != Errc::timeout;
}

}  // namespace metier::records
