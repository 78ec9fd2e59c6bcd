#include "metier/records/kept_store.hpp"

namespace metier::records {

Result<void> KeptStore::open() {
    store_.reset();
    auto opened = Store::open(url_);
    if (!opened) {
        return fail(opened.error());
    }
    store_ = std::move(*opened);
    return {};
}

/// Not that something is not there, or damaged, or held up by others.
bool KeptStore::isOfConnection(Errc code) {
    return code != Errc::not_found && code != Errc::invalid_argument && code != Errc::timeout;
}

}  // namespace metier::records
