#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>

#include "metier/base/error.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// A store that is opened at its first use and kept open. It is opened anew when its file was
/// replaced or its database was away:
///
///     auto rows = store.use([&](Store& records) { return records.list(filter, page); });
///
/// Threading: any number of threads, one after the other. No server's thread: use() waits.
///
/// It serves a page that many readers open: the dashboard has one for all its connections.
class KeptStore {
public:
    /// Longest wait for other threads.
    static constexpr std::chrono::seconds kPatience{10};

    /// \param url as Store::open() takes it
    explicit KeptStore(std::string url) : url_(std::move(url)) {}

    /// Returns the Result of work(Store&). After an error that may come from an old connection,
    /// `work` is called once more, with a new one. Waits for other threads, kPatience at most, and
    /// for the store.
    /// Errors: those of Store::open() and of `work`; resource_unavailable (kPatience passed).
    /// \param work called with the open store on the calling thread, with no lock held; must not
    ///             keep the reference, nor call use() of this object, which would fail after
    ///             kPatience
    template <typename Work>
    auto use(Work work) -> std::invoke_result_t<Work, Store&> {
        if (!take()) {
            return fail(Errc::resource_unavailable, "records are being read for others");
        }
        const std::unique_ptr<KeptStore, GiveBack> taken(this);
        const bool kept = store_ != nullptr && store_->isCurrent();
        auto result = kept ? work(*store_) : useNew(work);
        return kept && !result && isOfConnection(result.error().code) ? useNew(work) : result;
    }

private:
    /// Gives the store back however `use` is left, also by an exception.
    struct GiveBack {
        void operator()(KeptStore* store) const { store->giveBack(); }
    };
    /// Opens the store anew, then calls `work`.
    template <typename Work>
    auto useNew(Work work) -> std::invoke_result_t<Work, Store&> {
        METIER_TRY(open());
        return work(*store_);
    }
    /// Waits for its turn, kPatience at most. False: others had it for too long.
    bool take();
    /// Wakes the next thread that waits.
    void giveBack();
    /// Closes the store that is open and opens it at its URL, for reading.
    Result<void> open();
    /// Whether a new connection may help: not for not_found, invalid_argument and timeout.
    static bool isOfConnection(Errc code);

    const std::string url_;
    std::mutex mutex_;
    std::condition_variable given_back_;
    // Guarded by mutex_, which is not held during `work`.
    bool taken_ = false;
    std::unique_ptr<Store> store_;  // used by the thread that has taken it
};

}  // namespace metier::records
